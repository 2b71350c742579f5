//! Files and folders that a command is to write, looked at before it begins: nobody waits an hour to learn of a typing error.

use std::path::PathBuf;

use onescan_report::FileError;
use onescan_report::file;

/// Refuses files that cannot be written.
///
/// # Errors
/// The first of them that cannot.
pub(super) fn files<const N: usize>(paths: [&Option<PathBuf>; N]) -> Result<(), FileError> {
    paths.into_iter().flatten().try_for_each(|path| file::check_file(path))
}

/// Refuses folders that cannot be written.
///
/// # Errors
/// The first of them that cannot.
pub(super) fn folders<const N: usize>(paths: [&Option<PathBuf>; N]) -> Result<(), FileError> {
    paths.into_iter().flatten().try_for_each(|path| file::check_folder(path))
}
