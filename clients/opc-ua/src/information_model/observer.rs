//! Notifies OPC UA subscribers of the session's steps.

use std::sync::Arc;

use onescan_server::digest::TrajectoryDigest;
use onescan_server::observer::{Observer, RecordError};
use onescan_server::operation::{Operation, OperatorInput};
use onescan_server::session::Session;

use super::board::Board;

/// Says on a board that a step is committed. Its view has been published before: see
/// [`Published`](onescan_server::published::Published).
pub struct BoardObserver {
    board: Arc<Board>,
}

impl BoardObserver {
    /// An observer for `board`.
    pub fn new(board: Arc<Board>) -> Self {
        Self { board }
    }
}

impl Observer for BoardObserver {
    fn begin(&mut self, _session: &Session, _digest: &TrajectoryDigest) -> Result<(), RecordError> {
        self.board.step();
        Ok(())
    }

    fn step(&mut self, _session: &Session, _digest: &TrajectoryDigest) -> Result<(), RecordError> {
        self.board.step();
        Ok(())
    }

    fn operated(&mut self, input: &OperatorInput) -> Result<(), RecordError> {
        match input.operation {
            Operation::Pause => self.board.hold(true),
            Operation::Resume => self.board.hold(false),
            // What else is done shows in the next view.
            _ => {}
        }
        Ok(())
    }

    fn end(&mut self, session: &Session) -> Result<(), RecordError> {
        let text = session.end().map_or_else(|| "stopped".to_owned(), ToString::to_string);
        self.board.end(&text);
        Ok(())
    }
}
