//! An OPC UA server: endpoints, users, certificates.
//!
//! | module | subject |
//! |---|---|
//! | `endpoints` | the server itself |
//! | `admitted` | nodes for clients that are who their certificate says |
//! | `door` | where connections come in, and which of them are closed |
//! | `authenticator` | users, and who was sent away |
//! | `pki` | the folder for certificates, of servers and of clients |

mod admitted;
mod authenticator;
mod door;
mod endpoints;
pub(crate) mod pki;

pub(crate) use admitted::Admitted;
pub(crate) use door::Channels;
pub use endpoints::Running;
pub(crate) use endpoints::start;
