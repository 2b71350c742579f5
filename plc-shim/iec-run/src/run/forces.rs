//! The variables that keep a value, and the values.

use crate::application::Variable;

/// A variable that keeps a value.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Force {
    pub(super) variable: Variable,
    /// As many as the variable has.
    pub(super) bytes: Vec<u8>,
}

/// All forces, the oldest first.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Forces {
    list: Vec<Force>,
}

impl Forces {
    pub(super) fn apply(&self, memory: &mut [u8]) {
        for Force { variable, bytes } in &self.list {
            debug_assert!(variable.offset as usize + bytes.len() <= memory.len(), "a force lies within memory");
            variable.store(bytes, memory);
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    pub(super) fn iter(&self) -> impl ExactSizeIterator<Item = &Force> {
        self.list.iter()
    }

    pub(super) fn hold(&mut self, variable: Variable, bytes: Vec<u8>) {
        debug_assert_eq!(bytes.len(), variable.size as usize, "a force has as many bytes as its variable");
        self.release(&variable);
        self.list.push(Force { variable, bytes });
    }

    /// False if it was not forced.
    pub(super) fn release(&mut self, variable: &Variable) -> bool {
        let before = self.list.len();
        let same = |force: &Force| force.variable.place() == variable.place();
        self.list.retain(|force| !same(force));
        self.list.len() < before
    }

    pub(super) fn clear(&mut self) {
        self.list.clear();
    }
}
