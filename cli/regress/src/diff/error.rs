//! Why two recordings or snapshots cannot be compared.

use onescan_recording::RecordingError;
use onescan_report::OutputError;

use crate::snapshot::StoreError;
use onescan_runner::error::{Usage, sum_of_errors};

sum_of_errors! {
    /// Why two recordings or snapshots cannot be compared.
    pub enum DiffError {
        /// What was typed is wrong.
        #[diagnostic(transparent)]
        Usage(Usage),
        /// A recording cannot be read.
        Recording(RecordingError),
        /// A snapshot cannot be read or written.
        #[diagnostic(transparent)]
        Snapshot(StoreError),
        /// The report cannot be written.
        Output(OutputError),
    }
}
