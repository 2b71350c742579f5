//! The system has no thread to give.

use std::io;

use thiserror::Error;

/// A thread that was refused, as containers and users may have so many of them and no more.
#[derive(Debug, Error)]
#[error(transparent)]
pub struct ThreadError(pub io::Error);
