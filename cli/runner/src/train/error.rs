//! Why nothing came of a lesson.

use std::path::PathBuf;

use miette::Diagnostic;
use onescan_report::{FileError, OutputError};
use onescan_scenario::ScenarioError;
use onescan_server::checkpoint::CheckpointError;
use onescan_server::end::Failure;
use onescan_server::observer::RecordError;
use thiserror::Error;

use crate::error::{Exit, ExitCode, Unreadable, Usage, sum_of_errors};
use crate::run::RunError;
use crate::web::WebError;

/// A session that does not begin where it should.
#[derive(Debug, Error, Diagnostic)]
pub enum StartError {
    /// The run that makes a prepared state ends before it.
    #[error("there is no start `{name}`: the run that makes it ended at t_v = {ended}")]
    Ended { name: String, ended: onescan_server::time::VirtualTime },
    /// A client failed in the run that makes it.
    #[error("there is no start `{name}`: {failure}")]
    Failed { name: String, failure: Failure },
    /// The program was asked to end while the run that makes it was under way.
    #[error("start `{name}` was not made: the program was asked to end")]
    Interrupted { name: String },
    /// A client cannot be saved, or not be taken up.
    #[error("start `{name}`: {source}")]
    Checkpoint { name: String, source: CheckpointError },
}

impl Exit for StartError {
    fn exit_code(&self) -> ExitCode {
        match self {
            Self::Ended { .. } => ExitCode::WrongInput,
            Self::Failed { .. } | Self::Interrupted { .. } | Self::Checkpoint { .. } => ExitCode::Fault,
        }
    }
}

/// A file that is not the record of a session.
#[derive(Debug, Error, Diagnostic)]
#[error("{} is not the record of a session: {source}", path.display())]
pub struct NoRecord {
    pub path: PathBuf,
    pub source: serde_json::Error,
}

impl Exit for NoRecord {
    fn exit_code(&self) -> ExitCode {
        ExitCode::WrongInput
    }
}

sum_of_errors! {
    /// Why nothing came of a lesson.
    pub enum TrainError {
        /// The scenario or its lessons are wrong.
        #[diagnostic(transparent)]
        Scenario(ScenarioError),
        /// What was typed is wrong.
        #[diagnostic(transparent)]
        Usage(Usage),
        /// A session cannot be formed.
        #[diagnostic(transparent)]
        Run(RunError),
        /// A session does not begin where it should.
        Start(StartError),
        /// A session could not go on.
        Record(RecordError),
        /// There are no pages.
        #[diagnostic(transparent)]
        Web(WebError),
        /// A file cannot be read.
        Unreadable(Unreadable),
        /// A file is not a record.
        NoRecord(NoRecord),
        /// A file cannot be written.
        File(FileError),
        /// The report cannot be written.
        Output(OutputError),
    }
}
