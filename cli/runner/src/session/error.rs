//! Why this process took no part in a session.

use onescan_report::OutputError;
use onescan_scenario::ScenarioError;
use onescan_server::transport::tcp::participant::ParticipantError;

use crate::error::{Usage, sum_of_errors};

sum_of_errors! {
    /// Why this process took no part in a session.
    pub enum SessionError {
        /// The scenario is wrong.
        #[diagnostic(transparent)]
        Scenario(ScenarioError),
        /// What was typed is wrong.
        #[diagnostic(transparent)]
        Usage(Usage),
        /// This process is a client and could not stay to the end.
        Participant(ParticipantError),
        /// The report cannot be written.
        Output(OutputError),
    }
}
