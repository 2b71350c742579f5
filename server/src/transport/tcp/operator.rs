//! The operator's side of TCP: wishes and their answers.

use std::time::Duration;

use super::entrance::{Entrance, connect};
use super::participant::{ParticipantError, greet};
use super::stream::FrameStream;
use crate::mailbox::Wish;
use crate::signal::SignalDecl;
use crate::wire::message::{Role, Status};
use crate::wire::{ClientMessage, ServerMessage};

/// A connection to a session as its operator.
#[expect(missing_debug_implementations, reason = "a socket with its buffers")]
pub struct OperatorConnection {
    connection: FrameStream,
    signals: Vec<SignalDecl>,
}

impl OperatorConnection {
    /// Goes to the session behind `entrance`.
    ///
    /// # Errors
    /// Nobody there, or one who does not let an operator in.
    pub fn open(entrance: impl Into<Entrance>) -> Result<Self, ParticipantError> {
        let entrance = entrance.into();
        let mut connection = connect(&entrance)?;
        let signals = greet(&mut connection, Role::Operator, &entrance)?;
        Ok(Self { connection, signals })
    }

    /// All signals of the session.
    pub fn signals(&self) -> &[SignalDecl] {
        &self.signals
    }

    /// Asks for something, and gives how the session is at the step boundary at which the wish was taken.
    ///
    /// # Errors
    /// The session does not have the signal or refuses the value, no answer comes within `patience`, or it cannot be read.
    pub fn ask(&mut self, wish: Wish, patience: Duration) -> Result<Status, ParticipantError> {
        let wish = match wish {
            Wish::Look(signals) => ClientMessage::Status { signals },
            // What a server of any version knows goes as it always did.
            Wish::Do(operation) => match operation.control() {
                Some(control) => ClientMessage::Control(control),
                None => ClientMessage::Operate(operation),
            },
        };
        self.connection.send_message(&wish).map_err(|e| ParticipantError::Handshake(e.into()))?;
        match self.connection.receive_message(patience).map_err(ParticipantError::Handshake)? {
            ServerMessage::Status(status) => Ok(status),
            ServerMessage::Refused { message } => Err(ParticipantError::Refused(message)),
            _ => Err(ParticipantError::Refused("its answer is not a status".to_owned())),
        }
    }
}

/// Asks the session behind `entrance` for one thing, and gives how it is at the step boundary at which the wish was taken.
///
/// # Errors
/// See [`OperatorConnection`].
pub fn operate(
    entrance: impl Into<Entrance>,
    wish: impl Into<Wish>,
    patience: Duration,
) -> Result<Status, ParticipantError> {
    OperatorConnection::open(entrance)?.ask(wish.into(), patience)
}
