//! What integers lose before a wider or a real type takes them: the high part of a product, the fraction of a quotient.

use crate::check::body::Body;
use crate::check::types::constant::fold;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{Binary, ElementaryType, Expr, ExprKind, Intrinsic, Type, Unary, Value};
use crate::syntax::Span;

impl Body<'_, '_> {
    /// The literal that alone makes an expression one of LREAL, whose other operands a REAL holds: `n * 2.0`.
    pub(in crate::check::body) fn literal_that_widens(&self, expr: &Expr) -> Option<Span> {
        let mut literal = None;
        self.is_of_literals(expr, &mut literal).then_some(literal).flatten()
    }

    fn is_of_literals(&self, expr: &Expr, literal: &mut Option<Span>) -> bool {
        match &expr.kind {
            ExprKind::Constant(Value::Lreal(_)) => {
                literal.get_or_insert(expr.span);
                true
            }
            ExprKind::Convert(_, operand) => {
                let ty = self.plain_elementary(operand);
                operand.span == expr.span && ty.is_some_and(|ty| ty.is_integer() && ty.widens_to(ElementaryType::Real))
            }
            ExprKind::Unary(Unary::Negate, operand) => self.is_of_literals(operand, literal),
            ExprKind::Binary(
                Binary::Add | Binary::Subtract | Binary::Multiply | Binary::Divide | Binary::DivideAnyway,
                left,
                right,
            ) => self.is_of_literals(left, literal) && self.is_of_literals(right, literal),
            _ => false,
        }
    }

    /// Warns of a product that wraps in the type of its factors although what takes it is wider. CODESYS and TwinCAT
    /// compute it in the registers of the target.
    pub(in crate::check::body) fn warn_of_cut_product(
        &mut self,
        expr: &Expr,
        found: ElementaryType,
        wanted: ElementaryType,
    ) {
        let is_wider = found.is_integer() && (wanted.is_real() || wanted.is_integer() && wanted.size() > found.size());
        let is_cut = self.held_in_register(expr).is_none() && found.size() < ElementaryType::Lint.size();
        if !is_wider || !is_cut {
            return;
        }
        let Some(product) = self.product_in(expr, found) else { return };
        let message = format!("this product is cut to {found} before it becomes {wanted}");
        let report = Diagnostic::warning(Code::CutProduct, product.span, message);
        self.report(report.with_help(format!("convert a factor, as in `{found}_TO_{wanted}(a) * b`")));
    }

    /// The product that an expression is or is made of, as in `raw * 1000 / span`, if some values of its factors give
    /// more than their type holds.
    fn product_in<'e>(&self, expr: &'e Expr, held: ElementaryType) -> Option<&'e Expr> {
        let either = |left, right| self.product_in(left, held).or_else(|| self.product_in(right, held));
        match &expr.kind {
            ExprKind::Binary(Binary::Multiply, left, right) => {
                let may_wrap = expr.ty == held.into() && self.bounds(expr).is_none();
                if may_wrap { Some(expr) } else { either(left, right) }
            }
            ExprKind::Binary(
                Binary::Add | Binary::Subtract | Binary::Divide | Binary::DivideAnyway | Binary::Modulo,
                left,
                right,
            ) => either(left, right),
            ExprKind::Unary(Unary::Negate, operand) => self.product_in(operand, held),
            ExprKind::Intrinsic(Intrinsic::Abs | Intrinsic::Max | Intrinsic::Min, operands) => {
                operands.iter().find_map(|operand| self.product_in(operand, held))
            }
            _ => None,
        }
    }

    /// The least and the greatest value of an integer expression; nothing if it may wrap.
    fn bounds(&self, expr: &Expr) -> Option<(i128, i128)> {
        let types = self.declarations.types();
        let range = types.elementary(expr.ty)?.range()?;
        let fits = |(low, high): (i128, i128)| (range.0 <= low && high <= range.1).then_some((low, high));
        match &expr.kind {
            ExprKind::Constant(value) => value.as_int().map(|value| (value, value)),
            ExprKind::Binary(operator, left, right) => {
                let (left, right) = (self.bounds(left)?, self.bounds(right)?);
                match operator {
                    Binary::Add => fits((left.0 + right.0, left.1 + right.1)),
                    Binary::Subtract => fits((left.0 - right.1, left.1 - right.0)),
                    Binary::Multiply => fits(corners(left, right, i128::checked_mul)?),
                    Binary::Divide | Binary::DivideAnyway if right.0 > 0 => {
                        fits(corners(left, right, i128::checked_div)?)
                    }
                    Binary::Modulo if right.0 > 0 => Some((left.0.min(0).max(1 - right.1), right.1 - 1)),
                    _ => Some(range),
                }
            }
            // A number keeps its value in a type that has room for it.
            ExprKind::Convert(_, operand) => Some(self.bounds(operand).and_then(fits).unwrap_or(range)),
            ExprKind::Limited(low, high, _) => Some((*low, *high)),
            ExprKind::Load(_) => match types.get(expr.ty) {
                Type::Subrange { low, high, .. } => Some((*low, *high)),
                _ => Some(range),
            },
            _ => Some(range),
        }
    }

    /// Warns of a quotient of integers that becomes a real number: what is behind the point is gone before.
    pub(super) fn warn_of_lost_fraction(&mut self, expr: &Expr, found: ElementaryType, wanted: ElementaryType) {
        if found.is_integer()
            && wanted.is_real()
            && let Some((quotient, dividend)) = quotient_in(expr)
            && !self.is_exact(quotient)
        {
            let from = self.elementary(dividend.ty).unwrap_or(found);
            let help = format!("convert before you divide, as in `{from}_TO_{wanted}(a) / b`");
            self.report_lost_fraction(quotient.span, wanted, help);
        }
    }

    /// The same of two literals, where a real number is wanted.
    pub(super) fn warn_of_lost_fraction_of(&mut self, operator: Binary, (left, right): (i128, i128), span: Span) {
        let wanted = self.context.filter(|wanted| wanted.is_real());
        let has_rest = operator == Binary::Divide && left.checked_rem(right).is_some_and(|rest| rest != 0);
        if let Some(wanted) = wanted.filter(|_| has_rest) {
            self.report_lost_fraction(span, wanted, format!("write real numbers, as in `{left}.0 / {right}.0`"));
        }
    }

    fn report_lost_fraction(&mut self, span: Span, wanted: ElementaryType, help: String) {
        let message = format!("this quotient of integers loses its fraction before it becomes {wanted}");
        self.report(Diagnostic::warning(Code::LostFraction, span, message).with_help(help));
    }

    /// True for a quotient of constants that has no fraction.
    fn is_exact(&self, quotient: &Expr) -> bool {
        let ExprKind::Binary(_, left, right) = &quotient.kind else { return false };
        let value = |expr| fold(self.declarations.types(), expr).ok().and_then(Value::as_int);
        match (value(left), value(right)) {
            (_, Some(1 | -1)) => true,
            (Some(left), Some(right)) => left.checked_rem(right).is_none_or(|rest| rest == 0),
            _ => false,
        }
    }
}

/// The bounds of what an operation makes of two numbers within bounds, if it grows or falls with each of them.
fn corners(left: (i128, i128), right: (i128, i128), operation: fn(i128, i128) -> Option<i128>) -> Option<(i128, i128)> {
    let pairs = [(left.0, right.0), (left.0, right.1), (left.1, right.0), (left.1, right.1)];
    let values: Option<Vec<i128>> = pairs.into_iter().map(|(left, right)| operation(left, right)).collect();
    let values = values?;
    Some((values.iter().min().copied()?, values.iter().max().copied()?))
}

/// The quotient that an expression is, or that is added to others, and its dividend. One that is multiplied again, as in
/// `n / 10 * 10`, is cut on purpose.
fn quotient_in(expr: &Expr) -> Option<(&Expr, &Expr)> {
    match &expr.kind {
        ExprKind::Binary(Binary::Divide | Binary::DivideAnyway, left, _) => Some((expr, uncut(left))),
        ExprKind::Binary(Binary::Add | Binary::Subtract, left, right) => {
            quotient_in(left).or_else(|| quotient_in(right))
        }
        ExprKind::Unary(Unary::Negate, operand) | ExprKind::FromRegister(operand) => quotient_in(operand),
        _ => None,
    }
}

/// What was taken into a register.
fn uncut(expr: &Expr) -> &Expr {
    match &expr.kind {
        ExprKind::Convert(_, operand) => uncut(operand),
        _ => expr,
    }
}
