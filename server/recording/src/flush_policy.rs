//! When steps reach the disk before their part is full. It is all that a clock decides here: what a recording is in the end
//! does not depend on it.

use std::sync::mpsc::{Receiver, RecvError, RecvTimeoutError};
use std::time::{Duration, Instant};

/// How long a kill may cost of a slow run.
const PERIOD: Duration = Duration::from_secs(1);

/// When steps that have come are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FlushPolicy {
    #[default]
    WallClock,
    /// After so many steps each, and before the session goes on: for those who want to know what is there.
    Steps(u64),
}

/// A flush policy as it goes on the encoder's thread.
pub(super) struct FlushTimer {
    /// The last time that all was written; nothing where no clock counts.
    last: Option<Instant>,
}

impl FlushTimer {
    pub(super) fn new(flush_policy: FlushPolicy) -> Self {
        Self { last: (flush_policy == FlushPolicy::WallClock).then(Instant::now) }
    }

    /// The next message; nothing if it is time before one has come.
    pub(super) fn next<T>(&self, messages: &Receiver<T>) -> Result<Option<T>, RecvError> {
        let Some(last) = self.last else { return messages.recv().map(Some) };
        match messages.recv_timeout(PERIOD.saturating_sub(last.elapsed())) {
            Ok(message) => Ok(Some(message)),
            Err(RecvTimeoutError::Timeout) => Ok(None),
            Err(RecvTimeoutError::Disconnected) => Err(RecvError),
        }
    }

    pub(super) fn is_due(&self) -> bool {
        self.last.is_some_and(|last| last.elapsed() >= PERIOD)
    }

    /// All that has come is written.
    pub(super) fn written(&mut self) {
        self.last = self.last.map(|_| Instant::now());
    }
}
