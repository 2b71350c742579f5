//! Trajectories as small text that is kept beside a scenario, reviewed and compared.
//!
//! | module | subject |
//! |---|---|
//! | [`take`] | the trajectory of a run |
//! | [`value`] | values as text, and back |
//! | [`write`] | a snapshot as text |
//! | [`read`] | text as a snapshot |
//! | [`compare`] | where two differ |
//! | [`conflict`] | the two sides of a merge that git left undecided |
//! | [`overlay`] | a new trajectory over the reviewed one, as a picture |
//! | [`store`] | the files: reviewed ones, pending ones |
//!
//! # The format
//! ```text
//! onescan trajectory 1
//! scenario shear
//! case default
//! step 10ms
//! end 6.00
//!
//! signal Position_1 : LREAL (m) every 100ms of 8d3f2a91c04b5d6e
//!     0.00  -0.05
//!     0.10  -0.0525
//!
//! signal Aligned : BOOL
//!     0.00  FALSE
//!     1.23  TRUE
//!
//! done
//! ```
//! A line is an instant in seconds and the value from then on: only changes are written. REAL and LREAL, which
//! change at every step, are looked at `every` so often; the number after `of` is a digest of
//! all their steps, so that a run that differs between two samples differs all the same. Numbers have as
//! many digits as give the same bits back. The last line shows whether a file was cut off.
//!
//! **Invariants.** What is written reads back to the bit. No text makes reading panic.

pub mod compare;
pub mod conflict;
mod error;
pub mod overlay;
pub mod read;
pub mod store;
pub mod take;
pub mod value;
pub mod write;

use onescan_server::signal::SignalType;
use onescan_server::time::{TimeSpan, VirtualTime};

pub use compare::{Difference, compare};
pub use error::StoreError;
pub use read::SnapshotError;

/// The version of the format.
const VERSION: u32 = 1;
const DONE: &str = "done";

/// Chosen signals of one run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Snapshot {
    pub scenario: String,
    pub case: String,
    pub step: TimeSpan,
    /// Virtual time of the last step.
    pub end: VirtualTime,
    pub signals: Vec<Track>,
}

/// One signal over a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Track {
    pub name: String,
    pub ty: SignalType,
    pub unit: Option<String>,
    /// How far apart samples are, and the digest of all steps; nothing where every change is held.
    pub sampled: Option<Sampled>,
    /// Each value with the instant from which it holds, the first at 0.
    pub changes: Vec<(VirtualTime, Vec<u8>)>,
}

/// Of a signal that is not held at every step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampled {
    /// How far apart samples are.
    pub every: TimeSpan,
    /// The digest of all steps.
    pub digest: u64,
}

impl Track {
    /// The value that holds at an instant.
    pub fn at(&self, t_v: VirtualTime) -> Option<&[u8]> {
        let next = self.changes.partition_point(|(since, _)| *since <= t_v);
        self.changes.get(next.checked_sub(1)?).map(|(_, bytes)| bytes.as_slice())
    }

    /// What is to be added to the values of `old` to give these, as LREAL.
    pub fn less(&self, old: &Self) -> Self {
        let mut times: Vec<VirtualTime> = old.changes.iter().chain(&self.changes).map(|(since, _)| *since).collect();
        times.sort_unstable();
        times.dedup();
        let number = |track: &Self, t_v| track.at(t_v).and_then(|bytes| track.ty.as_f64(bytes));
        let changes = times.into_iter().filter_map(|t_v| {
            let by = number(self, t_v)? - number(old, t_v)?;
            Some((t_v, by.to_le_bytes().to_vec()))
        });
        Self { ty: SignalType::LREAL, changes: changes.collect(), ..self.clone() }
    }

    /// The name with its unit.
    pub fn heading(&self) -> String {
        self.unit.as_ref().map_or_else(|| self.name.clone(), |unit| format!("{} ({unit})", self.name))
    }
}
