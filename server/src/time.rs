//! Virtual time and the count of steps. Virtual time itself is that of the ground floor, shared with the PLC.

use std::fmt;

use serde::{Deserialize, Serialize};

pub use onescan_base::duration::DurationError;
pub use onescan_base::time::{TimeSpan, VirtualTime};

/// The number of a step, counted from 1; 0 is the initial write. It is also the sequence number of
/// the step's grants on the wire.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct StepCount(pub u64);

impl fmt::Display for StepCount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}
