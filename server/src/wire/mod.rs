//! The protocol between the server and a client behind a transport, without the transport.
//!
//! | module | subject |
//! |---|---|
//! | [`message`] | join and control messages: self-describing JSON |
//! | [`frame`] | frames and their codec: step messages are binary |
//! | [`endpoint`] | the client's side as a sans-IO machine |
//!
//! `server/PROTOCOL.md` is the specification; this is its implementation.

pub mod endpoint;
pub mod frame;
pub mod message;

pub use endpoint::{Duty, Endpoint, EndpointError};
pub use frame::{Frame, FrameCodec, FrameError, FrameRef};
pub use message::{ClientMessage, ServerMessage};

/// The lowest and highest protocol version that this build speaks.
pub const VERSIONS: VersionRange = VersionRange { min: 1, max: 1 };
const _: () = assert!(VERSIONS.min <= VERSIONS.max, "this build speaks one version at least");

/// Largest frame before a client has joined: nobody unknown makes the server hold more.
pub const HANDSHAKE_FRAME_BYTES_MAX: usize = 1024 * 1024;

/// Largest frame of a joined client unless the server says otherwise: the state of a large plant.
pub const FRAME_BYTES_MAX: usize = 64 * 1024 * 1024;

/// A range of protocol versions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VersionRange {
    pub min: u32,
    pub max: u32,
}

impl VersionRange {
    /// The highest version that both speak.
    pub fn common(self, other: Self) -> Option<u32> {
        let highest = self.max.min(other.max);
        (highest >= self.min.max(other.min)).then_some(highest)
    }
}

impl std::fmt::Display for VersionRange {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.min == self.max { write!(f, "{}", self.min) } else { write!(f, "{} to {}", self.min, self.max) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_highest_common_version_is_spoken() {
        let ours = VersionRange { min: 2, max: 4 };
        assert_eq!(ours.common(VersionRange { min: 1, max: 3 }), Some(3));
        assert_eq!(ours.common(VersionRange { min: 4, max: 9 }), Some(4));
        assert_eq!(ours.common(VersionRange { min: 5, max: 9 }), None);
        assert_eq!(ours.common(VersionRange { min: 1, max: 1 }), None);
    }
}
