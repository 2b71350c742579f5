//! What a session leaves behind.
//!
//! | module | subject |
//! |---|---|
//! | [`digest`] | a hash chained over the image of every step |
//! | [`csv`] | trajectories as CSV, complete up to the last step whatever happens |

pub mod csv;
pub mod digest;

use thiserror::Error;

pub use digest::{Digest, DigestChain};

use crate::session::Session;

/// Watches a session at its step boundaries. It sees committed images and can change nothing.
pub trait Observer {
    /// A session starts, or starts anew after a reset: what was seen before does not count.
    /// The image holds the initial values.
    ///
    /// # Errors
    /// What was to be written could not be.
    fn begin(&mut self, session: &Session) -> Result<(), RecordError>;

    /// A step is committed.
    ///
    /// # Errors
    /// What was to be written could not be.
    fn step(&mut self, session: &Session) -> Result<(), RecordError>;

    /// The session is over; called exactly once, also after a failure.
    ///
    /// # Errors
    /// What was to be written could not be.
    fn end(&mut self, session: &Session) -> Result<(), RecordError>;
}

/// A recording that cannot be written.
#[derive(Debug, Error)]
#[error("cannot write {path}: {source}")]
pub struct RecordError {
    /// The file.
    pub path: String,
    /// Why.
    pub source: std::io::Error,
}
