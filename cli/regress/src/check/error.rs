//! Why sources cannot be checked. What is wrong in them is not an error but a finding.

use onescan_report::OutputError;
use onescan_scenario::ScenarioError;

use onescan_runner::error::{Unreadable, Usage, sum_of_errors};

sum_of_errors! {
    /// Why sources cannot be checked. What is wrong in them is not an error but a finding.
    pub enum CheckError {
        /// The scenario is wrong.
        #[diagnostic(transparent)]
        Scenario(ScenarioError),
        /// What was typed is wrong.
        #[diagnostic(transparent)]
        Usage(Usage),
        /// A file cannot be read.
        Unreadable(Unreadable),
        /// The report cannot be written.
        Output(OutputError),
    }
}
