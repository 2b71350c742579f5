//! Why nothing came of a run.

use std::path::PathBuf;

use miette::Diagnostic;
use onescan_recording::RecordingError;
use onescan_report::{FileError, OutputError};
use onescan_scenario::ScenarioError;
use onescan_server::checkpoint::CheckpointError;
use onescan_server::formation::FormationError;
use onescan_server::observer::RecordError;
use onescan_server::time::VirtualTime;
use thiserror::Error;

use crate::access::AccessError;
use crate::error::{Exit, ExitCode, ListenError, SpawnError, Unreadable, Usage};
use crate::web::WebError;

/// Why nothing came of a run.
#[derive(Debug, Error, Diagnostic)]
pub enum RunError {
    /// The scenario is wrong.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Scenario(#[from] ScenarioError),
    /// The options are wrong.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Usage(#[from] Usage),
    /// The session could not be formed.
    #[error(transparent)]
    Formation(#[from] FormationError),
    /// A client's process left before it joined.
    #[error("the process of client `{client}` ended before it joined ({status})")]
    ClientProcess { client: String, status: String },
    /// A client's process cannot be started.
    #[error(transparent)]
    Spawn(#[from] SpawnError),
    /// The address cannot be listened on.
    #[error(transparent)]
    Listen(#[from] ListenError),
    /// There is no page.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Web(#[from] WebError),
    /// Anybody could take part, or nobody can be let in.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Access(#[from] AccessError),
    /// A recording cannot be written.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// A recording could not be written to its end.
    #[error("{source}; {kept}")]
    RecordCut {
        source: RecordError,
        /// What there is of it.
        kept: String,
    },
    /// A recording cannot be read.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// A file cannot be read.
    #[error(transparent)]
    Unreadable(#[from] Unreadable),
    /// A file cannot be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// A checkpoint cannot be taken.
    #[error("cannot save the session: {0}")]
    Save(CheckpointError),
    /// A session does not go on from where another one was.
    #[error("cannot fork the session: {0}")]
    Fork(CheckpointError),
    /// The run ended before the checkpoint could be taken.
    #[error("cannot save the session: it ended at t_v = {0}, before the checkpoint was due")]
    SaveTooLate(VirtualTime),
    /// A checkpoint cannot be taken up.
    #[error("cannot resume from {}: {source}", path.display())]
    Resume { path: PathBuf, source: CheckpointError },
    /// What the case does to the session cannot be done.
    #[error("the case cannot be put on this session: {0}")]
    Timeline(onescan_server::operation::OperationError),
    /// The report cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
}

impl Exit for RunError {
    fn exit_code(&self) -> ExitCode {
        match self {
            Self::Scenario(error) => error.exit_code(),
            Self::Usage(error) => error.exit_code(),
            Self::Formation(error) => error.exit_code(),
            Self::Spawn(error) => error.exit_code(),
            Self::Listen(error) => error.exit_code(),
            Self::Web(error) => error.exit_code(),
            Self::Access(error) => error.exit_code(),
            Self::Record(error) => error.exit_code(),
            Self::RecordCut { source, .. } => source.exit_code(),
            Self::Recording(error) => error.exit_code(),
            Self::Unreadable(error) => error.exit_code(),
            Self::File(error) => error.exit_code(),
            Self::Output(error) => error.exit_code(),
            Self::ClientProcess { .. } | Self::Save(_) | Self::Fork(_) | Self::SaveTooLate(_) => ExitCode::Fault,
            Self::Resume { .. } | Self::Timeline(_) => ExitCode::WrongInput,
        }
    }
}
