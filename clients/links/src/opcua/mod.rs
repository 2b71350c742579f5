//! OPC UA as a program may have it: settings as plain data, and how a session is served.
//!
//! | module | subject |
//! |---|---|
//! | `options` | how a client presents itself, and where its variables are |
//! | `access` | who is let in by a server, and why somebody was not |
//! | `session` | a session served, by whoever has the protocol |
//!
//! The protocol takes long to build, so it lives in a crate above this one, which a program installs or not. Each of
//! the three uses has an interface where it is used: here, in [`gateway::opcua`](crate::gateway::opcua) and in
//! [`station::opcua`](crate::station::opcua). Without the crate each refuses with [`ABSENT`].

mod access;
mod options;
mod session;

pub use access::{Access, Refusals, ServeError};
pub use options::{NAMESPACE, Options};
pub use session::{ServeSession, ServedSession, install, serve};

/// Answers every use of OPC UA in a program that was built without it.
pub const ABSENT: &str =
    "this program was built without OPC UA: build it with `--features opcua` (see README.md, Install)";
