//! Standard output, and why nothing more goes there.

use std::io;

use thiserror::Error;

/// A report that cannot be written to where the user reads it.
#[derive(Debug, Error)]
#[error("cannot write the report: {0}")]
pub struct OutputError(#[source] pub io::Error);

impl OutputError {
    /// True if the reader has left: `onescan explain --list | head -2`. What he wanted to read he has read.
    pub fn is_closed_pipe(&self) -> bool {
        self.0.kind() == io::ErrorKind::BrokenPipe
    }
}
