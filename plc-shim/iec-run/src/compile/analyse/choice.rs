//! IF whose branches give the same variable one of two cheap values: both may be computed and one
//! taken, as a branch that cannot be foretold costs more.

use super::scope::Scope;
use onescan_iec::ir::{Binary, Expr, ExprKind, IfBranch, Intrinsic, Place, Statement, StatementKind, Step, Storage};

/// Largest expression that is computed though it may not be needed.
const MAX_SIZE: u32 = 8;

/// `target` becomes `first` if the condition holds, else `second`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Choice<'i> {
    pub(crate) target: &'i Place,
    pub(crate) condition: &'i Expr,
    pub(crate) first: &'i Expr,
    pub(crate) second: &'i Expr,
}

impl<'i> Choice<'i> {
    /// The statement as a choice, if it is one.
    pub(crate) fn of(scope: &Scope<'_>, branches: &'i [IfBranch], otherwise: &'i [Statement]) -> Option<Self> {
        let [IfBranch { condition, body }] = branches else { return None };
        let ((target, first), (other, second)) = (assignment(body)?, assignment(otherwise)?);
        let same = target.ty == other.ty && scope.slot(target).is_some() && scope.slot(target) == scope.slot(other);
        let cheap = harmless(first).is_some() && harmless(second).is_some();
        // What is chosen of two reals could be a NaN that each machine writes in its own way.
        let real = scope.held_as(target.ty).is_real();
        (same && cheap && !real).then_some(Self { target, condition, first, second })
    }
}

/// The size of an expression that has no effect and cannot fail; nothing for others.
fn harmless(expr: &Expr) -> Option<u32> {
    let inside = match &expr.kind {
        ExprKind::Constant(_) => 0,
        ExprKind::Load(place) => simple(place).then_some(0)?,
        ExprKind::Unary(_, operand) => harmless(operand)?,
        ExprKind::Binary(Binary::Divide | Binary::DivideAnyway | Binary::Modulo, _, _) => return None,
        ExprKind::Binary(_, left, right) => harmless(left)? + harmless(right)?,
        ExprKind::Intrinsic(Intrinsic::ShiftLeft | Intrinsic::ShiftRight, operands) => {
            operands.iter().map(harmless).sum::<Option<u32>>()?
        }
        _ => return None,
    };
    (inside < MAX_SIZE).then_some(inside + 1)
}

/// True if the place is a variable of its own, or a register: to load it cannot fail.
fn simple(place: &Place) -> bool {
    let own = matches!(place.storage, Storage::Absolute(_) | Storage::Instance(_) | Storage::Register(_));
    own && place.steps.iter().all(|step| matches!(step, Step::Offset(_))) && place.part.is_none()
}

/// The one assignment that a branch is made of.
fn assignment(body: &[Statement]) -> Option<(&Place, &Expr)> {
    match body {
        [Statement { kind: StatementKind::Assign(target, value), .. }] if simple(target) => Some((target, value)),
        _ => None,
    }
}
