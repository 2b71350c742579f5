//! What is asked for.

use std::num::NonZeroU64;
use std::path::PathBuf;

use onescan_server::signal::ClientName;
use onescan_server::time::VirtualTime;

use onescan_runner::format::Format;

/// All options of a minimisation.
#[derive(Clone, Debug)]
pub struct MinimiseConfig {
    /// The scenario's folder or file.
    pub scenario: PathBuf,
    /// The case that fails, also one of a matrix or a campaign; the scenario as it is if absent.
    pub case: Option<String>,
    /// Clients in whose place operators were.
    pub operated: Vec<ClientName>,
    /// A recording, or a file of events, of operators who made it fail.
    pub replay_operator: Option<PathBuf>,
    /// The expectation that is to fail; the first that does if absent.
    pub expect: Option<String>,
    /// When a run is complete; the case says so if absent.
    pub until: Option<VirtualTime>,
    /// So many sets of entries are tried at most.
    pub runs_max: NonZeroU64,
    /// Name of what is left.
    pub name: String,
    /// The file for what is left.
    pub cases: Option<PathBuf>,
    /// For whom the output is.
    pub format: Format,
}
