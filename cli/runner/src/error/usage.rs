//! What was typed is wrong.

use miette::Diagnostic;
use thiserror::Error;

/// Options or inputs that make no sense, with what to do about it.
#[derive(Clone, Debug, PartialEq, Eq, Error, Diagnostic)]
#[error("{message}")]
pub struct Usage {
    pub message: String,
    #[help]
    pub help: Option<String>,
}

impl Usage {
    /// A mistake, with the way out if there is one.
    pub fn new(message: impl Into<String>, help: Option<String>) -> Self {
        Self { message: message.into(), help }
    }
}
