//! How many runs are allowed.

use std::num::NonZeroU64;

use onescan_runner::how_far::HowFar;

/// Runs that were done, of those that are allowed.
#[derive(Clone, Debug)]
pub(crate) struct Budget {
    done: u64,
    max: NonZeroU64,
    /// Counts them, too, for one whom a signal interrupts.
    how_far: Option<HowFar>,
}

impl Budget {
    pub(crate) fn new(max: NonZeroU64) -> Self {
        Self { done: 0, max, how_far: None }
    }

    pub(crate) fn counted(max: NonZeroU64, how_far: HowFar) -> Self {
        how_far.set_total(max.get());
        Self { how_far: Some(how_far), ..Self::new(max) }
    }

    /// Counts a run, also one beyond what is allowed.
    pub(crate) fn spend(&mut self) {
        self.done += 1;
        self.how_far.iter().for_each(HowFar::one_more);
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
