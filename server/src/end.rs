//! How a session ends, and who is to blame.

use onescan_base::foreign::deserialize_line;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::fault::ClientFault;
use crate::signal::{BadValue, ClientName, SignalName};
use crate::state::ClientState;
use crate::time::{StepCount, VirtualTime};

/// Why a session is over, reported to every client.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(tag = "status", rename_all = "kebab-case", deny_unknown_fields)]
pub enum SessionEnd {
    /// The virtual time asked for was reached.
    Completed {
        /// Virtual time of the last committed step.
        #[serde(rename = "t_v_ns")]
        t_v: VirtualTime,
    },
    /// Somebody asked for the end.
    Stopped {
        /// Virtual time of the last committed step.
        #[serde(rename = "t_v_ns")]
        t_v: VirtualTime,
    },
    /// A client failed; nobody goes on without it.
    Failed(Failure),
}

impl std::fmt::Display for SessionEnd {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Completed { t_v } => write!(f, "completed at t_v = {t_v}"),
            Self::Stopped { t_v } => write!(f, "stopped at t_v = {t_v}"),
            Self::Failed(failure) => failure.fmt(f),
        }
    }
}

/// The failure of one client.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, Error)]
#[serde(deny_unknown_fields)]
#[error("client `{client}` failed in state {state} at t_v = {t_v}: {cause}")]
pub struct Failure {
    pub client: ClientName,
    /// In which state of its cycle.
    pub state: ClientState,
    /// At which virtual time.
    #[serde(rename = "t_v_ns")]
    pub t_v: VirtualTime,
    pub cause: FailureCause,
}

/// Why a client failed.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, Error)]
#[serde(rename_all = "kebab-case")]
pub enum FailureCause {
    /// The client said so itself.
    #[error("{0}")]
    Fault(ClientFault),
    /// It broke the rules of the cycle.
    #[error("{0}")]
    Violation(Violation),
    /// It did not answer in time.
    #[error("no answer within {after_ms} ms")]
    TimedOut {
        /// How long the server waited, wall clock.
        after_ms: u64,
    },
    /// Its connection is gone.
    #[error("connection closed")]
    Disconnected,
    /// What it sent cannot be understood.
    #[error("{0}")]
    Wire(#[serde(deserialize_with = "deserialize_line")] String),
    /// It could not hand out or take back its state.
    #[error("{0}")]
    State(#[serde(deserialize_with = "deserialize_line")] String),
}

/// A rule of the cycle that a client broke.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, Error)]
#[serde(tag = "rule", rename_all = "kebab-case")]
pub enum Violation {
    /// Spoke when all was over; nothing has come of it.
    #[error("the session is over")]
    SessionOver,
    /// Spoke in a state in which it has nothing to say.
    #[error("it answered in state {state}, not in {expected}")]
    WrongState {
        /// The state it is in.
        state: ClientState,
        /// The state for which its answer would be right.
        expected: ClientState,
    },
    /// Spoke in a step in which it sleeps, or twice in one.
    #[error("it answered without being asked")]
    NotAwaited,
    /// Answered the grant of another step.
    #[error("it answered grant {got} when grant {expected} is under way")]
    WrongStep {
        /// The sequence number of its answer.
        got: StepCount,
        /// The sequence number of the grant.
        expected: StepCount,
    },
    /// Answered for another virtual time.
    #[error("it answered for t_v = {got} when t_v is {expected}")]
    WrongTime {
        /// The virtual time of its answer.
        got: VirtualTime,
        /// The virtual time of the grant.
        expected: VirtualTime,
    },
    /// Bytes of another number than its port has.
    #[error("its outputs are {got} bytes, not {expected}")]
    WrongSize {
        got: usize,
        /// Bytes of its port.
        expected: usize,
    },
    /// Bytes that are not a value.
    #[error("its output `{signal}` is not a value: {reason}")]
    BadValue {
        signal: SignalName,
        #[serde(deserialize_with = "deserialize_line")]
        reason: String,
    },
    /// A wake-up in the past or off the grid.
    #[error("it asked to be woken at t_v = {wake}, which is not a later multiple of the step")]
    BadWake {
        /// The time it asked for.
        wake: VirtualTime,
    },
}

impl Violation {
    pub(crate) fn bad_value(signal: SignalName, bad: BadValue) -> Self {
        Self::BadValue { signal, reason: bad.to_string() }
    }
}
