//! A file or folder that was named cannot be read.

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

/// A file or folder that cannot be read.
#[derive(Debug, Error)]
#[error("{}: {source}", path.display())]
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
