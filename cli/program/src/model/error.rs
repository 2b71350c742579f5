//! Why there is no model.

use onescan_report::{FileError, OutputError};

use onescan_runner::error::sum_of_errors;

sum_of_errors! {
    /// Why there is no model.
    pub enum ModelError {
        /// A file cannot be written.
        File(FileError),
        /// The model cannot be written.
        Output(OutputError),
    }
}
