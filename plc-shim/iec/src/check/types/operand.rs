//! What an expression has come to: a typed value, or a constant that takes the type of its context (3rd ed. 6.6.1.6).

use super::constant::convert as folded;
use crate::ir::{ElementaryType, Expr, ExprKind, Rounding, Value};
use crate::syntax::Span;
use crate::syntax::text_literal::Text;

/// What an expression has come to. A constant without a type takes that of its context.
#[derive(Debug, Clone)]
pub(in crate::check) enum Operand {
    Typed(Expr),
    Integer { value: i128, span: Span },
    Real { value: f64, span: Span },
    Text { text: Text, span: Span },
}

impl Operand {
    /// The value, if it has a type.
    pub(in crate::check) fn typed(&self) -> Option<&Expr> {
        if let Self::Typed(expr) = self { Some(expr) } else { None }
    }

    pub(in crate::check) fn span(&self) -> Span {
        match self {
            Self::Typed(expr) => expr.span,
            Self::Integer { span, .. } | Self::Real { span, .. } | Self::Text { span, .. } => *span,
        }
    }

    pub(in crate::check) fn with_span(self, span: Span) -> Self {
        match self {
            Self::Typed(expr) => Self::Typed(Expr { span, ..expr }),
            Self::Integer { value, .. } => Self::Integer { value, span },
            Self::Real { value, .. } => Self::Real { value, span },
            Self::Text { text, .. } => Self::Text { text, span },
        }
    }
}

pub(in crate::check) fn constant(value: Value, ty: ElementaryType, span: Span) -> Expr {
    Expr { kind: ExprKind::Constant(value), ty: ty.into(), span }
}

/// `expr` as one of `ty`, whatever becomes of its value.
pub(in crate::check) fn converted(expr: Expr, ty: ElementaryType, rounding: Rounding) -> Expr {
    if expr.ty == ty.into() {
        return expr;
    }
    let span = expr.span;
    match expr.kind {
        ExprKind::Constant(Value::Int(number)) if is_exact(number, ty) => {
            constant(folded(rounding, ty, Value::Int(number)), ty, span)
        }
        _ => Expr { kind: ExprKind::Convert(rounding, Box::new(expr)), ty: ty.into(), span },
    }
}

/// True if the number is one of the type, so that a constant stays what it is.
fn is_exact(number: i128, ty: ElementaryType) -> bool {
    let magnitude = |bits: u32| number.unsigned_abs() <= 1 << bits;
    match ty {
        ElementaryType::Bool => false,
        ElementaryType::Real => magnitude(f32::MANTISSA_DIGITS),
        ElementaryType::Lreal => magnitude(f64::MANTISSA_DIGITS),
        _ => ty.takes_integers() && ty.range().is_some_and(|(low, high)| low <= number && number <= high),
    }
}
