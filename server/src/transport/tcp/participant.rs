//! The client's side of TCP: joins a session and takes part until it ends.

pub use super::error::ParticipantError;

use super::entrance::{Entrance, connect};
use super::stream::FrameStream;
use super::{AGENT, HANDSHAKE_TIMEOUT, ReceiveError};
use crate::client::{Client, ClientFault, Wake};
use crate::end::SessionEnd;
use crate::signal::{PortLayout, SignalDecl};
use crate::time::{StepCount, VirtualTime};
use crate::wire::message::Role;
use crate::wire::{ClientMessage, Duty, Endpoint, Frame, FrameError, FrameRef, ServerMessage, VERSIONS};

/// Joins the session behind `entrance` as `client` and takes part until it ends.
///
/// # Errors
/// See [`ParticipantError`].
pub fn take_part(client: &mut dyn Client, entrance: impl Into<Entrance>) -> Result<SessionEnd, ParticipantError> {
    let entrance = entrance.into();
    let mut connection = connect(&entrance)?;
    shake_hands(&mut connection, client, &entrance)?;
    serve(connection, client)
}

/// `hello` and its answer.
pub(super) fn greet(
    connection: &mut FrameStream,
    role: Role,
    entrance: &Entrance,
) -> Result<Vec<SignalDecl>, ParticipantError> {
    let broken = |e: FrameError| ParticipantError::Handshake(e.into());
    let token = entrance.token.as_ref().map(|token| token.reveal().to_owned());
    let hello = ClientMessage::Hello { protocol: VERSIONS, role, agent: AGENT.to_owned(), token };
    connection.send_message(&hello).map_err(broken)?;
    match connection.receive_message(HANDSHAKE_TIMEOUT).map_err(ParticipantError::Handshake)? {
        ServerMessage::Welcome { signals, .. } => Ok(signals),
        ServerMessage::Refused { message } => Err(ParticipantError::Refused(message)),
        _ => Err(ParticipantError::Refused("its answer to `hello` is none".to_owned())),
    }
}

/// `hello` and `join`. The answer to `join` may take as long as the session takes to form.
fn shake_hands(connection: &mut FrameStream, client: &dyn Client, entrance: &Entrance) -> Result<(), ParticipantError> {
    greet(connection, Role::Client, entrance)?;
    let broken = |e: FrameError| ParticipantError::Handshake(e.into());
    connection.send_message(&ClientMessage::Join(client.join())).map_err(broken)?;
    let Frame::Json(text) = connection.receive(None).map_err(ParticipantError::Handshake)? else {
        return Err(ParticipantError::Handshake(ReceiveError::NotJson));
    };
    match serde_json::from_slice(&text).map_err(|e| ParticipantError::Handshake(e.into()))? {
        ServerMessage::Joined { .. } => Ok(()),
        ServerMessage::Refused { message } => Err(ParticipantError::Refused(message)),
        _ => Err(ParticipantError::Refused("its answer to `join` is none".to_owned())),
    }
}

fn serve(mut connection: FrameStream, client: &mut dyn Client) -> Result<SessionEnd, ParticipantError> {
    let request = client.join();
    let mut endpoint = Endpoint::new(PortLayout::new(request.reads).size());
    let mut outputs = vec![0; PortLayout::new(request.writes).size()];
    loop {
        let frame =
            connection.receive(None).map_err(|source| ParticipantError::Lost { t_v: endpoint.t_v(), source })?;
        let duty = endpoint.receive(frame)?;
        let t_v = endpoint.t_v();
        if let Duty::Leave(end) = duty {
            return Ok(end);
        }
        match do_duty(&mut connection, client, duty, t_v, &mut outputs) {
            Ok(Ok(())) => endpoint.answered(),
            Ok(Err(fault)) => {
                // If the server is gone too, the fault is still what matters here.
                let _ = connection.send_message(&ClientMessage::Fault(fault.clone()));
                connection.close();
                return Err(ParticipantError::Fault { t_v, fault });
            }
            Err(error) => return Err(ParticipantError::Lost { t_v, source: error.into() }),
        }
    }
}

/// Does what the server asks for and answers. The inner error is the client's own.
fn do_duty(
    connection: &mut FrameStream,
    client: &mut dyn Client,
    duty: Duty,
    t_v: VirtualTime,
    outputs: &mut [u8],
) -> Result<Result<(), ClientFault>, FrameError> {
    let done = match duty {
        Duty::Leave(_) | Duty::Nothing => Ok(()),
        Duty::Setup(operations) => {
            outputs.fill(0);
            match client.begin(&operations, outputs) {
                Ok(()) => {
                    let (sequence, wake) = (StepCount(0), Wake::NextPeriod);
                    connection.send(FrameRef::Turn { sequence, t_v, wake, outputs })?;
                    Ok(())
                }
                Err(fault) => Err(fault),
            }
        }
        Duty::Turn { sequence, t_v, inputs } => match client.turn(t_v, &inputs, outputs) {
            Ok(wake) => {
                connection.send(FrameRef::Turn { sequence, t_v, wake, outputs })?;
                Ok(())
            }
            Err(fault) => Err(fault),
        },
        Duty::Operate(operation) => {
            let refused = client.operate(&operation).err();
            connection.send_message(&ClientMessage::Operated { refused })?;
            Ok(())
        }
        Duty::Save => {
            match client.save() {
                Ok(state) => connection.send(FrameRef::State(&state))?,
                // The session goes on; it is just not saved.
                Err(error) => connection.send_message(&ClientMessage::Fault(ClientFault::new(error.to_string())))?,
            }
            Ok(())
        }
        Duty::Restore(state) => match client.restore(&state) {
            Ok(()) => {
                connection.send_message(&ClientMessage::Restored {})?;
                Ok(())
            }
            Err(error) => Err(ClientFault::new(error.to_string())),
        },
    };
    Ok(done)
}
