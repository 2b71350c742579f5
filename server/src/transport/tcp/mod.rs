//! TCP: one connection a client.
//!
//! | module | subject |
//! |---|---|
//! | [`lobby`] | the listener; a thread of its own, asynchronous |
//! | `order`, `host` | what is to be done with its connections; what they share |
//! | `attend` | one of them |
//! | `holders` | who came with a certificate, and what becomes of them when it is revoked |
//! | `pending` | a client that waits for a seat, seen from the session's thread |
//! | `error` | why nobody could take part |
//! | [`entrance`] | where a session is, and what it takes to be let in |
//! | `socket` | a blocking socket, in plain text or under TLS |
//! | `stream` | frames over it |
//! | `remote` | a joined client, seen from the session's thread |
//! | [`participant`] | the client's side: join and take part |
//! | [`operator`] | the operator's side: one wish, one answer |
//!
//! Many strangers may come and go in the lobby, so it is asynchronous. A client that has joined is
//! waited for by exactly one thread on either side, so from there on sockets block: see
//! `docs/decisions/002-blocking-steps.md`.

mod attend;
pub mod entrance;
mod error;
mod holders;
mod host;
pub mod lobby;
pub mod operator;
mod order;
pub mod participant;
mod pending;
mod remote;
mod socket;
mod stream;

use std::time::Duration;

use onescan_base::foreign::one_line;
use thiserror::Error;

pub use entrance::Entrance;
pub use lobby::{House, Lobby};

use crate::wire::FrameError;

pub use crate::lobby::acceptor::{CLOSE_TIMEOUT, HANDSHAKE_TIMEOUT};

/// What this program calls itself to the other side.
const AGENT: &str = concat!("onescan ", env!("CARGO_PKG_VERSION"));

/// Why no message came of a connection.
#[derive(Debug, Error)]
pub enum ReceiveError {
    /// The other side is gone.
    #[error("connection closed")]
    Closed,
    /// The other side is silent.
    #[error("no answer within {} ms", .0.as_millis())]
    TimedOut(Duration),
    /// Bytes that are not a frame, or a broken transport.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// A frame of a kind that has no place here.
    #[error("a binary frame where a JSON message is due")]
    NotJson,
    /// JSON that is not a message of the protocol.
    #[error("not a message of this protocol: {}", one_line(&.0.to_string()))]
    Message(#[from] serde_json::Error),
}

impl ReceiveError {
    /// True for an end of the connection, in whatever way the operating system puts it.
    pub fn is_disconnect(&self) -> bool {
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
