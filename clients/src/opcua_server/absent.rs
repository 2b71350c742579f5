//! A program without OPC UA: it says so, and how to get one with it.

use std::convert::Infallible;
use std::net::SocketAddr;

/// What every attempt to use OPC UA is answered.
pub const ABSENT: &str =
    "this program was built without OPC UA: build it with `--features opcua` (see README.md, Install)";

/// A server that runs; there is none.
pub struct Running {
    never: Infallible,
}

impl Running {
    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        match self.never {}
    }
}
