//! Why a mutation test came to nothing.

use onescan_report::OutputError;
use onescan_scenario::ScenarioError;
use onescan_server::observer::RecordError;

use crate::error::{Usage, sum_of_errors};
use crate::run::RunError;

sum_of_errors! {
    /// Why a mutation test came to nothing.
    pub enum MutateError {
        /// The scenario is wrong.
        #[diagnostic(transparent)]
        Scenario(ScenarioError),
        /// What was typed is wrong.
        #[diagnostic(transparent)]
        Usage(Usage),
        /// A session cannot be formed.
        #[diagnostic(transparent)]
        Run(RunError),
        /// A session could not go on.
        Record(RecordError),
        /// The output cannot be written.
        Output(OutputError),
    }
}
