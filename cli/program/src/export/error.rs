//! Why nothing was exported.

use onescan_recording::RecordingError;
use onescan_report::FileError;

use onescan_runner::error::{Usage, sum_of_errors};

sum_of_errors! {
    /// Why nothing was exported.
    pub enum ExportError {
        /// What was typed is wrong.
        #[diagnostic(transparent)]
        Usage(Usage),
        /// A recording cannot be read.
        Recording(RecordingError),
        /// A file cannot be written.
        File(FileError),
    }
}
