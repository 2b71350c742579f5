//! States from which everything is known to hold, so that ways that come to one of them are not gone further.
//!
//! What a session does from a boundary on depends on its state there alone. Whether that is what is expected depends on what
//! was seen before, too. So a way ends where its state is that of a way that was gone before with as many deviations still
//! to come, and either all that expectations have been judged by was the same, or both have been alike for longer than an
//! expectation remembers, and the same is settled.

use std::collections::BTreeMap;

use onescan_server::checkpoint::StateHash;
use onescan_server::time::VirtualTime;

use onescan_runner::run::judged::SeenHash;

/// What has been judged, as far as it matters.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Past {
    /// All values so far, as a hash.
    Seen(SeenHash),
    /// What is settled of each expectation, of two ways that have been alike for longer than they remember.
    Settled(Vec<Option<bool>>),
}

/// A state, when it was, and what is still to come.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Key {
    pub(super) at: VirtualTime,
    pub(super) state: StateHash,
    pub(super) past: Past,
    /// Exactly so many deviations come after it.
    pub(super) more: u32,
}

/// A boundary of a way at which others may join it.
#[derive(Clone, Debug)]
pub(super) struct Mark {
    /// From then on both do the same; its state may be that of an earlier boundary.
    pub(super) joined: VirtualTime,
    pub(super) key: Key,
}

/// How many schedules follow a state, all of which hold.
#[derive(Default)]
pub(super) struct Known(BTreeMap<Key, u64>);

impl Known {
    /// How many schedules follow; nothing if that is not known.
    pub(super) fn schedules(&self, key: &Key) -> Option<u64> {
        self.0.get(key).copied()
    }

    pub(super) fn add(&mut self, key: Key, schedules: u64) {
        self.0.insert(key, schedules);
    }
}

/// True at the boundaries at which a way looks whether its state is known, by the steps since its last deviation was over:
/// often at first, then more and more seldom, because what has not come together soon often never does.
pub(super) fn looks(steps: u64) -> bool {
    steps <= 8 || steps.is_power_of_two()
}
