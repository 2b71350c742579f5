//! Why nobody could take part.

use std::net::SocketAddr;

use thiserror::Error;

use super::ReceiveError;
use crate::client::ClientFault;
use crate::time::VirtualTime;
use crate::wire::EndpointError;

/// Why a client did not stay to the end.
#[derive(Debug, Error)]
pub enum ParticipantError {
    #[error("cannot connect to the server at {address}: {source}")]
    Connect { address: SocketAddr, source: std::io::Error },
    /// TLS does not come about.
    #[error("cannot speak TLS with the server at {address}: {why}")]
    Tls { address: SocketAddr, why: String },
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
        source: ReceiveError,
    },
    /// The server broke the protocol.
    #[error(transparent)]
    Server(#[from] EndpointError),
    /// The client itself could not go on; the server has been notified.
    #[error("at t_v = {t_v}: {fault}")]
    Fault {
        /// Virtual time of the turn.
        t_v: VirtualTime,
        fault: ClientFault,
    },
}
