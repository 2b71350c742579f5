//! Why a project cannot be instrumented.

use onescan_report::{FileError, OutputError};
use onescan_scenario::ScenarioError;

use onescan_regress::check::CheckError;
use onescan_runner::error::{Unreadable, Usage, sum_of_errors};

sum_of_errors! {
    /// Why a project cannot be instrumented.
    pub enum InstrumentError {
        /// The sources cannot be read.
        #[diagnostic(transparent)]
        Check(CheckError),
        /// The scenario is wrong.
        #[diagnostic(transparent)]
        Scenario(ScenarioError),
        /// What was typed is wrong.
        #[diagnostic(transparent)]
        Usage(Usage),
        /// A file cannot be read.
        Unreadable(Unreadable),
        /// A file cannot be written.
        File(FileError),
        /// The report cannot be written.
        Output(OutputError),
    }
}
