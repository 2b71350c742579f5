//! Why a client cannot go on, in its own words.

use std::fmt;

use onescan_base::foreign::{deserialize_line, one_line};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A place in a source file that a client runs, counted from 1.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SourcePlace {
    /// The file, as the scenario names it.
    #[serde(deserialize_with = "deserialize_line")]
    pub file: String,
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
}

impl fmt::Display for SourcePlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}", self.file, self.line, self.column)
    }
}

/// Why a client cannot go on.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, Error)]
#[serde(deny_unknown_fields)]
#[error("{message}{}", place.as_ref().map(|place| format!(" at {place}")).unwrap_or_default())]
pub struct ClientFault {
    /// What happened, in one line.
    #[serde(deserialize_with = "deserialize_line")]
    pub message: String,
    /// Where in the client's own sources, if it has any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub place: Option<SourcePlace>,
}

impl ClientFault {
    /// A fault without a place.
    pub fn new(message: impl Into<String>) -> Self {
        Self { message: one_line(&message.into()).into_owned(), place: None }
    }
}
