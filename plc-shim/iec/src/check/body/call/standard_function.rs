//! Standard functions (2nd ed. 2.5.1.5, 3rd ed. 6.6.2.5).

use crate::check::body::Body;
use crate::check::standard::form::{self, Form};
use crate::check::standard::{conversion, text_conversion};
use crate::check::types::number::as_bits;
use crate::check::types::operand::{Operand, constant, converted};
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::{Feature, Selection};
use crate::ir::{Binary, ElementaryType, Expr, ExprKind, Intrinsic, Rounding, Type, TypeId, Value};
use crate::syntax::Span;
use crate::syntax::ast::{Argument, BinaryOp, Ident};

impl Body<'_, '_> {
    /// A call of the standard function `name`, which exists.
    pub(super) fn standard_call(&mut self, name: &Ident, arguments: &[Argument], span: Span) -> Option<Operand> {
        let key = name.key();
        if let Some((form, ty)) = form::find(&key) {
            let comparison = matches!(form, Form::Comparison(_) | Form::Pair(BinaryOp::NotEqual));
            let context = self.context.filter(|_| !comparison);
            let operands = self.within(context, |body| body.operands(name, form, arguments, span));
            let operands = match ty {
                Some(ty) => self.typed_operands(form, ty, operands?)?,
                None => operands?,
            };
            return self.apply(form, operands, span);
        }
        let conversion = conversion::find(&key);
        // `INT_TO_BYTE(TRUNC(x))`: what takes the type that its place wants is an INT there.
        let wanted = conversion.and_then(|conversion| conversion.from);
        let operands = self.within(wanted, |body| body.operands(name, Form::Absolute, arguments, span));
        let operand = operands?.into_iter().next()?;
        match (conversion, text_conversion::find(&key)) {
            (Some(conversion), _) => self.conversion(conversion, operand, span),
            (None, conversion) => self.text_conversion(conversion?, operand, span),
        }
    }

    /// The operands of a typed function, in its type.
    fn typed_operands(&mut self, form: Form, ty: ElementaryType, operands: Vec<Operand>) -> Option<Vec<Operand>> {
        let typed = operands.into_iter().enumerate().map(|(position, operand)| {
            if form.is_typed_at(position) { self.coerce(operand, ty.into()).map(Operand::Typed) } else { Some(operand) }
        });
        typed.collect()
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
            Form::RealPair(intrinsic) => self.real_pair(intrinsic, first, operands.next()?, span),
            Form::IsValid => self.is_valid(first, span),
            Form::SwapBytes => self.swapped_bytes(first, span),
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
        let whole = self.whole(expr);
        let held = whole.ty;
        Some(Self::cut(ExprKind::Intrinsic(Intrinsic::Abs, vec![whole]), held, ty, span))
    }

    fn real_function(&mut self, kind: Intrinsic, operand: Operand, span: Span) -> Option<Operand> {
        let real: TypeId = ElementaryType::Real.into();
        let single = matches!(&operand, Operand::Typed(expr) if expr.ty == real);
        let ty = if single { real } else { ElementaryType::Lreal.into() };
        let expr = self.coerce(operand, ty)?;
        Some(Self::intrinsic(kind, vec![expr], ty, span))
    }

    fn real_pair(&mut self, kind: Intrinsic, left: Operand, right: Operand, span: Span) -> Option<Operand> {
        let pair = self.unify(Binary::Divide, left, right, "real numbers", span)?;
        let real = pair.ty == ElementaryType::Real;
        let ty: TypeId = if real { pair.ty } else { ElementaryType::Lreal }.into();
        let operands = vec![self.coerce(Operand::Typed(pair.left), ty)?, self.coerce(Operand::Typed(pair.right), ty)?];
        Some(Self::intrinsic(kind, operands, ty, span))
    }

    /// 3rd ed. Table 39. Only a finite number lies within the limits of its type.
    fn is_valid(&mut self, operand: Operand, span: Span) -> Option<Operand> {
        let expr = self.settle(operand)?;
        let (ty, greatest) = match self.plain_elementary(&expr) {
            Some(ElementaryType::Real) => (ElementaryType::Real, Value::Real(f32::MAX)),
            _ => (ElementaryType::Lreal, Value::Lreal(f64::MAX)),
        };
        let expr = self.coerce(Operand::Typed(expr), ty.into())?;
        let size = self.absolute(Operand::Typed(expr), span)?;
        self.operation(Binary::LessEqual, size, Operand::Typed(constant(greatest, ty, span)), span)
    }

    /// 3rd ed. Table 37.
    fn swapped_bytes(&mut self, operand: Operand, span: Span) -> Option<Operand> {
        let expr = self.settle(operand)?;
        self.require_elementary(&expr)?;
        let ty = expr.ty;
        Some(Self::intrinsic(Intrinsic::SwapBytes, vec![expr], ty, span))
    }

    fn require_elementary(&mut self, expr: &Expr) -> Option<()> {
        if self.plain_elementary(expr).is_some() {
            return Some(());
        }
        let found = self.type_name(expr.ty);
        self.mismatch("an elementary value", &found, expr.span)
    }

    /// `GT(a, b, c)` is `a > b AND b > c` (2nd ed. Table 28).
    fn chain(&mut self, operator: Binary, first: Operand, others: Vec<Operand>, span: Span) -> Option<Operand> {
        let mut left = first;
        let mut whole: Option<Operand> = None;
        for right in others {
            let (right, again) = self.twice(right);
            let link = self.operation(operator, left, right, span)?;
            whole = Some(match whole {
                None => link,
                Some(before) => self.operation(Binary::And, before, link, span)?,
            });
            left = again;
        }
        whole
    }

    /// An operand that is used twice and evaluated once.
    fn twice(&mut self, operand: Operand) -> (Operand, Operand) {
        match operand {
            Operand::Typed(expr) if !matches!(expr.kind, ExprKind::Constant(_) | ExprKind::Load(_)) => {
                let (ty, span) = (expr.ty, expr.span);
                let (before, again) = self.once(expr);
                let kind = ExprKind::After(before, Some(Box::new(again.clone())));
                (Operand::Typed(Expr { kind, ty, span }), Operand::Typed(again))
            }
            operand => (operand.clone(), operand),
        }
    }

    /// All operands in the smallest type that holds each.
    fn unify_all(&mut self, operands: Vec<Operand>, span: Span) -> Option<(Vec<Expr>, TypeId)> {
        if operands.iter().any(|operand| self.is_text(operand)) {
            return self.unify_texts(operands, span);
        }
        let operands = self.numbers_beside_enumerations(operands);
        let typed = operands.iter().find_map(|operand| match operand {
            Operand::Typed(expr) => Some(expr.ty),
            _ => None,
        });
        let enumeration = typed.filter(|ty| matches!(self.declarations.types().get(*ty), Type::Enumeration { .. }));
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

    /// The operands, enumerations as their numbers if there are other types among them.
    fn numbers_beside_enumerations(&self, operands: Vec<Operand>) -> Vec<Operand> {
        let types: Vec<_> = operands.iter().filter_map(Operand::typed).map(|expr| expr.ty).collect();
        if types.iter().all(|ty| *ty == types[0]) {
            return operands;
        }
        let number = |operand| match operand {
            Operand::Typed(expr) => Operand::Typed(self.as_number(expr)),
            other => other,
        };
        operands.into_iter().map(number).collect()
    }

    /// Values of any type that can be assigned (2nd ed. Table 27: ANY): all of one structure, array or pointer type, or
    /// what [`Self::unify_all`] takes.
    fn selected_values(&mut self, operands: Vec<Operand>, span: Span) -> Option<(Vec<Expr>, TypeId)> {
        let aggregate = operands.iter().find_map(|operand| match operand {
            Operand::Typed(expr) => Some(expr.ty).filter(|ty| self.is_selected_whole(*ty)),
            _ => None,
        });
        let Some(ty) = aggregate else {
            return self.unify_all(operands, span);
        };
        let all = operands.into_iter().map(|operand| self.coerce(operand, ty));
        Some((all.collect::<Option<_>>()?, ty))
    }

    fn is_selected_whole(&self, ty: TypeId) -> bool {
        let ty = self.declarations.types().get(ty);
        matches!(ty, Type::Struct { .. } | Type::Array { .. } | Type::Reference { .. })
    }

    fn extreme(&mut self, kind: Intrinsic, operands: Vec<Operand>, span: Span) -> Option<Operand> {
        let (all, ty) = self.unify_all(operands, span)?;
        let whole = self.whole_values(all).into_iter().reduce(|left, right| {
            let ty = left.ty;
            let kind = ExprKind::Intrinsic(kind, vec![left, right]);
            Expr { kind, ty, span }
        });
        whole.map(|Expr { kind, ty: held, .. }| Self::cut(kind, held, ty, span))
    }

    /// `LIMIT(MN, IN, MX)` is `MIN(MAX(IN, MN), MX)` (2nd ed. Table 27).
    fn limit(&mut self, operands: Vec<Operand>, span: Span) -> Option<Operand> {
        let (all, ty) = self.unify_all(operands, span)?;
        let [low, value, high] = <[Expr; 3]>::try_from(self.whole_values(all)).ok()?;
        let held = value.ty;
        let raised = Expr { kind: ExprKind::Intrinsic(Intrinsic::Max, vec![value, low]), ty: held, span };
        Some(Self::cut(ExprKind::Intrinsic(Intrinsic::Min, vec![raised, high]), held, ty, span))
    }

    fn select(&mut self, selector: Operand, values: Vec<Operand>, span: Span) -> Option<Operand> {
        let selector = self.coerce(selector, ElementaryType::Bool.into())?;
        let (mut all, ty) = self.selected_values(values, span)?;
        let is_lazy = self.declarations.dialect(span).selection() == Selection::Selected;
        if is_lazy && self.elementary(ty).is_some() {
            let [first, second] = <[Expr; 2]>::try_from(self.whole_values(all)).ok()?;
            let held = first.ty;
            let kind = ExprKind::Conditional(Box::new([selector, second, first]));
            return Some(Self::cut(kind, held, ty, span));
        }
        all.insert(0, selector);
        Some(Self::intrinsic(Intrinsic::Select, all, ty, span))
    }

    fn multiplex(&mut self, selector: Operand, values: Vec<Operand>, span: Span) -> Option<Operand> {
        let selector = self.integer_as_lint(selector)?;
        let (all, ty) = self.selected_values(values, span)?;
        let mut all = self.whole_values(all);
        let held = all.first().map_or(ty, |first| first.ty);
        all.insert(0, selector);
        Some(Self::cut(ExprKind::Intrinsic(Intrinsic::Multiplex, all), held, ty, span))
    }

    pub(in crate::check::body) fn integer_as_lint(&mut self, operand: Operand) -> Option<Expr> {
        let expr = self.settle(operand)?;
        let expr = self.as_index(expr);
        if !self.plain_elementary(&expr).is_some_and(ElementaryType::is_integer) {
            let found = self.type_name(expr.ty);
            return self.mismatch("an integer", &found, expr.span);
        }
        Some(converted(expr, ElementaryType::Lint, Rounding::NearestEven))
    }

    fn shift(&mut self, kind: Intrinsic, value: Operand, count: Operand, span: Span) -> Option<Operand> {
        let value = match value {
            Operand::Typed(expr) => Operand::Typed(self.as_number(expr)),
            constant => constant,
        };
        let value = match value {
            Operand::Typed(expr) if self.plain_elementary(&expr).is_some_and(ElementaryType::is_bits) => expr,
            Operand::Typed(expr) if self.shifted_integer(&expr).is_some() => {
                let ty = self.shifted_integer(&expr)?;
                if kind == Intrinsic::ShiftRight && ty.is_signed() {
                    // The sign moves in from the left.
                    let count = self.integer_as_lint(count)?;
                    return Some(Self::intrinsic(kind, vec![expr, count], ty.into(), span));
                }
                let bits = converted(expr, as_bits(ty), Rounding::NearestEven);
                let Operand::Typed(shifted) = self.shift(kind, Operand::Typed(bits), count, span)? else { return None };
                return Some(Operand::Typed(converted(shifted, ty, Rounding::NearestEven)));
            }
            Operand::Integer { value, span } if self.declarations.dialect(span).has(Feature::ShiftedLiterals) => {
                self.shifted_literal(value, span)?
            }
            Operand::Integer { value, span } => {
                let message = "a bit string is wanted, this is an integer";
                let help = format!("say how many bits are shifted, as in WORD#{}", value.max(0));
                self.report(Diagnostic::error(Code::TypeMismatch, span, message).with_help(help));
                return None;
            }
            other => {
                let found = self.describe(&other);
                return self.mismatch("a bit string", &found, other.span());
            }
        };
        let count = self.integer_as_lint(count)?;
        let ty = value.ty;
        Some(Self::intrinsic(kind, vec![value, count], ty, span))
    }

    /// A literal that is shifted has the smallest type that holds it, whatever its result is assigned to.
    fn shifted_literal(&mut self, value: i128, span: Span) -> Option<Expr> {
        let types = [ElementaryType::Byte, ElementaryType::Word, ElementaryType::Dword, ElementaryType::Lword];
        let Some(ty) = types.into_iter().find(|ty| ty.wrap(value) == value) else {
            return self.mismatch("a bit string", "a negative integer", span);
        };
        let message = format!("{value} is shifted as {ty}, the smallest type that holds it");
        let help = format!("say how many bits are shifted, as in DWORD#{value}");
        self.report(Diagnostic::warning(Code::LossyConversion, span, message).with_help(help));
        Some(constant(Value::Int(value), ty, span))
    }
}
