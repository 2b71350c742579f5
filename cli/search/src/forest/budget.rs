//! How many runs are allowed.

use std::num::NonZeroU64;

/// Runs that were done, of those that are allowed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Budget {
    done: u64,
    max: NonZeroU64,
}

impl Budget {
    pub(crate) fn new(max: NonZeroU64) -> Self {
        Self { done: 0, max }
    }

    /// Counts a run, also one beyond what is allowed.
    pub(crate) fn spend(&mut self) {
        self.done += 1;
    }

    pub(crate) fn done(&self) -> u64 {
        self.done
    }

    pub(crate) fn left(&self) -> u64 {
        self.max.get().saturating_sub(self.done)
    }

    pub(crate) fn is_spent(&self) -> bool {
        self.left() == 0
    }
}
