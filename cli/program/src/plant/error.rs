//! Why a scene or the library cannot be described.

use onescan_report::{FileError, OutputError};
use onescan_scenario::ScenarioError;

use onescan_runner::error::{Usage, sum_of_errors};

sum_of_errors! {
    /// Why a scene or the library cannot be described.
    pub enum PlantError {
        /// The scenario is wrong.
        #[diagnostic(transparent)]
        Scenario(ScenarioError),
        /// What was typed is wrong.
        #[diagnostic(transparent)]
        Usage(Usage),
        /// The picture cannot be written.
        File(FileError),
        /// The report cannot be written.
        Output(OutputError),
    }
}
