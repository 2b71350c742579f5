//! Files that appear whole or not at all.

use std::io::{Seek as _, Write as _};
use std::path::{Path, PathBuf};

use onescan_base::notice::NOTICE;
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

/// Writes what the user asked for at `path`, and says so. A link is followed; a pipe or a device takes the bytes and stays what
/// it is.
///
/// # Errors
/// As [`write_whole`].
pub fn write_output(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    write_whole(&followed(path), bytes)?;
    wrote(path);
    Ok(())
}

/// Says that the user's file or folder is there.
pub fn wrote(path: &Path) {
    tracing::info!(target: NOTICE, "wrote {}", path.display());
}

/// Where a link leads; any other path as it is.
pub fn followed(path: &Path) -> PathBuf {
    let is_link = path.symlink_metadata().is_ok_and(|found| found.is_symlink());
    is_link.then(|| path.canonicalize().ok()).flatten().unwrap_or_else(|| path.to_owned())
}

/// True for what is there and is neither a file nor a folder: a pipe, a terminal, a device. It takes bytes and has no place to
/// be moved to.
fn is_stream(path: &Path) -> bool {
    std::fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir())
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
    let refused = |kind, what: &str| Err(FileError { path: path.to_owned(), source: std::io::Error::new(kind, what) });
    if path.is_dir() {
        return refused(std::io::ErrorKind::IsADirectory, "this is a folder, name a file in it");
    }
    if path == Path::new("-") {
        let what = "this does not stand for standard output: name /dev/stdout, or ./- for a file of this name";
        return refused(std::io::ErrorKind::InvalidInput, what);
    }
    // A pipe may have no reader yet, and opening it would wait for one.
    if is_stream(path) {
        return Ok(());
    }
    stage(&followed(path), &[]).map(drop)
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
    if is_stream(path) {
        let mut file = tempfile::NamedTempFile::new().map_err(failed)?;
        file.write_all(bytes).map_err(failed)?;
        return Ok(file);
    }
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
    if is_stream(path) {
        return pour(file, path).map_err(|source| FileError { path: path.to_owned(), source });
    }
    file.persist(path).map(|_| ()).map_err(|error| FileError { path: path.to_owned(), source: error.error })
}

/// Gives a stream what is in a file.
fn pour(mut file: tempfile::NamedTempFile, path: &Path) -> std::io::Result<()> {
    file.rewind()?;
    let mut stream = std::fs::OpenOptions::new().write(true).open(path)?;
    std::io::copy(&mut file, &mut stream)?;
    stream.flush()
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

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn a_link_leads_to_what_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let (real, link) = (folder.path().join("real.svg"), folder.path().join("link.svg"));
        std::fs::write(&real, "old").unwrap();
        std::os::unix::fs::symlink(&real, &link).unwrap();
        check_file(&link).unwrap();
        write_output(&link, b"new").unwrap();
        assert_eq!(std::fs::read_to_string(&real).unwrap(), "new");
        assert!(link.symlink_metadata().unwrap().is_symlink());
        // Within a scenario nothing is written through a link.
        write_whole(&link, b"own").unwrap();
        assert!(!link.symlink_metadata().unwrap().is_symlink() && std::fs::read_to_string(&real).unwrap() == "new");
    }

    #[test]
    fn a_device_stays_a_device() {
        let null = Path::new("/dev/null");
        check_file(null).unwrap();
        write_output(null, b"gone").unwrap();
        assert!(is_stream(null));
        let full = write_output(Path::new("/dev/full"), b"nobody takes this").unwrap_err();
        assert_eq!(full.path, Path::new("/dev/full"));
        assert!(is_stream(Path::new("/dev/full")));
    }

    #[test]
    fn a_dash_is_not_a_file() {
        let error = check_file(Path::new("-")).unwrap_err().to_string();
        assert!(error.contains("/dev/stdout"), "{error}");
    }
}
