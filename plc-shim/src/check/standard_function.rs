//! Standard functions (2nd ed. 2.5.1.5, 3rd ed. 6.6.2.5).

use super::calendar::{self, TimedFunction};
use super::conversion_function;
use super::convert::{Operand, converted};
use super::scope::Body;
use super::text_conversion;
use super::text_function::{self, TextForm};
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::text::Edit;
use crate::ir::{Binary, ElementaryType, Expr, ExprKind, Intrinsic, Rounding, TypeId};
use crate::syntax::Span;
use crate::syntax::ast::{Argument, BinaryOp, Ident};

/// What a standard function does with its arguments.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    Absolute,
    Real(Intrinsic),
    Power,
    Move,
    Not,
    /// Joins two or more from the left.
    Operator(BinaryOp),
    /// Joins exactly two.
    Pair(BinaryOp),
    /// Holds between each two neighbours.
    Comparison(Binary),
    Extreme(Intrinsic),
    Limit,
    Select,
    Multiplex,
    Shift(Intrinsic),
    Text(TextForm),
    Timed(TimedFunction),
}

const FUNCTIONS: &[(&str, Form)] = &[
    ("ABS", Form::Absolute),
    ("SQRT", Form::Real(Intrinsic::Sqrt)),
    ("LN", Form::Real(Intrinsic::Ln)),
    ("LOG", Form::Real(Intrinsic::Log)),
    ("EXP", Form::Real(Intrinsic::Exp)),
    ("SIN", Form::Real(Intrinsic::Sin)),
    ("COS", Form::Real(Intrinsic::Cos)),
    ("TAN", Form::Real(Intrinsic::Tan)),
    ("ASIN", Form::Real(Intrinsic::Asin)),
    ("ACOS", Form::Real(Intrinsic::Acos)),
    ("ATAN", Form::Real(Intrinsic::Atan)),
    ("EXPT", Form::Power),
    ("MOVE", Form::Move),
    ("NOT", Form::Not),
    ("ADD", Form::Operator(BinaryOp::Add)),
    ("MUL", Form::Operator(BinaryOp::Multiply)),
    ("SUB", Form::Pair(BinaryOp::Subtract)),
    ("DIV", Form::Pair(BinaryOp::Divide)),
    ("MOD", Form::Pair(BinaryOp::Modulo)),
    ("AND", Form::Operator(BinaryOp::And)),
    ("OR", Form::Operator(BinaryOp::Or)),
    ("XOR", Form::Operator(BinaryOp::Xor)),
    ("GT", Form::Comparison(Binary::Greater)),
    ("GE", Form::Comparison(Binary::GreaterEqual)),
    ("EQ", Form::Comparison(Binary::Equal)),
    ("LE", Form::Comparison(Binary::LessEqual)),
    ("LT", Form::Comparison(Binary::Less)),
    ("NE", Form::Pair(BinaryOp::NotEqual)),
    ("MAX", Form::Extreme(Intrinsic::Max)),
    ("MIN", Form::Extreme(Intrinsic::Min)),
    ("LIMIT", Form::Limit),
    ("SEL", Form::Select),
    ("MUX", Form::Multiplex),
    ("SHL", Form::Shift(Intrinsic::ShiftLeft)),
    ("SHR", Form::Shift(Intrinsic::ShiftRight)),
    ("ROL", Form::Shift(Intrinsic::RotateLeft)),
    ("ROR", Form::Shift(Intrinsic::RotateRight)),
];

fn find(key: &str) -> Option<Form> {
    let text = || text_function::FUNCTIONS.iter().find(|(name, _)| *name == key);
    let found = FUNCTIONS.iter().find(|(name, _)| *name == key).map(|(_, form)| *form);
    let timed = || calendar::FUNCTIONS.iter().find(|function| function.name == key);
    let found = found.or_else(|| text().map(|(_, form)| Form::Text(*form)));
    found.or_else(|| timed().map(|function| Form::Timed(*function)))
}

/// True if the standard has a function of this name, in capitals.
pub(crate) fn exists(key: &str) -> bool {
    find(key).is_some() || conversion_function::find(key).is_some() || text_conversion::find(key).is_some()
}

/// Names of all but the conversions.
pub(super) fn names() -> impl Iterator<Item = &'static str> {
    FUNCTIONS.iter().map(|(name, _)| *name).chain(text_function::FUNCTIONS.iter().map(|(name, _)| *name))
}

impl Form {
    /// Fewest and most arguments.
    fn arity(self) -> (usize, usize) {
        match self {
            Self::Absolute | Self::Real(_) | Self::Move | Self::Not => (1, 1),
            Self::Timed(_) | Self::Power | Self::Pair(_) | Self::Shift(_) => (2, 2),
            Self::Limit | Self::Select => (3, 3),
            Self::Text(form) if form != TextForm::Edit(Edit::Concat) => {
                (form.parameters().len(), form.parameters().len())
            }
            Self::Text(_) | Self::Operator(_) | Self::Comparison(_) | Self::Extreme(_) | Self::Multiplex => {
                (2, usize::MAX)
            }
        }
    }

    /// Position of a formal parameter.
    fn position(self, name: &str) -> Option<usize> {
        let numbered = || name.strip_prefix("IN")?.parse::<usize>().ok();
        match (self, name) {
            (Self::Text(form), _) if form != TextForm::Edit(Edit::Concat) => {
                form.parameters().iter().position(|known| *known == name)
            }
            (Self::Absolute | Self::Real(_) | Self::Move | Self::Not | Self::Shift(_), "IN")
            | (Self::Limit, "MN")
            | (Self::Select, "G")
            | (Self::Multiplex, "K") => Some(0),
            (Self::Shift(_), "N") | (Self::Limit, "IN") => Some(1),
            (Self::Limit, "MX") => Some(2),
            (Self::Select | Self::Multiplex, _) => numbered()?.checked_add(1),
            (Self::Limit | Self::Shift(_) | Self::Absolute | Self::Real(_), _) => None,
            _ => numbered()?.checked_sub(1),
        }
    }
}

impl Body<'_, '_> {
    /// A call of the standard function `name`, which exists.
    pub(super) fn standard_call(&mut self, name: &Ident, arguments: &[Argument], span: Span) -> Option<Operand> {
        let key = name.key();
        if let Some(form) = find(&key) {
            let comparison = matches!(form, Form::Comparison(_) | Form::Pair(BinaryOp::NotEqual));
            let context = self.context.filter(|_| !comparison);
            let operands = self.within(context, |body| body.operands(name, form, arguments, span));
            return self.apply(form, operands?, span);
        }
        let conversion = conversion_function::find(&key);
        let operands = self.within(None, |body| body.operands(name, Form::Absolute, arguments, span));
        let operand = operands?.into_iter().next()?;
        match (conversion, text_conversion::find(&key)) {
            (Some(conversion), _) => self.conversion(conversion, operand, span),
            (None, conversion) => self.text_conversion(conversion?, operand, span),
        }
    }

    fn operands(&mut self, name: &Ident, form: Form, arguments: &[Argument], span: Span) -> Option<Vec<Operand>> {
        let mut slots: Vec<Option<Option<Operand>>> = vec![None; arguments.len()];
        for (index, argument) in arguments.iter().enumerate() {
            let (position, expr) = match argument {
                Argument::Positional(expr) => (Some(index), expr),
                Argument::Input(formal, expr) => (form.position(&formal.key()), expr),
                Argument::Output { name: formal, .. } => {
                    return self.unknown_parameter(name, formal);
                }
            };
            let operand = self.expression(expr);
            match position.and_then(|position| slots.get_mut(position)) {
                Some(slot) if slot.is_none() => *slot = Some(operand),
                _ => {
                    let message = format!("{} has no such parameter here", name.key());
                    self.report(Diagnostic::error(Code::UnknownArgument, expr.span, message));
                    return None;
                }
            }
        }
        let (fewest, most) = form.arity();
        if arguments.len() < fewest || arguments.len() > most {
            let code = if arguments.len() < fewest { Code::MissingArgument } else { Code::TooManyArguments };
            let more = if most == fewest { "" } else { " or more" };
            let message = format!("{} takes {fewest}{more} arguments, not {}", name.key(), arguments.len());
            self.report(Diagnostic::error(code, span, message));
            return None;
        }
        slots.into_iter().map(Option::flatten).collect()
    }

    fn unknown_parameter<T>(&mut self, name: &Ident, formal: &Ident) -> Option<T> {
        let message = format!("{} has no parameter `{}`", name.key(), formal.text);
        self.report(Diagnostic::error(Code::UnknownArgument, formal.span, message));
        None
    }

    fn apply(&mut self, form: Form, operands: Vec<Operand>, span: Span) -> Option<Operand> {
        let mut operands = operands.into_iter();
        let first = operands.next()?;
        match form {
            Form::Move => Some(first),
            Form::Not => self.not(first, span),
            Form::Power => self.power(first, operands.next()?, span),
            Form::Absolute => self.absolute(first, span),
            Form::Real(intrinsic) => self.real_function(intrinsic, first, span),
            Form::Pair(operator) | Form::Operator(operator) => {
                operands.try_fold(first, |left, right| self.binary(operator, left, right, span))
            }
            Form::Comparison(operator) => self.chain(operator, first, operands.collect(), span),
            Form::Extreme(intrinsic) => {
                let all = std::iter::once(first).chain(operands).collect();
                self.extreme(intrinsic, all, span)
            }
            Form::Limit => {
                let all = std::iter::once(first).chain(operands).collect();
                self.limit(all, span)
            }
            Form::Text(form) => {
                let all = std::iter::once(first).chain(operands).collect();
                self.text_function(form, all, span)
            }
            Form::Timed(function) => self.timed_function(function, first, operands.next()?, span),
            Form::Select => self.select(first, operands.collect(), span),
            Form::Multiplex => self.multiplex(first, operands.collect(), span),
            Form::Shift(intrinsic) => self.shift(intrinsic, first, operands.next()?, span),
        }
    }

    fn intrinsic(kind: Intrinsic, operands: Vec<Expr>, ty: TypeId, span: Span) -> Operand {
        Operand::Typed(Expr { kind: ExprKind::Intrinsic(kind, operands), ty, span })
    }

    fn absolute(&mut self, operand: Operand, span: Span) -> Option<Operand> {
        let expr = self.settle(operand)?;
        if !self.plain_elementary(&expr).is_some_and(ElementaryType::is_number) {
            let found = self.type_name(expr.ty);
            return self.mismatch("a number", &found, expr.span);
        }
        let ty = expr.ty;
        Some(Self::intrinsic(Intrinsic::Abs, vec![expr], ty, span))
    }

    fn real_function(&mut self, kind: Intrinsic, operand: Operand, span: Span) -> Option<Operand> {
        let real: TypeId = ElementaryType::Real.into();
        let single = matches!(&operand, Operand::Typed(expr) if expr.ty == real);
        let ty = if single { real } else { ElementaryType::Lreal.into() };
        let expr = self.coerce(operand, ty)?;
        Some(Self::intrinsic(kind, vec![expr], ty, span))
    }

    /// `GT(a, b, c)` is `a > b AND b > c` (2nd ed. Table 28).
    fn chain(&mut self, operator: Binary, first: Operand, others: Vec<Operand>, span: Span) -> Option<Operand> {
        let mut left = first;
        let mut whole: Option<Operand> = None;
        for right in others {
            let link = self.operation(operator, left, right.clone(), span)?;
            whole = Some(match whole {
                None => link,
                Some(before) => self.operation(Binary::And, before, link, span)?,
            });
            left = right;
        }
        whole
    }

    /// All operands in the smallest type that holds each.
    fn unify_all(&mut self, operands: Vec<Operand>, span: Span) -> Option<(Vec<Expr>, TypeId)> {
        if operands.iter().any(|operand| self.is_text(operand)) {
            return self.unify_texts(operands, span);
        }
        let typed = operands.iter().find_map(|operand| match operand {
            Operand::Typed(expr) => Some(expr.ty),
            _ => None,
        });
        let enumeration = typed.filter(|ty| matches!(self.checker.types.get(*ty), crate::ir::Type::Enumeration { .. }));
        let context = self.context.filter(|ty| operands.iter().all(|operand| Self::adapts(operand, *ty)));
        let ty = if let Some(ty) = enumeration.or(context.map(TypeId::from)) {
            ty
        } else {
            // Typed operands lead, so that constants adapt to them.
            let lead = |operand: &&Operand| matches!(operand, Operand::Typed(_));
            let (typed, free): (Vec<_>, Vec<_>) = operands.iter().partition(|each| lead(each));
            let mut whole: Option<Operand> = None;
            for operand in typed.into_iter().chain(free) {
                whole = Some(match whole {
                    None => operand.clone(),
                    Some(left) => {
                        let pair = self.unify(Binary::Equal, left, operand.clone(), "", span)?;
                        Operand::Typed(pair.left)
                    }
                });
            }
            self.settle(whole?)?.ty
        };
        let all = operands.into_iter().map(|operand| self.coerce(operand, ty));
        Some((all.collect::<Option<_>>()?, ty))
    }

    fn extreme(&mut self, kind: Intrinsic, operands: Vec<Operand>, span: Span) -> Option<Operand> {
        let (all, ty) = self.unify_all(operands, span)?;
        let whole = all.into_iter().reduce(|left, right| {
            let kind = ExprKind::Intrinsic(kind, vec![left, right]);
            Expr { kind, ty, span }
        });
        whole.map(Operand::Typed)
    }

    /// `LIMIT(MN, IN, MX)` is `MIN(MAX(IN, MN), MX)` (2nd ed. Table 27).
    fn limit(&mut self, operands: Vec<Operand>, span: Span) -> Option<Operand> {
        let (all, ty) = self.unify_all(operands, span)?;
        let [low, value, high] = <[Expr; 3]>::try_from(all).ok()?;
        let node = |kind, operands| Expr { kind: ExprKind::Intrinsic(kind, operands), ty, span };
        let raised = node(Intrinsic::Max, vec![value, low]);
        Some(Operand::Typed(node(Intrinsic::Min, vec![raised, high])))
    }

    fn select(&mut self, selector: Operand, values: Vec<Operand>, span: Span) -> Option<Operand> {
        let selector = self.coerce(selector, ElementaryType::Bool.into())?;
        let (mut all, ty) = self.unify_all(values, span)?;
        self.require_elementary(ty, span)?;
        all.insert(0, selector);
        Some(Self::intrinsic(Intrinsic::Select, all, ty, span))
    }

    fn multiplex(&mut self, selector: Operand, values: Vec<Operand>, span: Span) -> Option<Operand> {
        let selector = self.integer_as_lint(selector)?;
        let (mut all, ty) = self.unify_all(values, span)?;
        self.require_elementary(ty, span)?;
        all.insert(0, selector);
        Some(Self::intrinsic(Intrinsic::Multiplex, all, ty, span))
    }

    fn require_elementary(&mut self, ty: TypeId, span: Span) -> Option<()> {
        if self.elementary(ty).is_some() || self.shape(ty).is_some() {
            return Some(());
        }
        let found = self.type_name(ty);
        self.mismatch("an elementary value", &found, span)
    }

    pub(super) fn integer_as_lint(&mut self, operand: Operand) -> Option<Expr> {
        let expr = self.settle(operand)?;
        if !self.plain_elementary(&expr).is_some_and(ElementaryType::is_integer) {
            let found = self.type_name(expr.ty);
            return self.mismatch("an integer", &found, expr.span);
        }
        Some(converted(expr, ElementaryType::Lint, Rounding::NearestEven))
    }

    fn shift(&mut self, kind: Intrinsic, value: Operand, count: Operand, span: Span) -> Option<Operand> {
        let value = match value {
            Operand::Typed(expr) if self.plain_elementary(&expr).is_some_and(ElementaryType::is_bits) => expr,
            other => {
                let found = self.describe(&other);
                return self.mismatch("a bit string", &found, other.span());
            }
        };
        let count = self.integer_as_lint(count)?;
        let ty = value.ty;
        Some(Self::intrinsic(kind, vec![value, count], ty, span))
    }
}
