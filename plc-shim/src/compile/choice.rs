//! IF whose branches give the same variable one of two cheap values: both are computed and one is
//! taken, as a branch that cannot be foretold costs more.

use wasm_encoder::Instruction;

use super::emitter::{Emitter, value_type};
use crate::ir::{Binary, Expr, ExprKind, IfBranch, Intrinsic, Place, Statement, StatementKind, Storage};

/// Largest expression that is computed though it may not be needed.
const MAX_SIZE: u32 = 8;

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
    own && place.steps.iter().all(|step| matches!(step, crate::ir::Step::Offset(_))) && place.part.is_none()
}

/// The one assignment that a branch is made of.
fn assignment(body: &[Statement]) -> Option<(&Place, &Expr)> {
    match body {
        [Statement { kind: StatementKind::Assign(target, value), .. }] if simple(target) => Some((target, value)),
        _ => None,
    }
}

impl Emitter<'_, '_> {
    /// Compiles the statement as a choice if it is one.
    pub(super) fn choice(&mut self, branches: &[IfBranch], otherwise: &[Statement]) -> bool {
        let [IfBranch { condition, body }] = branches else { return false };
        let (Some((target, first)), Some((other, second))) = (assignment(body), assignment(otherwise)) else {
            return false;
        };
        let same = target.ty == other.ty && self.slot(target).is_some() && self.slot(target) == self.slot(other);
        let ty = self.held_as(target.ty);
        let cheap = harmless(first).is_some() && harmless(second).is_some();
        if !same || !cheap || ty.is_real() {
            return false;
        }
        self.store(target, |emitter| {
            emitter.expression(first);
            emitter.expression(second);
            emitter.expression(condition);
            emitter.emit(Instruction::TypedSelect(value_type(ty)));
        });
        true
    }
}
