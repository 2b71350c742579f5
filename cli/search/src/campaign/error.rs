//! Why there is no table.

use miette::Diagnostic;
use onescan_report::{FileError, OutputError};
use onescan_scenario::ScenarioError;
use thiserror::Error;

use crate::forest::JournalError;
use onescan_runner::error::{Exit, ExitCode, SpawnError, ThreadError, Unreadable, Usage, sum_of_errors};
use onescan_runner::run::RunError;

sum_of_errors! {
    /// Why there is no table.
    pub enum CampaignError {
        /// The scenario or the campaign is wrong.
        #[diagnostic(transparent)]
        Scenario(ScenarioError),
        /// What was typed is wrong.
        #[diagnostic(transparent)]
        Usage(Usage),
        /// Nothing came of a run.
        #[diagnostic(transparent)]
        Run(RunError),
        /// The process of a run ended without a reading.
        #[diagnostic(transparent)]
        Ended(Ended),
        /// A process cannot be started.
        Spawn(SpawnError),
        /// There is no thread.
        Thread(ThreadError),
        /// The journal of the work cannot be used.
        #[diagnostic(transparent)]
        Journal(JournalError),
        /// A file of the work, or of the scenario, cannot be read.
        Unreadable(Unreadable),
        /// A report, or a file of the work, cannot be written.
        File(FileError),
        /// The output cannot be written.
        Output(OutputError),
    }
}

/// A run that came to nothing.
#[derive(Debug, Error, Diagnostic)]
#[error("`{name}`: {text}")]
pub struct Ended {
    /// The campaign or its case.
    pub name: String,
    /// Why, drawn.
    pub text: String,
    /// The exit code of its process.
    pub code: i32,
}

impl Exit for Ended {
    fn exit_code(&self) -> ExitCode {
        if self.code == ExitCode::WrongInput as i32 { ExitCode::WrongInput } else { ExitCode::Fault }
    }
}
