//! What a loop's body adds to variables.

use super::range::Slot;
use onescan_iec::ir::ElementaryType;

/// Constants that a loop's body adds to a variable, each at most once a turn.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Step {
    pub(crate) slot: Slot,
    pub(crate) ty: ElementaryType,
    pub(crate) up: i128,
    pub(crate) down: i128,
    pub(crate) count: u32,
}

/// The steps of a loop's body.
#[derive(Debug, Clone, Default)]
pub(crate) struct Steps {
    pub(crate) found: Vec<Step>,
    /// How many loops are open: in an inner one, a step may be taken any number of times.
    depth: u32,
}

/// Most variables that are looked at. A body that counts more is a table, not a loop.
const MAX_STEPS: usize = 32;

impl Steps {
    pub(crate) fn open_turn(&mut self) {
        self.depth += 1;
    }

    pub(crate) fn close_turn(&mut self) {
        debug_assert!(self.depth > 0, "only a turn that was opened ends");
        self.depth -= 1;
    }

    pub(crate) fn note(&mut self, slot: Slot, ty: ElementaryType, by: i128) {
        if self.depth != 1 {
            return;
        }
        let known = self.found.iter().position(|step| step.slot == slot && step.ty == ty);
        let index = known.unwrap_or(self.found.len());
        if known.is_none() {
            if index >= MAX_STEPS {
                return;
            }
            self.found.push(Step { slot, ty, up: 0, down: 0, count: 0 });
        }
        if let Some(step) = self.found.get_mut(index) {
            step.up += by.max(0);
            step.down += (-by).max(0);
            step.count += 1;
        }
    }
}
