//! One unit to one function.

use wasm_encoder::Function;

use super::emitter::{Emitter, Shared};
use super::fault::Mark;
use crate::ir::{Expr, ExprKind, Pou};

/// The function of a unit, and what its instructions stand for.
pub(super) fn unit(shared: &mut Shared<'_>, pou: &Pou) -> (Function, Vec<(u32, Mark)>) {
    let mut emitter = Emitter::new(shared, &pou.registers, pou.parameters);
    emitter.mark_statement(pou.span);
    emitter.enter_guarded(pou);
    let end = emitter.open_block();
    emitter.end = Some(end);
    emitter.statements(&pou.body);
    emitter.close();
    emitter.leave_guarded(pou);
    if let Some(result) = &pou.result {
        let kind = ExprKind::Load(result.clone());
        emitter.expression(&Expr { kind, ty: result.ty, span: result.span });
    }
    emitter.finish()
}
