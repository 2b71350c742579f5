//! What is asked for.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use onescan_server::time::TimeSpan;

use crate::format::Format;

/// All options of a campaign.
#[derive(Clone, Debug)]
pub struct CampaignConfig {
    /// The scenario's folder or file.
    pub scenario: PathBuf,
    /// Which campaign; all if absent.
    pub campaign: Option<String>,
    /// How many runs at a time, each in a process of its own.
    pub jobs: NonZeroUsize,
    /// How long a run may take.
    pub timeout: TimeSpan,
    /// For whom the output is.
    pub format: Format,
    /// The file for a page of all campaigns; none if absent.
    pub html: Option<PathBuf>,
    /// A report in the format of `JUnit`.
    pub junit: Option<PathBuf>,
    /// True where a progress bar would be seen.
    pub progress: bool,
}

/// What a process is to run.
#[derive(Clone, Debug)]
pub struct WorkerConfig {
    /// The scenario's folder or file.
    pub scenario: PathBuf,
    /// The campaign's name in `cases.toml`.
    pub campaign: String,
    /// Which of its cases; the run without faults if absent.
    pub case: Option<String>,
}
