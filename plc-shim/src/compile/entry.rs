//! What a task runs: a function without parameters (2nd ed. 2.7.2).

use super::emitter::Shared;
use super::fault::FunctionMarks;
use super::function;
use crate::ir::Entry;

/// The function of an entry, and what its instructions stand for.
pub(super) fn entry(shared: &mut Shared<'_>, entry: &Entry) -> (wasm_encoder::Function, FunctionMarks) {
    let (body, marks) = function::unit(shared, &entry.unit);
    (body, FunctionMarks { name: entry.name.clone(), is_entry: true, marks })
}
