//! Why a falsification came to nothing.

use onescan_report::{FileError, OutputError};
use onescan_scenario::ScenarioError;
use onescan_server::observer::RecordError;

use crate::error::{Usage, sum_of_errors};
use crate::run::RunError;

sum_of_errors! {
    /// Why a falsification came to nothing.
    pub enum FalsifyError {
        /// The scenario is wrong.
        #[diagnostic(transparent)]
        Scenario(ScenarioError),
        /// What was typed is wrong.
        #[diagnostic(transparent)]
        Usage(Usage),
        /// A session cannot be formed, saved or taken up.
        #[diagnostic(transparent)]
        Run(RunError),
        /// A session could not go on.
        Record(RecordError),
        /// The case or the picture cannot be written.
        File(FileError),
        /// The output cannot be written.
        Output(OutputError),
    }
}
