//! Why a scenario is not shown.

use onescan_report::OutputError;
use onescan_scenario::ScenarioError;

use onescan_runner::error::sum_of_errors;

sum_of_errors! {
    /// Why a scenario is not shown.
    pub enum ShowError {
        /// The scenario is wrong.
        #[diagnostic(transparent)]
        Scenario(ScenarioError),
        /// It cannot be written.
        Output(OutputError),
    }
}
