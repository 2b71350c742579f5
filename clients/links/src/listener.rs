//! Listening, for every server of this crate.

use std::net::{SocketAddr, TcpListener};

/// A listener that does not block, and the address that it got.
///
/// # Errors
/// The address cannot be listened on.
pub fn bind(address: SocketAddr) -> std::io::Result<(TcpListener, SocketAddr)> {
    let listener = TcpListener::bind(address)?;
    let address = listener.local_addr()?;
    listener.set_nonblocking(true)?;
    Ok((listener, address))
}
