//! What watches a session without a trace: it sees committed images and can change nothing.

use thiserror::Error;

use crate::digest::TrajectoryDigest;
use crate::operation::OperatorInput;
use crate::session::Session;

/// Watches a session at its step boundaries, on the session's thread.
///
/// The digest is given as it grows: an observer that needs its value asks for it.
pub trait Observer {
    /// A session starts, restarts after a reset or goes on from a checkpoint: what was seen before
    /// does not count. The image holds the initial values, or those of the checkpoint.
    ///
    /// # Errors
    /// What was to be written could not be.
    fn begin(&mut self, session: &Session, digest: &TrajectoryDigest) -> Result<(), RecordError>;

    /// A step is committed.
    ///
    /// # Errors
    /// What was to be written could not be.
    fn step(&mut self, session: &Session, digest: &TrajectoryDigest) -> Result<(), RecordError>;

    /// Whether it wants to see every step, also those in which nobody is due and no value changes. If all observers are
    /// content without, they see the last of a run of such steps only.
    fn wants_idle_steps(&self) -> bool {
        true
    }

    /// An operation has been taken, at a step boundary.
    ///
    /// # Errors
    /// What was to be written could not be.
    fn operated(&mut self, _input: &OperatorInput) -> Result<(), RecordError> {
        Ok(())
    }

    /// A checkpoint is taken, at a step boundary: a session that forks from it goes on from what has been seen here.
    fn saved(&mut self, _session: &Session) {}

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
    pub path: String,
    pub source: std::io::Error,
}
