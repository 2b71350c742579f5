//! Values that could be a NaN which the machine has chosen.

use super::scope::Scope;
use onescan_iec::ir::{Expr, ExprKind, Intrinsic};

/// True if a real value is computed: if it is NaN, the machine has chosen which. What is
/// fetched, chosen or has its sign changed keeps its bits; variables never hold such a NaN.
pub(crate) fn may_be_any_nan(scope: &Scope<'_>, expr: &Expr) -> bool {
    let real = |expr: &Expr| scope.held_as(expr.ty).is_real();
    real(expr)
        && match &expr.kind {
            ExprKind::Constant(_)
            | ExprKind::Load(_)
            | ExprKind::Call(_)
            | ExprKind::Unary(..)
            | ExprKind::Intrinsic(Intrinsic::Reinterpret | Intrinsic::Abs, _) => false,
            ExprKind::Intrinsic(Intrinsic::Select | Intrinsic::Multiplex, operands) => {
                operands.iter().any(|operand| may_be_any_nan(scope, operand))
            }
            ExprKind::Convert(_, operand) => real(operand),
            _ => true,
        }
}
