//! An OPC UA server: endpoints, users, certificates.
//!
//! | module | subject |
//! |---|---|
//! | `endpoints` | the server itself, with the feature `opcua` |
//! | `admitted` | nodes for clients that are who their certificate says |
//! | `door` | where connections come in, and which of them are closed |
//! | `doorkeeper` | users, and who was sent away |
//! | `pki` | the folder for certificates, of servers and of clients |
//! | `absent` | what stands for it without that feature |

#[cfg(not(feature = "opcua"))]
mod absent;
#[cfg(feature = "opcua")]
mod admitted;
#[cfg(feature = "opcua")]
mod door;
#[cfg(feature = "opcua")]
mod doorkeeper;
#[cfg(feature = "opcua")]
mod endpoints;
#[cfg(feature = "opcua")]
pub(crate) mod pki;

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use onescan_server::access::Register;
use thiserror::Error;

#[cfg(not(feature = "opcua"))]
pub use absent::{ABSENT, Running};
#[cfg(feature = "opcua")]
pub(crate) use admitted::Admitted;
#[cfg(feature = "opcua")]
pub(crate) use door::Channels;
#[cfg(feature = "opcua")]
pub use endpoints::Running;
#[cfg(feature = "opcua")]
pub(crate) use endpoints::*;

/// Who is let in.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Access {
    /// User and password; without them anybody is let in.
    pub user: Option<(String, String)>,
    /// Tokens: who has one of an operator's is let in by its name, with the token as password. They count in place of
    /// `user`.
    pub register: Option<Arc<Register>>,
    /// The folder with the server's certificates and those of clients it trusts; with it there are no endpoints
    /// without security.
    pub pki: Option<PathBuf>,
    /// Trust any client's certificate.
    pub trust_clients: bool,
    /// Let in clients whose certificate was made for another application.
    pub foreign_uris: bool,
}

/// Why somebody was not let in last, in words.
#[derive(Clone, Debug, Default)]
pub struct Refusals(Arc<Mutex<Option<String>>>);

impl Refusals {
    /// Notes why somebody is not let in.
    pub fn note(&self, why: String) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(why);
    }

    /// Why somebody was not let in last.
    pub fn last(&self) -> Option<String> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

/// Why there is no server.
#[derive(Debug, Error)]
pub enum ServeError {
    /// The address, or the folder for certificates.
    #[error(transparent)]
    Io(#[from] std::io::Error),
    /// What the server is to be does not go together.
    #[error("the OPC UA server cannot be set up: {0}")]
    Setup(String),
    /// The program was built without it.
    #[error("{0}")]
    Absent(&'static str),
}
