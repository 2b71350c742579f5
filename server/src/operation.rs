//! What operators do to a session, as data: each at a step boundary, in an order.

use onescan_base::value::BadText;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::session::Control;
use crate::signal::SignalName;
use crate::time::{StepCount, VirtualTime};

/// What an operator does. Values are text as in a recording: `1`, `-3.5`; `TRUE` and `FALSE` too.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "action", rename_all = "kebab-case")]
pub enum Operation {
    /// Ends the session for all.
    Stop,
    /// Holds virtual time.
    Pause,
    /// Lets virtual time run again.
    Resume,
    /// Runs exactly one step, then holds.
    Step,
    /// Begins anew at `t_v = 0`; forces are released.
    Reset,
    /// Gives a signal a value until its writer writes it again.
    Write {
        /// The signal.
        signal: SignalName,
        /// Its value.
        value: String,
    },
    /// Holds a signal at a value, whatever its writer writes.
    Force {
        /// The signal.
        signal: SignalName,
        /// Its value.
        value: String,
    },
    /// Lets the writer of a forced signal write it again.
    Release {
        /// The signal.
        signal: SignalName,
    },
}

impl Operation {
    /// What of it steers the session; a write, a force and a release do not.
    pub fn control(&self) -> Option<Control> {
        match self {
            Self::Stop => Some(Control::Stop),
            Self::Pause => Some(Control::Pause),
            Self::Resume => Some(Control::Resume),
            Self::Step => Some(Control::Step),
            Self::Reset => Some(Control::Reset),
            Self::Write { .. } | Self::Force { .. } | Self::Release { .. } => None,
        }
    }
}

impl From<Control> for Operation {
    fn from(control: Control) -> Self {
        match control {
            Control::Stop => Self::Stop,
            Control::Pause => Self::Pause,
            Control::Resume => Self::Resume,
            Control::Step => Self::Step,
            Control::Reset => Self::Reset,
        }
    }
}

impl Operation {
    /// True if it can change what the session computes; the others only change when.
    pub fn is_lasting(&self) -> bool {
        !matches!(self, Self::Pause | Self::Resume | Self::Step)
    }
}

/// Why an operation cannot be done.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum OperationError {
    /// No such signal.
    #[error("the session has no signal `{signal}`{}", nearest.as_ref().map(|n| format!("; {n}")).unwrap_or_default())]
    Unknown {
        /// The name.
        signal: SignalName,
        /// The one that may have been meant.
        nearest: Option<String>,
    },
    /// No such value.
    #[error("signal `{signal}`: {source}")]
    Value {
        /// The signal.
        signal: SignalName,
        /// Why.
        source: BadText,
    },
    /// Nothing to release.
    #[error("signal `{0}` is not forced")]
    NotForced(SignalName),
}

/// An operation and the boundary at which it was taken: after `step`, before the next.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct OperatorInput {
    /// How often the session had begun anew before it.
    #[serde(default)]
    pub resets: u64,
    /// The last step committed before it.
    pub step: StepCount,
    /// Its virtual time.
    #[serde(rename = "t_v_ns")]
    pub t_v: VirtualTime,
    /// What was done.
    #[serde(flatten)]
    pub operation: Operation,
}
