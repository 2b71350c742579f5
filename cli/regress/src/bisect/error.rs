//! Why no commit was found.

use onescan_report::{FileError, OutputError};

use crate::diff::DiffError;
use crate::repository::RepositoryError;
use onescan_runner::error::{Usage, sum_of_errors};

sum_of_errors! {
    /// Why no commit was found.
    pub enum BisectError {
        /// What was typed is wrong.
        #[diagnostic(transparent)]
        Usage(Usage),
        /// The repository does not answer.
        #[diagnostic(transparent)]
        Repository(RepositoryError),
        /// Two recordings cannot be compared.
        #[diagnostic(transparent)]
        Diff(DiffError),
        /// A file cannot be written.
        File(FileError),
        /// The report cannot be written.
        Output(OutputError),
    }
}
