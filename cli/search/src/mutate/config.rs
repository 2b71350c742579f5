//! What is asked for.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use onescan_iec_project::mutate::MutantKind;
use onescan_server::signal::ClientName;

use onescan_runner::format::Format;

/// All options of a mutation test.
#[derive(Clone, Debug)]
pub struct MutateConfig {
    /// The scenario's folder or file.
    pub scenario: PathBuf,
    /// The soft PLC; all if absent.
    pub client: Option<ClientName>,
    /// The cases that are to notice; all if empty.
    pub cases: Vec<String>,
    /// What is changed; everything if empty.
    pub kinds: Vec<MutantKind>,
    /// So many percent are to be noticed.
    pub at_least: Option<u8>,
    /// The file for those that survived, as cases.
    pub written: Option<PathBuf>,
    /// How many at a time.
    pub jobs: NonZeroUsize,
    /// Whether a bar is shown.
    pub progress: bool,
    /// For whom the output is.
    pub format: Format,
}
