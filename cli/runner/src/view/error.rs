//! Why a recording is not shown.

use onescan_recording::RecordingError;
use onescan_report::OutputError;
use onescan_scenario::ScenarioError;

use crate::error::{Usage, sum_of_errors};
use crate::run::RunError;
use crate::web::WebError;

sum_of_errors! {
    /// Why a recording is not shown.
    pub enum ViewError {
        /// What was typed is wrong, or the recording cannot be run again.
        #[diagnostic(transparent)]
        Usage(Usage),
        /// The recorded scenario cannot be read any more.
        #[diagnostic(transparent)]
        Scenario(ScenarioError),
        /// The recording is damaged, or none.
        Recording(RecordingError),
        /// There is no page.
        #[diagnostic(transparent)]
        Web(WebError),
        /// It cannot be run again.
        #[diagnostic(transparent)]
        Run(RunError),
        /// What came of it cannot be written.
        Output(OutputError),
    }
}
