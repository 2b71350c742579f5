//! Files that are written, behind a trait: what must not be lost when a disk is full, refuses, or the process is killed between
//! two calls is tried at each of them (`tests/simulation`). Files that are read are the room of [`regular`](crate::regular).

use std::fmt::Debug;
use std::fs::{File, OpenOptions};
use std::io::{Read, Result, Seek, Write};
use std::path::{Path, PathBuf};

/// A file that is written.
pub trait DiskFile: Read + Write + Seek + Send + Debug {}

impl<F: Read + Write + Seek + Send + Debug> DiskFile for F {}

/// What changes folders and files. Each method is one step between two of which a process may end.
pub trait Disk: Debug + Send + Sync {
    /// Makes a folder, with those above it that are not there; one that is there stays.
    ///
    /// # Errors
    /// As [`std::fs::create_dir_all`].
    fn create_folder(&self, path: &Path) -> Result<()>;

    /// Opens an empty file, in the place of one that is there.
    ///
    /// # Errors
    /// As [`File::create`].
    fn create(&self, path: &Path) -> Result<Box<dyn DiskFile>>;

    /// Opens a file, made if it is not there: what is written goes to its end, wherever others have brought that.
    ///
    /// # Errors
    /// As [`OpenOptions::open`].
    fn append(&self, path: &Path) -> Result<Box<dyn DiskFile>>;

    /// Moves a file or folder, in the place of a file that is there.
    ///
    /// # Errors
    /// As [`std::fs::rename`].
    fn rename(&self, from: &Path, to: &Path) -> Result<()>;

    /// Removes a file, or a link.
    ///
    /// # Errors
    /// As [`std::fs::remove_file`].
    fn remove_file(&self, path: &Path) -> Result<()>;

    /// Removes a folder and what is in it.
    ///
    /// # Errors
    /// As [`std::fs::remove_dir_all`]: some of it may be left.
    fn remove_folder(&self, path: &Path) -> Result<()>;
}

/// The system's files.
#[derive(Clone, Copy, Debug, Default)]
pub struct SystemDisk;

impl Disk for SystemDisk {
    fn create_folder(&self, path: &Path) -> Result<()> {
        std::fs::create_dir_all(path)
    }

    fn create(&self, path: &Path) -> Result<Box<dyn DiskFile>> {
        Ok(Box::new(File::options().read(true).write(true).create(true).truncate(true).open(path)?))
    }

    fn append(&self, path: &Path) -> Result<Box<dyn DiskFile>> {
        Ok(Box::new(OpenOptions::new().read(true).append(true).create(true).open(path)?))
    }

    fn rename(&self, from: &Path, to: &Path) -> Result<()> {
        std::fs::rename(from, to)
    }

    fn remove_file(&self, path: &Path) -> Result<()> {
        std::fs::remove_file(path)
    }

    fn remove_folder(&self, path: &Path) -> Result<()> {
        std::fs::remove_dir_all(path)
    }
}

/// Where a file grows that is to stand at `path`: beside it, under a name that begins with a dot.
#[must_use]
pub fn growing(path: &Path) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!(".{name}.partial"))
}

/// Writes a file that appears whole or not at all.
///
/// # Errors
/// It cannot be written; what was at `path` before still is.
pub fn write_whole(disk: &dyn Disk, path: &Path, bytes: &[u8]) -> Result<()> {
    let growing = growing(path);
    let mut file = disk.create(&growing)?;
    file.write_all(bytes)?;
    file.flush()?;
    drop(file);
    disk.rename(&growing, path)
}
