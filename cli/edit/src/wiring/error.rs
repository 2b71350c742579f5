//! Why the wiring of clients cannot be reported.

use onescan_report::{FileError, OutputError};
use onescan_scenario::ScenarioError;

use onescan_runner::error::sum_of_errors;

sum_of_errors! {
    /// Why the wiring of clients cannot be reported.
    pub enum WiringError {
        /// The scenario is wrong.
        #[diagnostic(transparent)]
        Scenario(ScenarioError),
        /// A file cannot be written.
        File(FileError),
        /// The report cannot be written.
        Output(OutputError),
    }
}
