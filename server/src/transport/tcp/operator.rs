//! The operator's side of TCP: one wish, one answer.

use std::net::SocketAddr;
use std::time::Duration;

use super::participant::{ParticipantError, connect, greet};
use super::{receive, runtime, send};
use crate::session::Control;
use crate::wire::message::{Role, Status};
use crate::wire::{ClientMessage, ServerMessage};

/// Asks the session at `address` for `control`, or with `None` only how it is, and gives its status
/// at the step boundary at which the wish was taken.
///
/// # Errors
/// Nobody there, no answer within `patience`, or an answer that is none.
pub fn operate(address: SocketAddr, control: Option<Control>, patience: Duration) -> Result<Status, ParticipantError> {
    let no_runtime = |source| ParticipantError::Connect { address, source };
    runtime().map_err(no_runtime)?.block_on(async {
        let mut connection = connect(address).await?;
        greet(&mut connection, Role::Operator).await?;
        let wish = control.map_or(ClientMessage::Status {}, ClientMessage::Control);
        send(&mut connection, &wish).await.map_err(|e| ParticipantError::Handshake(e.into()))?;
        match receive(&mut connection, patience).await.map_err(ParticipantError::Handshake)? {
            ServerMessage::Status(status) => Ok(status),
            ServerMessage::Refused { message } => Err(ParticipantError::Refused(message)),
            _ => Err(ParticipantError::Refused("its answer is no status".to_owned())),
        }
    })
}
