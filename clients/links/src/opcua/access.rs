//! Who is let in by an OPC UA server, and why somebody was not.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use onescan_server::access::Register;
use thiserror::Error;

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
