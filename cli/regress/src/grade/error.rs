//! Why nothing was graded. What is wrong with a submission is not an error but its result.

use onescan_report::{FileError, OutputError};
use onescan_runner::error::{SpawnError, ThreadError, Unreadable, Usage, sum_of_errors};
use onescan_scenario::ScenarioError;

sum_of_errors! {
    /// Why nothing was graded. What is wrong with a submission is not an error but its result.
    pub enum GradeError {
        /// The task is wrong.
        #[diagnostic(transparent)]
        Scenario(ScenarioError),
        /// What was typed is wrong, or the task cannot be graded.
        #[diagnostic(transparent)]
        Usage(Usage),
        /// A file cannot be read.
        Unreadable(Unreadable),
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
