//! Why a search through many runs came to nothing: one error for all commands that search.

use onescan_report::{FileError, OutputError};
use onescan_scenario::ScenarioError;
use onescan_server::observer::RecordError;

use super::error::RunError;
use crate::error::{Usage, sum_of_errors};

sum_of_errors! {
    /// Why `explore`, `falsify`, `minimise` or `mutate` came to nothing.
    pub enum SearchError {
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
        /// A case or a picture cannot be written.
        File(FileError),
        /// The output cannot be written.
        Output(OutputError),
    }
}
