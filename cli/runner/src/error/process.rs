//! Another program cannot be started.

use std::io;

use thiserror::Error;

/// A process that cannot be started.
#[derive(Debug, Error)]
#[error("cannot start `{command}` for client `{client}`: {source}")]
pub struct SpawnError {
    pub client: String,
    pub command: String,
    pub source: io::Error,
}
