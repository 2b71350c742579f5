//! Why there is no new scenario.

use onescan_report::{FileError, OutputError};

use crate::io_list::ListError;
use crate::plant::PlantError;
use onescan_runner::error::{Unreadable, Usage, sum_of_errors};
use onescan_scenario::ScenarioError;

sum_of_errors! {
    /// Why there is no new scenario.
    pub enum NewError {
        /// What was typed is wrong.
        #[diagnostic(transparent)]
        Usage(Usage),
        /// The I/O list cannot be read.
        #[diagnostic(transparent)]
        List(ListError),
        /// The task is wrong.
        #[diagnostic(transparent)]
        Scenario(ScenarioError),
        /// The machine of the task cannot be drawn.
        #[diagnostic(transparent)]
        Plant(PlantError),
        /// A file of the task cannot be read.
        Unreadable(Unreadable),
        /// A file cannot be written.
        File(FileError),
        /// The report cannot be written.
        Output(OutputError),
    }
}
