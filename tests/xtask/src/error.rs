//! What can go wrong with a task.

use std::io;
use std::path::{Path, PathBuf};

/// Why a task did not come to its end.
#[derive(Debug, thiserror::Error)]
pub(crate) enum TaskError {
    /// A file or folder of the repository.
    #[error("{}: {source}", path.display())]
    Unreadable {
        path: PathBuf,
        #[source]
        source: io::Error,
    },
    /// A file of the repository has something else in it than it should.
    #[error("{}: {message}", path.display())]
    Wrong { path: PathBuf, message: String },
    #[error("there is no task `{0}`; `cargo xtask` lists them")]
    Unknown(String),
    /// A task that this system cannot run.
    #[error("`{name}` does not run on Windows: {reason}")]
    Windows { name: &'static str, reason: &'static str },
    #[error("`{program}` does not start: {source}")]
    NotStarted {
        program: String,
        #[source]
        source: io::Error,
    },
    #[error("`{0}` failed")]
    Failed(String),
    #[error("this is not ready for a release: {0}")]
    NotReady(String),
    #[error("the output cannot be written: {0}")]
    Output(#[from] io::Error),
}

impl TaskError {
    pub(crate) fn wrong(path: &Path, message: impl Into<String>) -> Self {
        Self::Wrong { path: path.to_owned(), message: message.into() }
    }

    /// As the program's: 1 for a negative result, 2 for wrong input, 3 for what could not be run or written.
    pub(crate) fn exit_code(&self) -> u8 {
        match self {
            Self::NotReady(_) | Self::Failed(_) => 1,
            Self::Unreadable { .. } | Self::Wrong { .. } | Self::Unknown(_) | Self::Windows { .. } => 2,
            Self::NotStarted { .. } | Self::Output(_) => 3,
        }
    }
}
