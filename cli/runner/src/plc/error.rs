//! Why a PLC does not run.

use onescan_report::OutputError;
use onescan_scenario::ScenarioError;

use crate::error::{ListenError, ThreadError, Usage, sum_of_errors};

sum_of_errors! {
    /// Why a PLC does not run.
    pub enum PlcError {
        /// The scenario is wrong.
        #[diagnostic(transparent)]
        Scenario(ScenarioError),
        /// What was typed is wrong.
        #[diagnostic(transparent)]
        Usage(Usage),
        /// An address cannot be listened on.
        Listen(ListenError),
        /// There is no thread.
        Thread(ThreadError),
        /// The report cannot be written.
        Output(OutputError),
    }
}
