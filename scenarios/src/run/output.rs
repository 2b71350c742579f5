//! Files that appear whole or not at all.

use std::io::Write;
use std::path::{Path, PathBuf};

use super::error::RunError;

/// Writes `bytes` to `path` by way of a temporary file beside it.
///
/// # Errors
/// The file cannot be written; what was there before still is.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), RunError> {
    let failed = |source| RunError::File { path: path.to_owned(), source };
    let folder = match path.parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    };
    let mut file = tempfile::NamedTempFile::new_in(folder).map_err(failed)?;
    file.write_all(bytes).map_err(failed)?;
    make_readable(file.as_file()).map_err(failed)?;
    file.persist(path).map(|_| ()).map_err(|e| failed(e.error))
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
pub fn create_folder(path: &Path) -> Result<PathBuf, RunError> {
    std::fs::create_dir_all(path).map_err(|source| RunError::File { path: path.to_owned(), source })?;
    Ok(path.to_owned())
}
