//! All that can be said about files without running them.

use super::lint;
use crate::diagnostic::Diagnostics;
use crate::front::{Front, with_room};
use crate::input::Input;
use crate::ir::MemoryLimit;
use crate::task_plan::TaskPlan;

/// Errors and warnings of files that belong together; `plan` says which programs share a task.
///
/// What is legal and seldom meant is looked for in programs without errors only: an error makes it
/// look as if much were unused.
pub fn inspect(inputs: impl IntoIterator<Item = Input>, plan: Option<&TaskPlan>) -> Diagnostics {
    inspect_within(MemoryLimit::default(), inputs, plan)
}

/// The same, of a PLC whose variables may take so much memory.
pub fn inspect_within(
    limit: MemoryLimit,
    inputs: impl IntoIterator<Item = Input>,
    plan: Option<&TaskPlan>,
) -> Diagnostics {
    let inputs: Vec<Input> = inputs.into_iter().collect();
    with_room(|| {
        let mut front = Front::within(limit, inputs);
        add_warnings(&mut front, plan);
        Diagnostics::new(front.findings, &front.sources)
    })
}

/// Adds what is legal and seldom meant to the findings of files that have been checked and have no errors.
pub fn add_warnings(front: &mut Front, plan: Option<&TaskPlan>) {
    if !front.has_errors() {
        let warnings = lint(front, plan);
        front.findings.extend(warnings);
    }
}
