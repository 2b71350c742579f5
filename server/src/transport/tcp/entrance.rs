//! Where a session is, and what it takes to be let in.

use std::net::{SocketAddr, TcpStream};

use rustls::pki_types::ServerName;
use rustls::{ClientConnection, StreamOwned};

use super::HANDSHAKE_TIMEOUT;
use super::error::ParticipantError;
use super::socket::Socket;
use super::stream::FrameStream;
use crate::access::Token;
use crate::transport::tls::{Trust, reason};
use crate::wire::FRAME_BYTES_MAX;

/// Where a session is, and what it takes to be let in. An address alone is a session of this machine that asks for
/// nothing.
#[derive(Clone, Debug)]
pub struct Entrance {
    pub address: SocketAddr,
    /// The token to show.
    pub token: Option<Token>,
    /// Whose certificate the server must have; plain text without.
    pub trust: Option<Trust>,
}

impl From<SocketAddr> for Entrance {
    fn from(address: SocketAddr) -> Self {
        Self { address, token: None, trust: None }
    }
}

/// A connection, not yet greeted.
pub(super) fn connect(entrance: &Entrance) -> Result<FrameStream, ParticipantError> {
    let address = entrance.address;
    let refused = |source| ParticipantError::Connect { address, source };
    let stream = TcpStream::connect_timeout(&address, HANDSHAKE_TIMEOUT).map_err(refused)?;
    let socket = match &entrance.trust {
        None => Socket::Plain(stream),
        Some(trust) => secured(stream, trust, address)?,
    };
    FrameStream::new(socket, FRAME_BYTES_MAX, HANDSHAKE_TIMEOUT).map_err(refused)
}

/// TLS over `stream`, with a server whose certificate is for this address.
fn secured(mut stream: TcpStream, trust: &Trust, address: SocketAddr) -> Result<Socket, ParticipantError> {
    let failed = |why: String| ParticipantError::Tls { address, why };
    stream.set_read_timeout(Some(HANDSHAKE_TIMEOUT)).map_err(|e| failed(e.to_string()))?;
    stream.set_write_timeout(Some(HANDSHAKE_TIMEOUT)).map_err(|e| failed(e.to_string()))?;
    let name = ServerName::from(address.ip());
    let mut tls = ClientConnection::new(trust.0.clone(), name).map_err(|e| failed(e.to_string()))?;
    while tls.is_handshaking() {
        tls.complete_io(&mut stream).map_err(|e| failed(reason(&e)))?;
    }
    Ok(Socket::Visiting(Box::new(StreamOwned::new(tls, stream))))
}
