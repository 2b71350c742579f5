//! Expressions and statements that no text stands for.

use crate::ir::{Binary, ElementaryType, Expr, ExprKind, IfBranch, Place, Statement, StatementKind, Unary, Value};
use crate::syntax::Span;

/// The value at a place.
pub(in crate::check) fn load(place: &Place) -> Expr {
    Expr { kind: ExprKind::Load(place.clone()), ty: place.ty, span: place.span }
}

pub(in crate::check) fn truth(value: bool, span: Span) -> Expr {
    Expr { kind: ExprKind::Constant(Value::Bool(value)), ty: ElementaryType::Bool.into(), span }
}

pub(in crate::check) fn not(operand: Expr) -> Expr {
    let (ty, span) = (operand.ty, operand.span);
    Expr { kind: ExprKind::Unary(Unary::Not, Box::new(operand)), ty, span }
}

/// An operation whose result is of the left operand's type.
pub(in crate::check) fn operation(operator: Binary, left: Expr, right: Expr) -> Expr {
    let (ty, span) = (left.ty, left.span);
    Expr { kind: ExprKind::Binary(operator, Box::new(left), Box::new(right)), ty, span }
}

/// All operands joined by an operator; nothing without any.
pub(crate) fn joined(operator: Binary, operands: impl IntoIterator<Item = Expr>) -> Option<Expr> {
    operands.into_iter().reduce(|left, right| operation(operator, left, right))
}

/// An assignment that stands where its target does.
pub(in crate::check) fn assign(target: &Place, value: Expr) -> Statement {
    Statement { kind: StatementKind::Assign(target.clone(), value), span: target.span }
}

/// `IF condition THEN body END_IF`
pub(in crate::check) fn when(condition: Expr, body: Vec<Statement>, span: Span) -> Statement {
    Statement { kind: StatementKind::If(vec![IfBranch { condition, body }], Vec::new()), span }
}
