//! Why nothing is known of a PLC.

use onescan_links::gateway::SettingsFault;
use onescan_report::{FileError, OutputError};
use onescan_scenario::ScenarioError;

use onescan_runner::error::sum_of_errors;

sum_of_errors! {
    /// Why nothing is known of a PLC.
    pub enum BrowseError {
        /// The scenario is wrong.
        #[diagnostic(transparent)]
        Scenario(ScenarioError),
        /// The PLC does not say what it has.
        Settings(SettingsFault),
        /// A file cannot be written.
        File(FileError),
        /// The report cannot be written.
        Output(OutputError),
    }
}
