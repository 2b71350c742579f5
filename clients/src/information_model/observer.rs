//! The session's steps on the board.

use std::sync::Arc;

use onescan_server::operation::{Operation, OperatorInput};
use onescan_server::record::{Digest, Observer, RecordError};
use onescan_server::session::Session;
use onescan_server::state::ServerState;

use super::board::Board;

/// Writes each committed step on a board.
pub struct BoardObserver {
    board: Arc<Board>,
    digest: Option<Digest>,
}

impl BoardObserver {
    /// An observer for `board`.
    pub fn new(board: Arc<Board>) -> Self {
        Self { board, digest: None }
    }

    fn show(&self, session: &Session, state: ServerState) {
        let digest = self.digest;
        self.board.show(|view| {
            view.state = state;
            view.t_v = session.t_v();
            view.steps = session.cycle().steps();
            view.is_held = session.is_held();
            view.digest = digest;
            view.image.copy_from_slice(session.image());
        });
    }
}

impl Observer for BoardObserver {
    fn digested(&mut self, digest: Digest) {
        self.digest = Some(digest);
    }

    fn begin(&mut self, session: &Session) -> Result<(), RecordError> {
        self.show(session, ServerState::PreRead);
        Ok(())
    }

    fn step(&mut self, session: &Session) -> Result<(), RecordError> {
        self.show(session, ServerState::Write);
        Ok(())
    }

    fn operated(&mut self, input: &OperatorInput) -> Result<(), RecordError> {
        match input.operation {
            Operation::Pause => self.board.show(|view| view.is_held = true),
            Operation::Resume => self.board.show(|view| view.is_held = false),
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
