//! The client's side of TCP: joins a session and takes part until it ends.

use std::net::SocketAddr;

use futures_util::{SinkExt, StreamExt};
use thiserror::Error;
use tokio::net::TcpStream;
use tokio_util::codec::Framed;

use super::{AGENT, Connection, HANDSHAKE_TIMEOUT, ReceiveError, farewell, receive, runtime, send};
use crate::client::{Client, ClientFault, Wake};
use crate::end::SessionEnd;
use crate::signal::PortLayout;
use crate::time::{StepCount, VirtualTime};
use crate::wire::message::Role;
use crate::wire::{
    ClientMessage, Duty, Endpoint, EndpointError, FRAME_BYTES_MAX, FrameCodec, FrameError, FrameRef, ServerMessage,
    VERSIONS,
};

/// Why a client did not stay to the end.
#[derive(Debug, Error)]
pub enum ParticipantError {
    /// Nobody there.
    #[error("cannot connect to the server at {address}: {source}")]
    Connect {
        /// Where.
        address: SocketAddr,
        /// Why.
        source: std::io::Error,
    },
    /// The server does not want it.
    #[error("the server refused: {0}")]
    Refused(String),
    /// The server is gone or silent in the handshake.
    #[error("in the handshake: {0}")]
    Handshake(ReceiveError),
    /// The connection broke in the session.
    #[error("lost the server at t_v = {t_v}: {source}")]
    Lost {
        /// Virtual time of the last grant.
        t_v: VirtualTime,
        /// Why.
        source: ReceiveError,
    },
    /// The server broke the protocol.
    #[error(transparent)]
    Server(#[from] EndpointError),
    /// The client itself could not go on; the server has been told.
    #[error("at t_v = {t_v}: {fault}")]
    Fault {
        /// Virtual time of the turn.
        t_v: VirtualTime,
        /// What happened.
        fault: ClientFault,
    },
}

/// Joins the session at `address` as `client` and takes part until it ends.
///
/// # Errors
/// See [`ParticipantError`].
pub fn take_part(client: &mut dyn Client, address: SocketAddr) -> Result<SessionEnd, ParticipantError> {
    let no_runtime = |source| ParticipantError::Connect { address, source };
    runtime().map_err(no_runtime)?.block_on(async {
        let mut connection = connect(address).await?;
        shake_hands(&mut connection, client).await?;
        connection.codec_mut().set_limit(FRAME_BYTES_MAX);
        serve(connection, client).await
    })
}

/// A connection without delays for small frames.
pub(super) async fn connect(address: SocketAddr) -> Result<Connection, ParticipantError> {
    let refused = |source| ParticipantError::Connect { address, source };
    let connecting = tokio::time::timeout(HANDSHAKE_TIMEOUT, TcpStream::connect(address));
    let stream = match connecting.await {
        Ok(stream) => stream.map_err(refused)?,
        Err(_) => return Err(refused(std::io::ErrorKind::TimedOut.into())),
    };
    stream.set_nodelay(true).map_err(refused)?;
    Ok(Framed::new(stream, FrameCodec::new(FRAME_BYTES_MAX)))
}

/// `hello` and its answer.
pub(super) async fn greet(connection: &mut Connection, role: Role) -> Result<(), ParticipantError> {
    let broken = |e: FrameError| ParticipantError::Handshake(e.into());
    let hello = ClientMessage::Hello { protocol: VERSIONS, role, agent: AGENT.to_owned() };
    send(connection, &hello).await.map_err(broken)?;
    match receive(connection, HANDSHAKE_TIMEOUT).await.map_err(ParticipantError::Handshake)? {
        ServerMessage::Welcome { .. } => Ok(()),
        ServerMessage::Refused { message } => Err(ParticipantError::Refused(message)),
        _ => Err(ParticipantError::Refused("its answer to `hello` is none".to_owned())),
    }
}

async fn shake_hands(connection: &mut Connection, client: &dyn Client) -> Result<(), ParticipantError> {
    greet(connection, Role::Client).await?;
    let broken = |e: FrameError| ParticipantError::Handshake(e.into());
    send(connection, &ClientMessage::Join(client.join())).await.map_err(broken)?;
    match receive(connection, HANDSHAKE_TIMEOUT).await.map_err(ParticipantError::Handshake)? {
        ServerMessage::Joined { .. } => Ok(()),
        ServerMessage::Refused { message } => Err(ParticipantError::Refused(message)),
        _ => Err(ParticipantError::Refused("its answer to `join` is none".to_owned())),
    }
}

async fn serve(mut connection: Connection, client: &mut dyn Client) -> Result<SessionEnd, ParticipantError> {
    let request = client.join();
    let mut endpoint = Endpoint::new(PortLayout::new(request.reads).size());
    let mut outputs = vec![0; PortLayout::new(request.writes).size()];
    loop {
        let lost = |source| ParticipantError::Lost { t_v: endpoint.t_v(), source };
        let frame = match connection.next().await {
            None => return Err(lost(ReceiveError::Closed)),
            Some(frame) => frame.map_err(|e| lost(e.into()))?,
        };
        let duty = endpoint.receive(frame)?;
        let t_v = endpoint.t_v();
        let sent = match duty {
            Duty::Leave(end) => return Ok(end),
            Duty::Nothing => Ok(()),
            Duty::Setup => {
                outputs.fill(0);
                match client.setup(&mut outputs) {
                    Ok(()) => answer(&mut connection, StepCount(0), t_v, Wake::NextPeriod, &outputs).await,
                    Err(fault) => return give_up(&mut connection, t_v, fault).await,
                }
            }
            Duty::Turn { sequence, t_v, inputs } => match client.turn(t_v, &inputs, &mut outputs) {
                Ok(wake) => answer(&mut connection, sequence, t_v, wake, &outputs).await,
                Err(fault) => return give_up(&mut connection, t_v, fault).await,
            },
            Duty::Save => match client.save() {
                Ok(state) => connection.send(FrameRef::State(&state)).await,
                // The session goes on; it is just not saved.
                Err(error) => send(&mut connection, &ClientMessage::Fault(ClientFault::new(error.to_string()))).await,
            },
            Duty::Restore(state) => match client.restore(&state) {
                Ok(()) => send(&mut connection, &ClientMessage::Restored {}).await,
                Err(error) => return give_up(&mut connection, t_v, ClientFault::new(error.to_string())).await,
            },
        };
        sent.map_err(|e| ParticipantError::Lost { t_v, source: e.into() })?;
        endpoint.answered();
    }
}

async fn answer(
    connection: &mut Connection,
    sequence: StepCount,
    t_v: VirtualTime,
    wake: Wake,
    outputs: &[u8],
) -> Result<(), FrameError> {
    connection.send(FrameRef::Turn { sequence, t_v, wake, outputs }).await
}

/// Tells the server why this client cannot go on.
async fn give_up(
    connection: &mut Connection,
    t_v: VirtualTime,
    fault: ClientFault,
) -> Result<SessionEnd, ParticipantError> {
    // If the server is gone too, the fault is still what matters here.
    let _ = send(connection, &ClientMessage::Fault(fault.clone())).await;
    farewell(connection).await;
    Err(ParticipantError::Fault { t_v, fault })
}
