//! What a session leaves behind.
//!
//! | module | subject |
//! |---|---|
//! | [`digest`] | a hash chained over the image of every step |
//! | [`recorder`] | the folder of a recording, and the observer that fills it |
//! | [`header`] | what was run |
//! | [`event`] | what happened beside the steps |
//! | `column`, `block` | the signals recorded; runs of steps |
//! | `sink` | the thread that encodes |
//! | [`parquet`], [`csv`], [`mcap`] | the forms of a trajectory |
//!
//! What is read back is in [`crate::recording`].

pub(crate) mod block;
pub(crate) mod column;
pub mod csv;
pub mod digest;
pub mod event;
pub mod header;
pub mod mcap;
pub mod parquet;
pub mod recorder;
pub(crate) mod sink;

use thiserror::Error;

pub use column::Column;
pub use digest::{Digest, DigestChain};
pub use event::{Event, EventKind};
pub use header::{Header, Provenance, SourceFile};
pub use recorder::{Choice, Recorder};

use crate::operation::OperatorInput;
use crate::session::Session;

/// Watches a session at its step boundaries. It sees committed images and can change nothing.
pub trait Observer {
    /// The digest up to the step that [`begin`](Self::begin) or [`step`](Self::step) tells of next.
    fn digested(&mut self, _digest: Digest) {}

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

    /// An operator does something, at a step boundary.
    ///
    /// # Errors
    /// What was to be written could not be.
    fn operated(&mut self, _input: &OperatorInput) -> Result<(), RecordError> {
        Ok(())
    }

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
