//! Why a snapshot cannot be read or written.

use onescan_report::FileError;

use onescan_runner::error::{Unreadable, Usage, sum_of_errors};

sum_of_errors! {
    /// Why a snapshot cannot be read or written.
    pub enum StoreError {
        /// What was typed is wrong.
        #[diagnostic(transparent)]
        Usage(Usage),
        /// A file cannot be read.
        Unreadable(Unreadable),
        /// A file cannot be written.
        File(FileError),
    }
}
