//! TCP: one connection a client.
//!
//! | module | subject |
//! |---|---|
//! | [`lobby`] | the listener: handshakes, applicants, operators; a thread of its own |
//! | [`remotes`] | the joined clients, seen from the session's thread |
//! | [`participant`] | the client's side: join and take part |
//! | [`operator`] | the operator's side: one wish, one answer |

pub mod lobby;
pub mod operator;
pub mod participant;
pub mod remotes;

use std::time::Duration;

use futures_util::{SinkExt, StreamExt};
use serde::Serialize;
use serde::de::DeserializeOwned;
use thiserror::Error;
use tokio::net::TcpStream;
use tokio_util::codec::Framed;

pub use lobby::{Applicant, Lobby};
pub use remotes::{RemoteError, Remotes};

use crate::wire::{Frame, FrameCodec, FrameError, FrameRef};

/// How long the other side may take for a message of the handshake.
pub const HANDSHAKE_TIMEOUT: Duration = Duration::from_secs(5);

/// What this program calls itself to the other side.
const AGENT: &str = concat!("onescan ", env!("CARGO_PKG_VERSION"));

type Connection = Framed<TcpStream, FrameCodec>;

/// Why no message came of a connection.
#[derive(Debug, Error)]
pub enum ReceiveError {
    /// The other side is gone.
    #[error("connection closed")]
    Closed,
    /// The other side is silent.
    #[error("no answer within {} ms", .0.as_millis())]
    TimedOut(Duration),
    /// Bytes that are no frame, or a broken transport.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// A frame of a kind that has no place here.
    #[error("a binary frame where a JSON message is due")]
    NotJson,
    /// JSON that is no message of the protocol.
    #[error("not a message of this protocol: {0}")]
    Message(#[from] serde_json::Error),
}

impl ReceiveError {
    /// True for an end of the connection, in whatever way the operating system puts it.
    pub(crate) fn is_disconnect(&self) -> bool {
        use std::io::ErrorKind::{BrokenPipe, ConnectionAborted, ConnectionReset, UnexpectedEof};
        match self {
            Self::Closed | Self::Frame(FrameError::Cut) => true,
            Self::Frame(FrameError::Io(e)) => {
                matches!(e.kind(), BrokenPipe | ConnectionAborted | ConnectionReset | UnexpectedEof)
            }
            _ => false,
        }
    }
}

async fn receive_frame(connection: &mut Connection, patience: Duration) -> Result<Frame, ReceiveError> {
    match tokio::time::timeout(patience, connection.next()).await {
        Err(_) => Err(ReceiveError::TimedOut(patience)),
        Ok(None) => Err(ReceiveError::Closed),
        Ok(Some(frame)) => Ok(frame?),
    }
}

async fn receive<M: DeserializeOwned>(connection: &mut Connection, patience: Duration) -> Result<M, ReceiveError> {
    match receive_frame(connection, patience).await? {
        Frame::Json(text) => Ok(serde_json::from_slice(&text)?),
        _ => Err(ReceiveError::NotJson),
    }
}

async fn send<M: Serialize>(connection: &mut Connection, message: &M) -> Result<(), FrameError> {
    let json = crate::wire::frame::to_json(message).map_err(std::io::Error::from)?;
    connection.send(FrameRef::Json(&json)).await
}

/// How long the other side may take to close after a last message.
const FAREWELL_TIMEOUT: Duration = Duration::from_secs(1);

/// Closes after a last message: no more is sent, and what still comes is thrown away, so that the
/// operating system does not reset the connection and the last message with it.
async fn farewell(connection: &mut Connection) {
    use tokio::io::{AsyncReadExt, AsyncWriteExt};
    let stream = connection.get_mut();
    let drain = async {
        let mut waste = [0; 4096];
        stream.shutdown().await.ok()?;
        while stream.read(&mut waste).await.ok()? > 0 {}
        Some(())
    };
    // One who does not close in time is left.
    let _ = tokio::time::timeout(FAREWELL_TIMEOUT, drain).await;
}

/// A runtime for one thread: tasks run only while that thread waits.
fn runtime() -> std::io::Result<tokio::runtime::Runtime> {
    tokio::runtime::Builder::new_current_thread().enable_all().build()
}
