//! Why nothing came of a run, and whose fault that is.

use miette::Diagnostic;
use onescan_clients::gateway::{LinkFault, SettingsFault};
use onescan_scenario::ScenarioError;
use onescan_server::checkpoint::CheckpointError;
use onescan_server::formation::FormationError;
use onescan_server::record::RecordError;
use onescan_server::recording::RecordingError;
use onescan_server::transport::tcp::participant::ParticipantError;
use thiserror::Error;

/// Why nothing came of a run.
#[derive(Debug, Error, Diagnostic)]
pub enum RunError {
    /// The scenario is wrong.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Scenario(#[from] ScenarioError),
    /// PLC sources that do not compile.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Sources(#[from] Box<crate::regress::unit_test::SourcesReport>),
    /// The options are wrong.
    #[error("{message}")]
    Usage {
        /// What is wrong.
        message: String,
        /// What to do.
        #[help]
        help: Option<String>,
    },
    /// The session could not be formed.
    #[error(transparent)]
    Formation(#[from] FormationError),
    /// A client's process left before it joined.
    #[error("the process of client `{client}` ended before it joined ({status})")]
    ClientProcess {
        /// Who.
        client: String,
        /// How it ended.
        status: String,
    },
    /// A client's process cannot be started.
    #[error("cannot start `{command}` for client `{client}`: {source}")]
    Spawn {
        /// Who.
        client: String,
        /// The program.
        command: String,
        /// Why.
        source: std::io::Error,
    },
    /// The address cannot be listened on.
    #[error("cannot listen on {address}: {source}")]
    Listen {
        /// Where.
        address: std::net::SocketAddr,
        /// Why.
        source: std::io::Error,
    },
    /// A recording cannot be written.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// A recording cannot be read.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// A file cannot be read.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: std::path::PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] onescan_report::FileError),
    /// A checkpoint cannot be taken.
    #[error("cannot save the session: {0}")]
    Save(CheckpointError),
    /// The run ended before the checkpoint could be taken.
    #[error("cannot save the session: it ended at t_v = {0}, before the checkpoint was due")]
    SaveTooLate(onescan_server::time::VirtualTime),
    /// A checkpoint cannot be taken up.
    #[error("cannot resume from {}: {source}", path.display())]
    Resume {
        /// The file.
        path: std::path::PathBuf,
        /// Why.
        source: CheckpointError,
    },
    /// A PLC does not say what it has.
    #[error("{0}")]
    Browse(SettingsFault),
    /// The report cannot be written.
    #[error("cannot write the report: {0}")]
    Output(std::io::Error),
    /// This process is a client and could not stay to the end.
    #[error(transparent)]
    Participant(#[from] ParticipantError),
}

/// What the program tells the shell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExitCode {
    /// All is well.
    Ok = 0,
    /// A run failed its expectations: those of its scenario, or runs that must be equal are not.
    Unmet = 1,
    /// The input is wrong: options, scenario, sources, checkpoint.
    WrongInput = 2,
    /// A client or a link failed.
    Fault = 3,
}

impl RunError {
    pub(crate) fn usage(message: impl Into<String>, help: Option<String>) -> Self {
        Self::Usage { message: message.into(), help }
    }

    /// Whose fault it is.
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::Formation(
                FormationError::Missing { .. } | FormationError::Interrupted { .. } | FormationError::Connection(_),
            )
            | Self::ClientProcess { .. }
            | Self::Spawn { .. }
            | Self::Scenario(ScenarioError::Link { .. })
            | Self::Browse(SettingsFault::Link(
                LinkFault::Unreachable { .. } | LinkFault::Refused { .. } | LinkFault::Lost(_),
            ))
            | Self::Save(_)
            | Self::SaveTooLate(_) => ExitCode::Fault,
            Self::Participant(error) if !matches!(error, ParticipantError::Refused(_)) => ExitCode::Fault,
            _ => ExitCode::WrongInput,
        }
    }
}
