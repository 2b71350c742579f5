//! Why nothing was reported.

use onescan_recording::RecordingError;
use onescan_report::{FileError, OutputError};
use onescan_scenario::ScenarioError;

use crate::error::{Usage, sum_of_errors};

sum_of_errors! {
    /// Why nothing was reported.
    pub enum ReportError {
        /// What was typed is wrong, or the recording does not have what the report needs.
        #[diagnostic(transparent)]
        Usage(Usage),
        /// The scenario is wrong.
        #[diagnostic(transparent)]
        Scenario(ScenarioError),
        /// A recording cannot be read.
        Recording(RecordingError),
        /// A file cannot be written.
        File(FileError),
        /// The report cannot be written.
        Output(OutputError),
    }
}
