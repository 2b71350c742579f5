//! Why a minimisation came to nothing.

use onescan_report::{FileError, OutputError};
use onescan_scenario::ScenarioError;
use onescan_server::observer::RecordError;

use crate::error::{Usage, sum_of_errors};
use crate::run::RunError;

sum_of_errors! {
    /// Why a minimisation came to nothing.
    pub enum MinimiseError {
        /// The scenario is wrong.
        #[diagnostic(transparent)]
        Scenario(ScenarioError),
        /// What was typed is wrong.
        #[diagnostic(transparent)]
        Usage(Usage),
        /// A session cannot be formed, saved or forked.
        #[diagnostic(transparent)]
        Run(RunError),
        /// A session could not go on.
        Record(RecordError),
        /// The case cannot be written.
        File(FileError),
        /// The output cannot be written.
        Output(OutputError),
    }
}
