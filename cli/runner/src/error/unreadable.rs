//! A file or folder that was named cannot be read.

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

/// A file or folder that cannot be read.
#[derive(Debug, Error)]
#[error("{}: {source}{}", path.display(), what_to_do(path, source))]
pub struct Unreadable {
    pub path: PathBuf,
    pub source: io::Error,
}

impl Unreadable {
    /// The error of reading `path`, for `map_err`.
    pub fn at(path: &Path) -> impl Fn(io::Error) -> Self + use<'_> {
        move |source| Self { path: path.to_owned(), source }
    }
}

/// A shell leaves a pattern as it is where nothing matches it.
fn what_to_do(path: &Path, source: &io::Error) -> &'static str {
    let is_pattern = path.as_os_str().to_string_lossy().contains(['*', '?']);
    if is_pattern && source.kind() == io::ErrorKind::NotFound {
        ": no file here matches this pattern, put one of yours in its place"
    } else {
        ""
    }
}
