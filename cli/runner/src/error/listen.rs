//! An address cannot be listened on.

use std::io;
use std::net::SocketAddr;

use thiserror::Error;

/// An address that cannot be listened on.
#[derive(Debug, Error)]
#[error("cannot listen on {address}: {source}{}", what_to_do(source))]
pub struct ListenError {
    pub address: SocketAddr,
    pub source: io::Error,
}

fn what_to_do(source: &io::Error) -> &'static str {
    match source.kind() {
        io::ErrorKind::AddrInUse => {
            ": another program listens there, perhaps another onescan; choose another port, or 0 for a free one"
        }
        io::ErrorKind::AddrNotAvailable => ": this machine does not have that address; 127.0.0.1 is always there",
        io::ErrorKind::PermissionDenied => ": choose a port from 1024 on",
        _ => "",
    }
}

impl ListenError {
    /// The error of listening on `address`, for `map_err`.
    pub fn on(address: SocketAddr) -> impl Fn(io::Error) -> Self {
        move |source| Self { address, source }
    }
}
