//! The folder for certificates.

use std::path::{Path, PathBuf};

use tempfile::TempDir;

/// A folder that is kept, or one for this connection only.
#[derive(Debug)]
pub enum Pki {
    /// The user's.
    Kept(PathBuf),
    /// Gone when it is no more needed.
    Passing(TempDir),
}

impl Pki {
    /// The folder `kept`, or a passing one.
    ///
    /// # Errors
    /// There is no room for a passing one.
    pub fn new(kept: Option<&Path>) -> std::io::Result<Self> {
        match kept {
            Some(path) => Ok(Self::Kept(path.to_owned())),
            None => TempDir::with_prefix("onescan-pki-").map(Self::Passing),
        }
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        match self {
            Self::Kept(path) => path,
            Self::Passing(folder) => folder.path(),
        }
    }
}
