//! What a task runs: functions without parameters, one after the other (2nd ed. 2.7.2).

use super::emitter::Shared;
use super::fault::FunctionMarks;
use super::function;
use crate::ir::Pou;

/// A function of an entry, and what its instructions stand for.
pub(super) fn function(shared: &mut Shared<'_>, unit: &Pou) -> (wasm_encoder::Function, FunctionMarks) {
    let (body, marks) = function::unit(shared, unit);
    (body, FunctionMarks { name: unit.name.clone(), is_entry: true, marks })
}
