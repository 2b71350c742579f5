//! What takes part in a session: the one interface of plant, PLC, gateway and replay.

use std::fmt;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::signal::{ClientName, Port};
use crate::time::{TimeSpan, VirtualTime};

/// The index of a client in its session: the rank of its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ClientId(pub(crate) u32);

impl ClientId {
    /// The client of rank `index`.
    pub const fn from_index(index: usize) -> Self {
        Self(index as u32)
    }

    /// The index into tables that hold one row a client.
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

/// What a client says of itself when it joins.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JoinRequest {
    /// Its name, as the session expects it.
    pub name: ClientName,
    /// Virtual time that one turn covers; a multiple of the session's step.
    #[serde(rename = "period_ns")]
    pub period: TimeSpan,
    /// The signals it reads, in the order of its input bytes.
    #[serde(default)]
    pub reads: Vec<Port>,
    /// The signals it writes, in the order of its output bytes.
    #[serde(default)]
    pub writes: Vec<Port>,
}

/// When a client wants its next turn: the `t_delay` of seed 004 sec. IV.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wake {
    /// One period after this turn.
    NextPeriod,
    /// At this virtual time: later than the turn's, on the grid of the session's step.
    At(VirtualTime),
}

/// A subsimulation that runs in the server's process or behind a transport.
///
/// A client is a function of its state, its inputs and `t_v` alone: it reads no clock and no random
/// source that the scenario did not seed.
pub trait Client: Send {
    /// What the client needs and gives.
    fn join(&self) -> JoinRequest;

    /// Takes the initial state and writes the initial values of all outputs
    /// (seed 004 `client.setup`). Called again for every reset; the state is then a new client's.
    ///
    /// # Errors
    /// The client cannot initialise.
    fn setup(&mut self, outputs: &mut [u8]) -> Result<(), ClientFault>;

    /// Runs one turn that ends at `t_v`: a PLC scans once, a plant steps once (`client.run`).
    /// `inputs` and `outputs` are packed in the order of [`JoinRequest`]; `outputs` holds what the
    /// turn before left there.
    ///
    /// # Errors
    /// The client cannot go on; the session ends for all.
    fn turn(&mut self, t_v: VirtualTime, inputs: &[u8], outputs: &mut [u8]) -> Result<Wake, ClientFault>;

    /// The complete state as bytes, taken between two turns.
    ///
    /// # Errors
    /// [`StateError::Unsupported`] for a client that cannot save, as a real PLC.
    fn save(&self) -> Result<Vec<u8>, StateError> {
        Err(StateError::Unsupported)
    }

    /// Takes back a state that [`Client::save`] gave, to the bit.
    ///
    /// # Errors
    /// Bytes that are not a state of this client.
    fn restore(&mut self, state: &[u8]) -> Result<(), StateError> {
        let _ = state;
        Err(StateError::Unsupported)
    }
}

/// A place in a source file that a client runs, counted from 1.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SourcePlace {
    /// The file, as the scenario names it.
    pub file: String,
    /// Line, from 1.
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
    pub message: String,
    /// Where in the client's own sources, if it has any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub place: Option<SourcePlace>,
}

impl ClientFault {
    /// A fault without a place.
    pub fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), place: None }
    }
}

/// Why a state cannot be saved or taken back.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum StateError {
    /// The client has no state that can be saved.
    #[error("this client cannot save its state")]
    Unsupported,
    /// The bytes are not a state of this client.
    #[error("not a state of this client: {0}")]
    Corrupt(String),
}
