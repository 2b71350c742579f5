//! What a task runs: functions without parameters, one after the other (2nd ed. 2.7.2).

use std::collections::{BTreeMap, BTreeSet};

use super::emitter::{Made, Shared};
use super::function;
use crate::compile::fault::FunctionMarks;
use onescan_iec::check::Checked;
use onescan_iec::ir::{Pou, PouId, StatementKind, Storage};

/// No unit has it.
const NONE: PouId = PouId(u32::MAX);

/// A function without parameters, and what its instructions stand for; `is_entry` if it is one of an entry.
pub(crate) fn function(shared: &mut Shared<'_>, unit: &Pou, is_entry: bool) -> (wasm_encoder::Function, FunctionMarks) {
    let Made { body, marks, units } = function::unit(shared, NONE, unit, None);
    (body, FunctionMarks { units, is_entry, marks })
}

/// The programs that have one instance in all entries, with its offset in memory. A function block
/// with a task of its own may have others, which programs call.
pub(crate) fn only_instances(checked: &Checked) -> BTreeMap<PouId, u32> {
    let is_program = |id: PouId| checked.programs.iter().any(|program| program.pou == id);
    let mut known: BTreeMap<PouId, BTreeSet<Option<u32>>> = BTreeMap::new();
    for statement in checked.entries.iter().flat_map(|entry| &entry.units).flat_map(|unit| &unit.body) {
        if let StatementKind::CallInstance(call) = &statement.kind
            && is_program(call.pou)
        {
            let fixed = call.instance.steps.is_empty();
            let offset = match call.instance.storage {
                Storage::Absolute(offset) if fixed => Some(offset),
                _ => None,
            };
            known.entry(call.pou).or_default().insert(offset);
        }
    }
    let only = |(pou, offsets): (PouId, BTreeSet<Option<u32>>)| match offsets.first() {
        Some(Some(offset)) if offsets.len() == 1 => Some((pou, *offset)),
        _ => None,
    };
    known.into_iter().filter_map(only).collect()
}
