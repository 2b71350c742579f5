//! Why there is no new scenario.

use onescan_report::{FileError, OutputError};

use crate::io_list::ListError;
use onescan_runner::error::{Usage, sum_of_errors};

sum_of_errors! {
    /// Why there is no new scenario.
    pub enum NewError {
        /// What was typed is wrong.
        #[diagnostic(transparent)]
        Usage(Usage),
        /// The I/O list cannot be read.
        #[diagnostic(transparent)]
        List(ListError),
        /// A file cannot be written.
        File(FileError),
        /// The report cannot be written.
        Output(OutputError),
    }
}
