//! A client of another process, reached over TCP, as a carrier.

use std::time::Duration;

use super::ReceiveError;
use super::stream::FrameStream;
use crate::carrier::{Answer, Carrier, Grant};
use crate::client::{ClientOperation, ClientView, OperationRefused, Parts, StateError};
use crate::end::{FailureCause, SessionEnd};
use crate::time::{StepCount, VirtualTime};
use crate::wire::{ClientMessage, Frame, FrameError, FrameRef, ServerMessage};

/// A joined client's connection, and what broke it if it is broken.
pub(super) struct Remote {
    connection: FrameStream,
    broken: Option<FailureCause>,
    reply_timeout: Duration,
}

impl Remote {
    /// The client behind `connection`, which leaves no order unanswered for `reply_timeout`.
    pub(super) fn new(connection: FrameStream, reply_timeout: Duration) -> Self {
        Self { connection, broken: None, reply_timeout }
    }

    pub(super) fn send_message(&mut self, message: &ServerMessage) {
        let sent = self.connection.send_message(message);
        self.note(sent);
    }

    /// A connection that breaks while an order is given shows when its answer is collected.
    fn note(&mut self, sent: Result<(), FrameError>) {
        if let Err(error) = sent {
            self.broken.get_or_insert(cause_of(&ReceiveError::Frame(error)));
        }
    }
}

impl Carrier for Remote {
    fn runs_elsewhere(&self) -> bool {
        true
    }

    fn set_up(&mut self, operations: &[ClientOperation], _outputs: &mut Vec<u8>) {
        self.send_message(&ServerMessage::Setup { operations: operations.to_vec() });
    }

    fn grant(&mut self, Grant { sequence, t_v, inputs }: Grant<'_>, _outputs: &mut Vec<u8>) {
        let sent = self.connection.send(FrameRef::Grant { sequence, t_v, inputs });
        self.note(sent);
    }

    fn collect(&mut self, outputs: &mut Vec<u8>) -> Result<Answer, FailureCause> {
        // What a client said before it broke the connection says more than the broken connection.
        let broken = self.broken.take();
        let patience = if broken.is_some() { Duration::from_millis(100) } else { self.reply_timeout };
        match (self.connection.receive(Some(patience)), broken) {
            (Ok(Frame::Turn { sequence, t_v, wake, outputs: bytes }), None) => {
                outputs.clear();
                outputs.extend_from_slice(&bytes);
                Ok(Answer { sequence, t_v, wake })
            }
            (Ok(frame), broken) => Err(broken_promise(&frame, broken)),
            (Err(_), Some(broken)) => Err(broken),
            (Err(error), None) => Err(cause_of(&error)),
        }
    }

    fn operate(&mut self, operation: &ClientOperation) -> Result<(), OperationRefused> {
        let failed = |error: &dyn ToString| OperationRefused::Because(error.to_string());
        self.connection.send_message(&ServerMessage::Operate(operation.clone())).map_err(|e| failed(&e))?;
        match self.connection.receive_message(self.reply_timeout) {
            Ok(ClientMessage::Operated { refused: None }) => Ok(()),
            Ok(ClientMessage::Operated { refused: Some(refused) }) => Err(refused),
            Ok(ClientMessage::Fault(fault)) => Err(failed(&fault)),
            Ok(_) => Err(failed(&"it answered `operate` with another message")),
            Err(error) => Err(failed(&error)),
        }
    }

    /// The protocol carries signals and states only.
    fn can_reset(&self) -> Result<(), OperationRefused> {
        Ok(())
    }

    fn show(&self, _parts: Parts, _view: &mut ClientView) {}

    fn save(&mut self) -> Result<Vec<u8>, StateError> {
        self.connection.send_message(&ServerMessage::Save {}).map_err(|e| lost(&e.into()))?;
        match self.connection.receive(Some(self.reply_timeout)) {
            Ok(Frame::State(state)) => Ok(state.to_vec()),
            Ok(frame) => Err(match broken_promise(&frame, None) {
                FailureCause::Fault(fault) => StateError::Refused(fault),
                cause => StateError::Lost(cause),
            }),
            Err(error) => Err(lost(&error)),
        }
    }

    fn restore(&mut self, steps: StepCount, t_v: VirtualTime, state: &[u8]) -> Result<(), StateError> {
        self.connection.send_message(&ServerMessage::Restore { t_v, steps }).map_err(|e| lost(&e.into()))?;
        self.connection.send(FrameRef::State(state)).map_err(|e| lost(&e.into()))?;
        match self.connection.receive_message(self.reply_timeout) {
            Ok(ClientMessage::Restored {}) => Ok(()),
            Ok(ClientMessage::Fault(fault)) => Err(StateError::Refused(fault)),
            Ok(_) => Err(StateError::Lost(FailureCause::Wire("it answered `restore` with another message".to_owned()))),
            Err(error) => Err(lost(&error)),
        }
    }

    /// A client that is not asked anything says nothing: whatever comes is a fault.
    fn find_lost(&mut self) -> Option<FailureCause> {
        const GLANCE: Duration = Duration::from_millis(1);
        match self.connection.receive(Some(GLANCE)) {
            Err(ReceiveError::TimedOut(_)) => None,
            Err(error) => Some(cause_of(&error)),
            Ok(frame) => Some(broken_promise(&frame, None)),
        }
    }

    fn end(&mut self, end: &SessionEnd) {
        self.send_message(&ServerMessage::End(end.clone()));
    }

    /// A client that is gone, or does not read, is not waited for longer than closing may take.
    fn close(&mut self) {
        self.connection.close();
    }
}

fn lost(error: &ReceiveError) -> StateError {
    StateError::Lost(cause_of(error))
}

fn cause_of(error: &ReceiveError) -> FailureCause {
    match error {
        ReceiveError::TimedOut(after) => FailureCause::TimedOut { after_ms: after.as_millis() as u64 },
        error if error.is_disconnect() => FailureCause::Disconnected,
        error => FailureCause::Wire(error.to_string()),
    }
}

/// The cause when `frame` came and it is not an answer to a grant.
fn broken_promise(frame: &Frame, broken: Option<FailureCause>) -> FailureCause {
    if let Frame::Json(text) = frame {
        return match serde_json::from_slice(text) {
            Ok(ClientMessage::Fault(fault)) => FailureCause::Fault(fault),
            Ok(_) => FailureCause::Wire("it sent a message of the handshake in the middle of the session".to_owned()),
            Err(error) => cause_of(&ReceiveError::from(error)),
        };
    }
    broken.unwrap_or_else(|| match frame {
        Frame::Grant { .. } => FailureCause::Wire("it sent a grant; only the server grants".to_owned()),
        Frame::State(_) => FailureCause::Wire("it sent a state that nobody asked for".to_owned()),
        Frame::Turn { .. } | Frame::Json(_) => FailureCause::Wire("it sent a turn that nobody granted".to_owned()),
    })
}
