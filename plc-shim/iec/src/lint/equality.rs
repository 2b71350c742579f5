//! W0703: two real numbers that were computed are seldom equal to the last bit.

use super::Unit;
use super::index::Index;
use super::types::is_real;
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::ast::{BinaryOp, Expr, ExprKind, Literal, Pou};
use crate::syntax::walk::{self, Visitor};

pub(super) fn lint(unit: &Unit<'_>, index: &Index<'_>, findings: &mut Vec<Diagnostic>) {
    walk::unit(unit.pou, &mut Comparisons { pou: unit.pou, index, findings });
}

struct Comparisons<'a, 'f> {
    pou: &'a Pou,
    index: &'a Index<'a>,
    findings: &'f mut Vec<Diagnostic>,
}

/// Zero is exact: to compare with it is how a division is guarded.
fn is_zero(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Literal(Literal::Real(value)) => *value == 0.0,
        ExprKind::Literal(Literal::Integer(value)) => *value == 0,
        ExprKind::Paren(inner) | ExprKind::Unary(_, inner) => is_zero(inner),
        _ => false,
    }
}

impl Visitor for Comparisons<'_, '_> {
    fn expression(&mut self, expr: &Expr) {
        let ExprKind::Binary(BinaryOp::Equal | BinaryOp::NotEqual, left, right) = &expr.kind else { return };
        let real = is_real(left, self.pou, self.index) || is_real(right, self.pou, self.index);
        if real && !is_zero(left) && !is_zero(right) {
            let message = "real numbers are compared for equality";
            let found = Diagnostic::warning(Code::RealEquality, expr.span, message);
            self.findings.push(found.with_help("compare their distance, as in `ABS(a - b) < limit`"));
        }
    }
}
