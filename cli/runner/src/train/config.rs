//! What is asked for.

use std::net::SocketAddr;
use std::path::PathBuf;

use onescan_server::pacing::Pace;
use onescan_server::signal::ClientName;

use crate::access::admission::Admission;
use crate::format::Format;

/// All options of a lesson.
#[derive(Clone, Debug)]
pub struct TrainConfig {
    /// The scenario's folder or file.
    pub scenario: PathBuf,
    /// The lesson; all are listed if absent.
    pub lesson: Option<String>,
    pub trainee: String,
    /// Real PLCs that stand in for soft ones, and where they are if that is not where the scenario says.
    pub gateways: Vec<(ClientName, Option<String>)>,
    /// Where it is served as pages, and how fast.
    pub served: Option<Served>,
    /// A recording, a file of events or a session whose operators' inputs are repeated.
    pub replay_operator: Option<PathBuf>,
    /// The folder for the record of the session.
    pub record: Option<PathBuf>,
    /// Whether an earlier record there may be replaced.
    pub overwrite: bool,
    /// The folder in which prepared states are kept.
    pub starts: Option<PathBuf>,
    /// File for a page about the session.
    pub html: Option<PathBuf>,
    /// For whom the report is.
    pub format: Format,
}

/// The pages of a lesson.
#[derive(Clone, Debug)]
pub struct Served {
    /// Where the trainee's page is.
    pub trainee: SocketAddr,
    /// Where the trainer's is.
    pub trainer: SocketAddr,
    /// Who is let in to both; with tokens, trainers alone to the trainer's.
    pub admission: Admission,
    /// How fast virtual time may run.
    pub pace: Pace,
}
