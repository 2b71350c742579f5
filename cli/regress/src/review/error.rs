//! Why nothing was reviewed.

use onescan_report::{FileError, OutputError};

use crate::regress::TestError;
use crate::snapshot::StoreError;
use onescan_runner::error::sum_of_errors;

sum_of_errors! {
    /// Why nothing was reviewed.
    pub enum ReviewError {
        /// A path leads to no scenario.
        #[diagnostic(transparent)]
        Test(TestError),
        /// A snapshot cannot be read or written.
        #[diagnostic(transparent)]
        Snapshot(StoreError),
        /// A file cannot be written.
        File(FileError),
        /// The report cannot be written.
        Output(OutputError),
    }
}
