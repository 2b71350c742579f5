//! Why there is no mapping.

use onescan_report::{FileError, OutputError};
use onescan_scenario::ScenarioError;

use onescan_runner::error::{Usage, sum_of_errors};

sum_of_errors! {
    /// Why there is no mapping.
    pub enum MapError {
        /// The scenario or its mapping is wrong.
        #[diagnostic(transparent)]
        Scenario(ScenarioError),
        /// What was typed is wrong.
        #[diagnostic(transparent)]
        Usage(Usage),
        /// A file cannot be written.
        File(FileError),
        /// The report cannot be written.
        Output(OutputError),
    }
}
