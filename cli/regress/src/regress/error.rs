//! Why nothing was tested. What is wrong with a test is not an error but an outcome.

use onescan_iec::Diagnostics;
use onescan_report::{FileError, OutputError};
use onescan_scenario::ScenarioError;
use thiserror::Error;

use crate::check::CheckError;
use crate::repository::RepositoryError;
use crate::snapshot::StoreError;
use onescan_runner::error::{Exit, ExitCode, SpawnError, ThreadError, Unreadable, Usage, sum_of_errors};
use onescan_runner::run::RunError;

sum_of_errors! {
    /// Why nothing was tested. What is wrong with a test is not an error but an outcome.
    pub enum TestError {
        /// The scenario is wrong.
        #[diagnostic(transparent)]
        Scenario(ScenarioError),
        /// What was typed is wrong.
        #[diagnostic(transparent)]
        Usage(Usage),
        /// A file cannot be read.
        Unreadable(Unreadable),
        /// A snapshot cannot be read or written.
        #[diagnostic(transparent)]
        Snapshot(StoreError),
        /// The sources cannot be read.
        #[diagnostic(transparent)]
        Check(CheckError),
        /// Nothing came of a run.
        #[diagnostic(transparent)]
        Run(RunError),
        /// Sources with test programs do not compile.
        #[diagnostic(transparent)]
        Sources(Box<SourcesReport>),
        /// The repository does not answer.
        #[diagnostic(transparent)]
        Repository(RepositoryError),
        /// A process cannot be started.
        Spawn(SpawnError),
        /// The system has no thread to give.
        Thread(ThreadError),
        /// A file cannot be written.
        File(FileError),
        /// The report cannot be written.
        Output(OutputError),
    }
}

/// Sources that do not compile.
#[derive(Debug, Error)]
#[error("the sources do not compile")]
pub struct SourcesReport {
    pub findings: Diagnostics,
}

impl Exit for Box<SourcesReport> {
    fn exit_code(&self) -> ExitCode {
        ExitCode::WrongInput
    }
}

impl miette::Diagnostic for SourcesReport {
    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn miette::Diagnostic> + 'a>> {
        Some(Box::new(self.findings.errors()))
    }
}
