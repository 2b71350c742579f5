//! What takes part in a session: the one interface of plant, PLC, gateway and replay.

use std::fmt;

use onescan_base::foreign::{deserialize_line, one_line};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::end::FailureCause;
pub use crate::fault::{ClientFault, SourcePlace};
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

/// When a client wants its next turn: the `t_delay` of `[SDSP]` sec. IV.
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
    /// (`[SDSP]` `client.setup`). Called again for every reset; the state is then a new client's.
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

    /// As [`setup`](Self::setup), with `operations` in force from the initial values on.
    ///
    /// # Errors
    /// The client cannot initialise, or cannot do one of the operations.
    fn begin(&mut self, operations: &[ClientOperation], outputs: &mut [u8]) -> Result<(), ClientFault> {
        match operations {
            [] => self.setup(outputs),
            [first, ..] => Err(ClientFault::new(format!("{first}: {}", OperationRefused::Unsupported))),
        }
    }

    /// Does what is asked for at a step boundary; it acts from the next turn on and belongs to the
    /// client's state.
    ///
    /// # Errors
    /// The client cannot do it; nothing has changed then.
    fn operate(&mut self, operation: &ClientOperation) -> Result<(), OperationRefused> {
        let _ = operation;
        Err(OperationRefused::Unsupported)
    }

    /// Whether [`setup`](Self::setup) would make a new client of it, as a reset of the session needs. Asked before one.
    ///
    /// # Errors
    /// Its program goes on whatever the session does: why, and what to do instead.
    fn can_reset(&self) -> Result<(), OperationRefused> {
        Ok(())
    }

    /// Adds to `view` those parts of what can be seen of the client beside its signals. Called between two turns,
    /// only when somebody looks.
    fn show(&self, parts: Parts, view: &mut ClientView) {
        // A client shows nothing beside its signals unless it says otherwise.
        let _ = (parts, view);
    }

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

/// What is done to one client from outside, at a step boundary.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(tag = "action", rename_all = "kebab-case", deny_unknown_fields)]
pub enum ClientOperation {
    /// A component of a plant fails.
    Fail {
        component: String,
        /// How: one of the modes of failure of its kind.
        mode: String,
    },
    Repair {
        component: String,
        /// The mode of failure.
        mode: String,
    },
    /// A parameter of a component of a plant takes another value.
    ChangeParameter {
        component: String,
        /// The parameter: one of those of its kind.
        parameter: String,
        /// A number, `TRUE` or `FALSE`, or a word.
        value: String,
    },
    /// A parameter that was changed takes the value that the scene gives it.
    RestoreParameter { component: String, parameter: String },
    /// A variable of a PLC takes a value, until the program writes it.
    WriteVariable {
        /// Its path, as `Main.limit`.
        variable: String,
        /// A literal of its type.
        value: String,
    },
    /// A variable of a PLC is held at a value, whatever the program writes.
    ForceVariable {
        variable: String,
        /// A literal of its type.
        value: String,
    },
    /// A forced variable follows the program again.
    ReleaseVariable { variable: String },
    /// A task of a PLC, or all of them, are due later than they would be, from the next time on.
    Postpone {
        /// Its name; all tasks if absent.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        task: Option<String>,
        #[serde(rename = "by_ns")]
        by: TimeSpan,
    },
    /// A task that was postponed is due earlier by that again, at once if that has passed.
    CatchUp {
        /// Its name; all tasks if absent.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        task: Option<String>,
        #[serde(rename = "by_ns")]
        by: TimeSpan,
    },
}

impl ClientOperation {
    /// True if the client may want its next turn earlier than it has said.
    pub(crate) fn moves_turns(&self) -> bool {
        matches!(self, Self::Postpone { .. } | Self::CatchUp { .. })
    }
}

/// A task as words have it.
fn task_word(task: Option<&String>) -> String {
    task.map_or_else(|| "all tasks".to_owned(), |task| format!("task `{task}`"))
}

impl fmt::Display for ClientOperation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = match self {
            Self::Fail { component, mode } => format!("`{component}` fails: {mode}"),
            Self::Repair { component, mode } => format!("`{component}` is repaired: {mode}"),
            Self::ChangeParameter { component, parameter, value } => {
                format!("`{parameter}` of `{component}` becomes {value}")
            }
            Self::RestoreParameter { component, parameter } => {
                format!("`{parameter}` of `{component}` is as the scene has it again")
            }
            Self::WriteVariable { variable, value } => format!("`{variable}` is set to {value}"),
            Self::ForceVariable { variable, value } => format!("`{variable}` is forced to {value}"),
            Self::ReleaseVariable { variable } => format!("`{variable}` is released"),
            Self::Postpone { task, by } => format!("{} late by {by}", task_word(task.as_ref())),
            Self::CatchUp { task, by } => format!("{} in time again, late by {by} before", task_word(task.as_ref())),
        };
        f.write_str(&one_line(&text))
    }
}

/// Why a client does not do what it is asked for.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, Error)]
#[serde(rename_all = "kebab-case")]
pub enum OperationRefused {
    /// It has nothing of that kind: a plant has no variables, a PLC no components.
    #[error("this client does not take such an operation")]
    Unsupported,
    /// It has, but not this: the reason, with a hint where there is one.
    #[error("{0}")]
    Because(#[serde(deserialize_with = "deserialize_line")] String),
}

/// Parts of what can be seen of clients beside their signals. A session pays for each that it shows, so it shows those that
/// somebody wants.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Parts {
    /// Where the bodies of plants are.
    pub poses: bool,
    /// Tables of values: every value is computed again.
    pub tables: bool,
    /// The memories of PLCs: each is copied whole.
    pub memories: bool,
}

impl Parts {
    /// All there is to see.
    pub const ALL: Self = Self { poses: true, tables: true, memories: true };
    /// The bodies of plants alone.
    pub const POSES: Self = Self { poses: true, tables: false, memories: false };
    /// The memories of PLCs alone.
    pub const MEMORIES: Self = Self { poses: false, tables: false, memories: true };
}

/// What can be seen of clients beside their signals.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ClientView {
    /// The parts that are shown; what is not among them is empty, whatever there is.
    pub parts: Parts,
    /// Where the bodies of plants are.
    pub poses: Vec<Pose>,
    /// Tables of values that clients have and no signal carries.
    pub tables: Vec<ValueTable>,
    /// What PLCs hold in their memories.
    pub memories: Vec<Memory>,
}

impl ClientView {
    /// Forgets what was seen, and is to show these parts; the memory is kept for that.
    pub fn clear(&mut self, parts: Parts) {
        self.parts = parts;
        self.poses.clear();
        self.tables.clear();
        self.memories.clear();
    }
}

/// A table of values, as of a surface, or an array of a program.
#[derive(Clone, Debug, PartialEq)]
pub struct ValueTable {
    pub client: ClientName,
    pub name: std::sync::Arc<str>,
    /// Values of a row.
    pub columns: usize,
    /// Where the first column begins and the last one ends, in the client's own unit.
    pub across: [f64; 2],
    /// Where the first row begins and the last one ends.
    pub down: [f64; 2],
    pub values: Vec<f64>,
}

/// What a PLC holds between two scans. Where its variables lie, whoever has compiled its program knows.
#[derive(Clone, Debug, PartialEq)]
pub struct Memory {
    pub client: ClientName,
    pub bytes: Vec<u8>,
    /// The paths of the variables that are forced.
    pub forced: Vec<String>,
    /// A byte for each place of the program that notes whether it has been executed, 0 if not; empty if none does.
    pub executed: Vec<u8>,
}

/// Where a body is: its origin, m, and its orientation, a unit quaternion with the scalar last.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    pub body: std::sync::Arc<str>,
    /// Its origin in world coordinates, m; not a number while it is out of the world.
    pub position_m: [f64; 3],
    /// x, y, z, w of a quaternion of length 1.
    pub rotation_xyzw: [f64; 4],
}

/// Why a state cannot be saved or taken back.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum StateError {
    /// The client says why it does not; it goes on.
    #[error("it does not: {0}")]
    Refused(ClientFault),
    /// The client is lost: it is gone, or has broken the protocol.
    #[error("{0}")]
    Lost(FailureCause),
    /// The client has no state that can be saved.
    #[error("this client cannot save its state")]
    Unsupported,
    /// The bytes are not a state of this client.
    #[error("not a state of this client: {0}")]
    Corrupt(String),
}
