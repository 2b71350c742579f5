//! The lock of a recording: two runs that record into one folder would mix their files, or lose one of them.

use std::fs::{File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

use onescan_report::FileError;

use super::error::RunError;
use crate::error::Usage;

/// A file that is there while somebody records. What is left of a run that was killed is locked by nobody.
const NAME: &str = ".recording.lock";

/// As long as this is kept, nobody else records into the folder.
#[derive(Debug)]
pub(super) struct RecordLock {
    path: PathBuf,
    /// The lock is the file's, and ends with it.
    _file: File,
}

impl RecordLock {
    /// Locks a folder, which is there.
    ///
    /// # Errors
    /// Somebody else records into it, or the file of the lock cannot be made.
    pub(super) fn of(folder: &Path) -> Result<Self, RunError> {
        let path = folder.join(NAME);
        loop {
            let failed = |source| FileError { path: path.clone(), source };
            let file = File::options().write(true).create(true).truncate(false).open(&path).map_err(failed)?;
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => {
                    let help = "wait until it has ended, or record into another folder".to_owned();
                    return Err(Usage::new(format!("another run records into {}", folder.display()), Some(help)).into());
                }
                Err(TryLockError::Error(source)) => return Err(failed(source).into()),
            }
            // Whoever had it before may have removed it since it was opened.
            if is_still_there(&file, &path).map_err(failed)? {
                return Ok(Self { path, _file: file });
            }
        }
    }
}

/// Whether somebody records into a folder just now.
pub(super) fn is_held(folder: &Path) -> bool {
    let file = File::options().read(true).write(true).open(folder.join(NAME));
    // It ends with the file, at once.
    file.is_ok_and(|file| matches!(file.try_lock(), Err(TryLockError::WouldBlock)))
}

impl Drop for RecordLock {
    fn drop(&mut self) {
        // One that is left over locks nobody out.
        std::fs::remove_file(&self.path).ok();
    }
}

/// Whether `path` is the file that is open.
#[cfg(unix)]
fn is_still_there(file: &File, path: &Path) -> io::Result<bool> {
    use std::os::unix::fs::MetadataExt as _;

    let own = file.metadata()?;
    match std::fs::metadata(path) {
        Ok(found) => Ok((found.dev(), found.ino()) == (own.dev(), own.ino())),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(false),
        Err(error) => Err(error),
    }
}

/// What is open cannot be removed there.
#[cfg(not(unix))]
#[expect(clippy::unnecessary_wraps, reason = "elsewhere it is looked up")]
fn is_still_there(_file: &File, _path: &Path) -> io::Result<bool> {
    Ok(true)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_records_at_a_time_and_leaves_no_lock() {
        let folder = tempfile::tempdir().unwrap();
        let first = RecordLock::of(folder.path()).unwrap();
        assert!(is_held(folder.path()));
        let refused = RecordLock::of(folder.path()).unwrap_err();
        assert!(refused.to_string().contains("another run records into"), "{refused}");
        drop(first);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
        // The file that a killed run has left locks nobody out.
        std::fs::write(folder.path().join(NAME), "").unwrap();
        assert!(!is_held(folder.path()));
        drop(RecordLock::of(folder.path()).unwrap());
    }
}
