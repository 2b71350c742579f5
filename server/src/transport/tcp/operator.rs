//! The operator's side of TCP: one wish, one answer.

use std::time::Duration;

use super::entrance::{Entrance, connect};
use super::participant::{ParticipantError, greet};
use crate::operation::Operation;
use crate::wire::message::{Role, Status};
use crate::wire::{ClientMessage, ServerMessage};

/// Asks the session behind `entrance` for `operation`, or with `None` only how it is, and gives its status
/// at the step boundary at which the wish was taken.
///
/// # Errors
/// Nobody there, a signal or value that the session has not, no answer within `patience`, or an answer that is none.
pub fn operate(
    entrance: impl Into<Entrance>,
    operation: Option<Operation>,
    patience: Duration,
) -> Result<Status, ParticipantError> {
    let entrance = entrance.into();
    let mut connection = connect(&entrance)?;
    greet(&mut connection, Role::Operator, &entrance)?;
    let wish = match operation {
        None => ClientMessage::Status {},
        // What a server of any version knows goes as it always did.
        Some(operation) => match operation.control() {
            Some(control) => ClientMessage::Control(control),
            None => ClientMessage::Operate(operation),
        },
    };
    connection.send_message(&wish).map_err(|e| ParticipantError::Handshake(e.into()))?;
    match connection.receive_message(patience).map_err(ParticipantError::Handshake)? {
        ServerMessage::Status(status) => Ok(status),
        ServerMessage::Refused { message } => Err(ParticipantError::Refused(message)),
        _ => Err(ParticipantError::Refused("its answer is no status".to_owned())),
    }
}
