//! Files that appear whole or not at all.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use thiserror::Error;

/// A file that cannot be written.
#[derive(Debug, Error)]
#[error("{}: {source}", path.display())]
pub struct FileError {
    pub path: PathBuf,
    pub source: std::io::Error,
}

/// Writes `bytes` to `path` by way of a temporary file beside it.
///
/// # Errors
/// The file cannot be written; what was there before still is.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    persist(stage(path, bytes)?, path)
}

/// An empty file beside `path`, which [`end_whole`] gives its place.
///
/// # Errors
/// It cannot be made.
pub fn begin_whole(path: &Path) -> Result<tempfile::NamedTempFile, FileError> {
    stage(path, &[])
}

/// Gives a file that was begun beside `path` its place.
///
/// # Errors
/// It cannot be moved there.
pub fn end_whole(file: tempfile::NamedTempFile, path: &Path) -> Result<(), FileError> {
    persist(file, path)
}

/// A file that is to be written, or deleted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Write {
    /// The file; its folder is made if it is not there.
    pub path: PathBuf,
    /// What it is to hold; nothing for a file that is to be deleted.
    pub bytes: Option<Vec<u8>>,
}

/// Writes files together: all are beside their places before the first takes its own.
///
/// # Errors
/// A file cannot be written. Before any has changed, in all cases but a failing rename.
pub fn write_all_whole(files: &[Write]) -> Result<(), FileError> {
    let mut staged = Vec::new();
    for Write { path, bytes } in files {
        if let Some(bytes) = bytes {
            if let Some(folder) = path.parent() {
                create_folder(folder)?;
            }
            staged.push((stage(path, bytes)?, path));
        }
    }
    for (file, path) in staged {
        persist(file, path)?;
    }
    for Write { path, .. } in files.iter().filter(|file| file.bytes.is_none()) {
        std::fs::remove_file(path).map_err(|source| FileError { path: path.clone(), source })?;
    }
    Ok(())
}

/// Whether `path` can be written, found out before work is done for what it is to hold. Nothing is left of the attempt.
///
/// # Errors
/// It is a folder, or its folder does not take files.
pub fn check_file(path: &Path) -> Result<(), FileError> {
    if path.is_dir() {
        let source = std::io::Error::new(std::io::ErrorKind::IsADirectory, "this is a folder, name a file in it");
        return Err(FileError { path: path.to_owned(), source });
    }
    stage(path, &[]).map(drop)
}

/// Whether files can be written into the folder `path`, which is made when they are: the next folder above it that is there
/// must take them.
///
/// # Errors
/// There is a file of that name, or that folder does not take files.
pub fn check_folder(path: &Path) -> Result<(), FileError> {
    let there = path.ancestors().find(|above| above.exists()).unwrap_or(Path::new("."));
    stage(&there.join("file"), &[]).map(drop).map_err(|error| FileError { path: path.to_owned(), ..error })
}

fn stage(path: &Path, bytes: &[u8]) -> Result<tempfile::NamedTempFile, FileError> {
    let failed = |source| FileError { path: path.to_owned(), source };
    let folder = match path.parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    };
    if !folder.is_dir() {
        // As tempfile says it, there is the name of a temporary file in it.
        let (kind, what) = if folder.exists() {
            (std::io::ErrorKind::NotADirectory, "is not a folder")
        } else {
            (std::io::ErrorKind::NotFound, "is not there, make this folder first")
        };
        return Err(failed(std::io::Error::new(kind, format!("`{}` {what}", folder.display()))));
    }
    let mut file = tempfile::NamedTempFile::new_in(folder).map_err(failed)?;
    file.write_all(bytes).map_err(failed)?;
    make_readable(file.as_file()).map_err(failed)?;
    Ok(file)
}

fn persist(file: tempfile::NamedTempFile, path: &Path) -> Result<(), FileError> {
    file.persist(path).map(|_| ()).map_err(|error| FileError { path: path.to_owned(), source: error.error })
}

/// A temporary file is its owner's alone; a result is for everybody.
#[cfg(unix)]
fn make_readable(file: &std::fs::File) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    file.set_permissions(std::fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn make_readable(_file: &std::fs::File) -> std::io::Result<()> {
    Ok(())
}

/// The folder `path`, made if it is not there.
///
/// # Errors
/// It cannot be made.
pub fn create_folder(path: &Path) -> Result<PathBuf, FileError> {
    std::fs::create_dir_all(path).map_err(|source| FileError { path: path.to_owned(), source })?;
    Ok(path.to_owned())
}
