//! An address cannot be listened on.

use std::io;
use std::net::SocketAddr;

use thiserror::Error;

/// An address that cannot be listened on.
#[derive(Debug, Error)]
#[error("cannot listen on {address}: {source}")]
pub struct ListenError {
    pub address: SocketAddr,
    pub source: io::Error,
}

impl ListenError {
    /// The error of listening on `address`, for `map_err`.
    pub fn on(address: SocketAddr) -> impl Fn(io::Error) -> Self {
        move |source| Self { address, source }
    }
}
