//! Join and control messages. Each is one JSON object with one key, its kind.

use std::collections::BTreeMap;

use onescan_base::foreign::deserialize_line;
use serde::{Deserialize, Serialize};

use super::VersionRange;
use crate::client::{ClientFault, ClientOperation, JoinRequest, OperationRefused};
use crate::end::SessionEnd;
use crate::operation::{Control, Operation};
use crate::signal::{PortLayout, SignalDecl, SignalName, SignalType};
use crate::state::ServerState;
use crate::time::{StepCount, TimeSpan, VirtualTime};

/// What somebody who connects wants to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Role {
    /// A client of the session.
    Client,
    /// Somebody who watches and controls it.
    Operator,
}

/// From a client or operator to the server.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum ClientMessage {
    /// First message of a connection.
    Hello {
        protocol: VersionRange,
        role: Role,
        /// Program and version, for logs.
        #[serde(deserialize_with = "deserialize_line")]
        agent: String,
        /// The token of whoever connects, where the session asks for one.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        token: Option<String>,
    },
    /// Second message of a client.
    Join(JoinRequest),
    /// The client cannot go on.
    Fault(ClientFault),
    /// The state is taken back.
    Restored {},
    /// Answer to `operate` of the server.
    Operated {
        /// Why it was not done; left out if it was.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        refused: Option<OperationRefused>,
    },
    Control(Control),
    /// An operator writes, forces or releases a signal, or wishes as with `control`.
    Operate(Operation),
    /// An operator asks how things are.
    Status {
        /// The signals whose values it wants; left out if none.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        signals: Vec<SignalName>,
    },
}

/// From the server to a client or operator.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum ServerMessage {
    Welcome {
        /// The version spoken from here on.
        protocol: u32,
        /// The server's program and version.
        #[serde(deserialize_with = "deserialize_line")]
        agent: String,
        /// The step of the session.
        #[serde(rename = "step_ns")]
        step: TimeSpan,
        /// Largest frame that the server takes from a joined client, counted as the length field does.
        frame_bytes_max: u32,
        /// All signals of the session.
        signals: Vec<SignalDecl>,
    },
    Joined {
        /// Bytes of the inputs in every grant.
        input_bytes: u32,
        /// Where each input lies in them.
        inputs: Vec<PlacedSignal>,
        /// Bytes of the outputs in every turn.
        output_bytes: u32,
        /// Where each output lies in them.
        outputs: Vec<PlacedSignal>,
    },
    /// Answer to `hello` or `join`; the connection ends.
    Refused {
        /// Why, in one line.
        #[serde(deserialize_with = "deserialize_line")]
        message: String,
    },
    /// Take the initial state; answer with a turn of sequence 0.
    Setup {
        /// What is in force from the initial values on; left out if nothing is.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        operations: Vec<ClientOperation>,
    },
    /// Do this between two turns; answer with `operated`.
    Operate(ClientOperation),
    /// Hand out the state; answer with a state frame.
    Save {},
    /// Take back the state in the frame that follows; answer with `restored`.
    Restore {
        /// Virtual time at which the state was saved.
        #[serde(rename = "t_v_ns")]
        t_v: VirtualTime,
        /// Number of the last step it has seen; the next grant is a later one.
        steps: StepCount,
    },
    /// The session is over.
    End(SessionEnd),
    /// Answer to `status` and to `control`.
    Status(Status),
}

/// One signal of a port with its place.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlacedSignal {
    pub name: SignalName,
    #[serde(rename = "type")]
    pub ty: SignalType,
    pub offset: u32,
    pub size: u32,
}

/// The places of all signals of `layout`.
pub fn placed(layout: &PortLayout) -> Vec<PlacedSignal> {
    debug_assert!(u32::try_from(layout.size()).is_ok(), "a port is smaller than the frame that carries it");
    layout
        .iter()
        .map(|(port, offset)| PlacedSignal {
            name: port.name.clone(),
            ty: port.ty,
            offset: offset as u32,
            size: port.ty.size() as u32,
        })
        .collect()
}

/// How a session is, at a step boundary.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Status {
    pub state: ServerState,
    #[serde(rename = "t_v_ns")]
    pub t_v: VirtualTime,
    pub steps: StepCount,
    /// True while virtual time is held.
    pub held: bool,
    /// The signals that were asked for, as text; left out if none was.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub values: BTreeMap<SignalName, String>,
}
