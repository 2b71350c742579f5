//! What is asked for.

use std::num::NonZeroU64;
use std::path::PathBuf;

use onescan_server::time::VirtualTime;

use onescan_runner::format::Format;
use onescan_runner::how_far::HowFar;

/// All options of an exploration.
#[derive(Clone, Debug)]
pub struct ExploreConfig {
    /// The scenario's folder or file.
    pub scenario: PathBuf,
    /// The case to which deviations come; the scenario as it is if absent.
    pub case: Option<String>,
    /// When a run is complete; the scenario says so if absent.
    pub until: Option<VirtualTime>,
    /// So many deviations at a time, at most.
    pub bound: u32,
    /// Whether it goes on after the first finding.
    pub all: bool,
    /// So many runs are tried at most.
    pub runs_max: NonZeroU64,
    /// Whether every way is gone to its end, also where its state is known.
    pub no_merge: bool,
    /// So many random schedules are tried beyond the bound.
    pub samples: u64,
    /// What they are drawn with.
    pub seed: u64,
    /// So many deviations they have at most.
    pub most: u32,
    /// The file for the findings as cases.
    pub cases: Option<PathBuf>,
    /// For whom the output is.
    pub format: Format,
    /// Counts the runs, for one whom a signal interrupts.
    pub how_far: HowFar,
}
