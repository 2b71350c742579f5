//! Operations: what happens to a session from outside, as data, each at a step boundary.
//!
//! An operator, a case and a campaign do the same things by the same operations. An operation taken at
//! a boundary acts on the step that begins there: clients are asked before their turns, and values of
//! signals change with the commit that ends the step, like the outputs of any client. So a force at
//! 1.2 s is seen in the image of 1.2 s, whoever asked for it.

use std::fmt;

use onescan_base::foreign::one_line;
use onescan_base::value::BadText;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::client::{ClientOperation, OperationRefused};
use crate::signal::{ClientName, SignalName, SignalType};
use crate::time::{StepCount, TimeSpan, VirtualTime};

/// An operation. Values are text as in a recording: `1`, `-3.5`; `TRUE` and `FALSE` too.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(tag = "action", rename_all = "kebab-case")]
pub enum Operation {
    /// Ends the session for all.
    Stop,
    Pause,
    /// Lets virtual time run again.
    Resume,
    /// Runs exactly one step, then holds.
    Step,
    /// Restarts at `t_v = 0`; forces are released.
    Reset,
    /// Gives a signal a value until its writer writes it again.
    Write {
        signal: SignalName,
        value: String,
    },
    /// Holds a signal at a value, whatever its writer writes.
    Force {
        signal: SignalName,
        value: String,
    },
    /// Lets the writer of a forced signal write it again.
    Release {
        signal: SignalName,
    },
    /// Puts a fault on the way of a signal from its writer to its readers.
    Disturb {
        signal: SignalName,
        fault: SignalFault,
    },
    /// Ends the fault on the way of a signal.
    Mend {
        signal: SignalName,
    },
    /// A component of a plant fails.
    Fail {
        client: ClientName,
        component: String,
        /// How: one of the modes of failure of its kind.
        mode: String,
    },
    Repair {
        client: ClientName,
        component: String,
        /// The mode of failure.
        mode: String,
    },
    /// A parameter of a component of a plant takes another value.
    ChangeParameter {
        client: ClientName,
        component: String,
        /// The parameter: one of those of its kind.
        parameter: String,
        /// A number, `TRUE` or `FALSE`, or a word.
        value: String,
    },
    /// A parameter that was changed takes the value that the scene gives it.
    RestoreParameter {
        client: ClientName,
        component: String,
        parameter: String,
    },
    /// A variable of a PLC takes a value, until the program writes it.
    WriteVariable {
        client: ClientName,
        /// The variable's path, as `Main.limit`.
        variable: String,
        /// A literal of its type.
        value: String,
    },
    /// A variable of a PLC is held at a value, whatever the program writes.
    ForceVariable {
        client: ClientName,
        variable: String,
        /// A literal of its type.
        value: String,
    },
    /// A forced variable follows the program again.
    ReleaseVariable {
        client: ClientName,
        variable: String,
    },
    /// A task of a PLC, or all of them, are due later than they would be, from the next time on.
    Postpone {
        client: ClientName,
        /// The task's name; all tasks if absent.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        task: Option<String>,
        #[serde(rename = "by_ns")]
        by: TimeSpan,
    },
    /// A task that was postponed is due earlier by that again, at once if that has passed.
    CatchUp {
        client: ClientName,
        /// The task's name; all tasks if absent.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        task: Option<String>,
        #[serde(rename = "by_ns")]
        by: TimeSpan,
    },
}

/// How long it is from one push of a frame to the next: normally distributed, held within bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct PushInterval {
    #[serde(rename = "mean_ns")]
    pub mean: TimeSpan,
    /// Its standard deviation; none if all intervals are equal.
    #[serde(rename = "sigma_ns")]
    pub sigma: Option<TimeSpan>,
    #[serde(rename = "least_ns")]
    pub least: TimeSpan,
    #[serde(rename = "most_ns")]
    pub most: TimeSpan,
}

impl PushInterval {
    /// Whether the bounds are in order around the mean.
    pub fn is_in_order(&self) -> bool {
        self.least <= self.mean && self.mean <= self.most
    }
}

/// What can be wrong with a signal between its writer and its readers.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum SignalFault {
    /// It keeps the value that it has when the fault begins.
    Stuck,
    /// A BOOL arrives negated.
    Inverted,
    /// A number arrives shifted. An integer saturates at the bounds of its type.
    Offset {
        /// By how much, a number in the signal's own unit as text, as `-0.05`.
        by: String,
    },
    /// Values arrive late, in their order; until the first arrives the signal keeps its value.
    Late {
        /// By how much, rounded up to whole steps.
        #[serde(rename = "by_ns")]
        by: TimeSpan,
    },
    /// Changes are lost: the readers keep the value before until a change arrives. Of a line of bytes: single bytes.
    Lost {
        /// How many of the changes or bytes, from 0 to 1, as text.
        rate: String,
        /// Seed of the draws, one for each change.
        seed: u64,
    },
    /// The values of whole steps are lost: the readers keep those of the last step that arrived. Signals
    /// with the same rate and seed, disturbed at the same boundary, lose the same steps: they are one frame.
    LostSteps {
        /// How many of the steps, from 0 to 1, as text.
        rate: String,
        /// Seed of the draws, one for each step.
        seed: u64,
    },
    /// Values travel in frames, which a side that runs by its own clock pushes: between two pushes the readers keep
    /// those of the last one. Signals with the same interval and seed, disturbed at the same boundary, are one frame.
    Pushed {
        /// From push to push.
        interval: PushInterval,
        /// Seed of the draws, one for each push.
        seed: u64,
    },
    /// A bit of the value is inverted for a step; for REAL and LREAL only where that leaves a finite number. Of a line of
    /// bytes: a bit of a byte, for good.
    Flipped {
        /// In how many of the steps, or bytes, from 0 to 1, as text.
        rate: String,
        /// Seed of the draws.
        seed: u64,
    },
    /// No byte of a line comes through.
    Silent,
    /// No byte of a line comes through, and its connection, if it has one, is no more.
    Cut,
    /// A normal deviate is added in each step; integers are rounded and saturate at the bounds of their type.
    Noisy {
        /// Standard deviation, in the signal's own unit, as text.
        sigma: String,
        /// Seed of the draws, one for each step.
        seed: u64,
    },
}

impl Operation {
    /// The part of it that steers the session; nothing for what changes values or clients.
    pub fn control(&self) -> Option<Control> {
        match self {
            Self::Stop => Some(Control::Stop),
            Self::Pause => Some(Control::Pause),
            Self::Resume => Some(Control::Resume),
            Self::Step => Some(Control::Step),
            Self::Reset => Some(Control::Reset),
            _ => None,
        }
    }

    /// The client it is for and what that client is asked, if it is for one.
    pub fn for_client(&self) -> Option<(&ClientName, ClientOperation)> {
        use ClientOperation as C;
        Some(match self.clone() {
            Self::Fail { component, mode, .. } => (self.client()?, C::Fail { component, mode }),
            Self::Repair { component, mode, .. } => (self.client()?, C::Repair { component, mode }),
            Self::ChangeParameter { component, parameter, value, .. } => {
                (self.client()?, C::ChangeParameter { component, parameter, value })
            }
            Self::RestoreParameter { component, parameter, .. } => {
                (self.client()?, C::RestoreParameter { component, parameter })
            }
            Self::WriteVariable { variable, value, .. } => (self.client()?, C::WriteVariable { variable, value }),
            Self::ForceVariable { variable, value, .. } => (self.client()?, C::ForceVariable { variable, value }),
            Self::ReleaseVariable { variable, .. } => (self.client()?, C::ReleaseVariable { variable }),
            Self::Postpone { task, by, .. } => (self.client()?, C::Postpone { task, by }),
            Self::CatchUp { task, by, .. } => (self.client()?, C::CatchUp { task, by }),
            _ => return None,
        })
    }

    fn client(&self) -> Option<&ClientName> {
        match self {
            Self::Fail { client, .. }
            | Self::Repair { client, .. }
            | Self::ChangeParameter { client, .. }
            | Self::RestoreParameter { client, .. }
            | Self::WriteVariable { client, .. }
            | Self::ForceVariable { client, .. }
            | Self::ReleaseVariable { client, .. }
            | Self::Postpone { client, .. }
            | Self::CatchUp { client, .. } => Some(client),
            _ => None,
        }
    }

    /// True if it can change what the session computes; the others only change when.
    pub fn is_lasting(&self) -> bool {
        !matches!(self, Self::Pause | Self::Resume | Self::Step)
    }
}

/// What somebody who watches over a session may ask for. All of it acts at a step boundary.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Control {
    /// End the session for all.
    Stop,
    /// Hold virtual time at the next step boundary, until `Resume` or `Step`.
    Pause,
    /// Let virtual time run again.
    Resume,
    /// Run exactly one step, then hold.
    Step,
    /// Restart at `t_v = 0`, from the initial write; a session that is held stays held.
    Reset,
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

impl fmt::Display for Operation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some((client, operation)) = self.for_client() {
            return write!(f, "{operation} (client `{client}`)");
        }
        match self {
            Self::Write { signal, value } => write!(f, "`{signal}` is set to {}", one_line(value)),
            Self::Force { signal, value } => write!(f, "`{signal}` is forced to {}", one_line(value)),
            Self::Release { signal } => write!(f, "`{signal}` is released"),
            Self::Disturb { signal, fault } => write!(f, "`{signal}` is disturbed: {fault}"),
            Self::Mend { signal } => write!(f, "`{signal}` is mended"),
            Self::Stop => f.write_str("stop"),
            Self::Pause => f.write_str("pause"),
            Self::Resume => f.write_str("resume"),
            Self::Step => f.write_str("step"),
            Self::Reset => f.write_str("reset"),
            // Described above.
            Self::Fail { .. }
            | Self::Repair { .. }
            | Self::ChangeParameter { .. }
            | Self::RestoreParameter { .. }
            | Self::WriteVariable { .. }
            | Self::ForceVariable { .. }
            | Self::ReleaseVariable { .. }
            | Self::Postpone { .. }
            | Self::CatchUp { .. } => Ok(()),
        }
    }
}

impl fmt::Display for SignalFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stuck => f.write_str("stuck"),
            Self::Inverted => f.write_str("inverted"),
            Self::Offset { by } => write!(f, "offset by {}", one_line(by)),
            Self::Late { by } => write!(f, "late by {by}"),
            Self::Lost { rate, .. } => write!(f, "losing changes at a rate of {}", one_line(rate)),
            Self::LostSteps { rate, .. } => write!(f, "losing frames at a rate of {}", one_line(rate)),
            Self::Pushed { interval, .. } => write!(f, "pushed every {}", interval.mean),
            Self::Flipped { rate, .. } => write!(f, "flipped at a rate of {}", one_line(rate)),
            Self::Silent => f.write_str("silent"),
            Self::Cut => f.write_str("cut"),
            Self::Noisy { sigma, .. } => write!(f, "noisy by {}", one_line(sigma)),
        }
    }
}

/// Why an operation cannot be done.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum OperationError {
    #[error("the session has no signal `{signal}`{}", nearest.as_ref().map(|n| format!("; {n}")).unwrap_or_default())]
    Unknown {
        signal: SignalName,
        /// The one that may have been meant.
        nearest: Option<String>,
    },
    #[error("the session has no client `{client}`{}", nearest.as_ref().map(|n| format!("; {n}")).unwrap_or_default())]
    UnknownClient {
        client: ClientName,
        /// The one that may have been meant.
        nearest: Option<String>,
    },
    #[error("signal `{signal}`: {source}")]
    Value { signal: SignalName, source: BadText },
    #[error("signal `{0}` is not forced")]
    NotForced(SignalName),
    /// A write that a force would hide.
    #[error("signal `{0}` is forced; release it, or force it to another value")]
    Forced(SignalName),
    #[error("signal `{0}` is not disturbed")]
    NotDisturbed(SignalName),
    /// A fault that this type of signal cannot have.
    #[error("signal `{signal}` is {ty}, which cannot be {fault}")]
    FaultType { signal: SignalName, ty: SignalType, fault: SignalFault },
    #[error("client `{client}`: {source}")]
    Client { client: ClientName, source: OperationRefused },
    /// A client that does not begin again; then nobody does.
    #[error("the session is not reset, because of client `{client}`: {source}")]
    NoReset { client: ClientName, source: OperationRefused },
}

/// Who asked for an operation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Author {
    /// A person, or a program that stands for one: it is replayed by `--replay-operator`.
    #[default]
    Operator,
    /// The session's timeline, which a case brings along by itself.
    Timeline,
}

/// An operation and the boundary at which it was taken: after `step`, before the next.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct OperatorInput {
    /// How often the session had restarted before it.
    #[serde(default)]
    pub resets: u64,
    /// The last step committed before it.
    pub step: StepCount,
    #[serde(rename = "t_v_ns")]
    pub t_v: VirtualTime,
    /// Who asked for it.
    #[serde(skip)]
    pub author: Author,
    #[serde(flatten)]
    pub operation: Operation,
}
