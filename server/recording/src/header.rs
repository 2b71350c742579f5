//! `recording.json`: what was run, so that it can be run again.

use serde::{Deserialize, Serialize};

use onescan_server::plan::Coupling;
use onescan_server::session::Session;
use onescan_server::signal::{ClientName, SignalDecl, SignalId, SignalName, SignalType};
use onescan_server::time::{StepCount, TimeSpan, VirtualTime};

use super::column::Column;

/// The version of the layout of recordings.
pub const FORMAT: u32 = 1;

/// What the session does not know of itself.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Provenance {
    pub onescan: String,
    pub scenario: String,
    /// The scenario's folder within `scenario/`, empty if it is that itself.
    pub folder: String,
    /// The scenario's file there, if it is not called `scenario.toml`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// The case of it that was tried, if one was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub case: Option<String>,
    /// The clients in whose place people operated.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub operated: Vec<ClientName>,
    pub mode: String,
    /// When the run was to be complete.
    #[serde(rename = "until_ns")]
    pub until: VirtualTime,
    /// What noise, jitter and other chance began with.
    pub seed: u64,
    pub files: Vec<SourceFile>,
}

/// A file of the scenario as it was when the run began.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SourceFile {
    /// Its path within `scenario/`; an absolute path for a file that is not copied there.
    pub path: String,
    /// The BLAKE3 hash of its bytes, hexadecimal.
    pub blake3: String,
}

impl SourceFile {
    /// The file at `path` with these bytes.
    pub fn new(path: String, bytes: &[u8]) -> Self {
        Self { path, blake3: blake3::hash(bytes).to_hex().to_string() }
    }
}

/// A signal of a recorded session.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct HeaderSignal {
    pub name: SignalName,
    #[serde(rename = "type")]
    pub ty: SignalType,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub writer: Option<ClientName>,
    /// False if the digests hold it and the trajectory does not.
    pub recorded: bool,
}

/// The whole file. It says nothing of the wall clock: equal runs have equal headers.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Header {
    /// Version of the layout.
    pub recording: u32,
    #[serde(flatten)]
    pub provenance: Provenance,
    /// The step of virtual time.
    #[serde(rename = "step_ns")]
    pub step: TimeSpan,
    /// How clients saw each other within a step.
    pub coupling: Coupling<ClientName>,
    /// The clients by name.
    pub clients: Vec<ClientName>,
    /// All signals of the session by name.
    pub signals: Vec<HeaderSignal>,
    /// The first step recorded: 0, or that of the checkpoint that was gone on from.
    pub first_step: StepCount,
}

impl Header {
    pub(super) fn new(session: &Session, provenance: &Provenance, columns: &[Column]) -> Self {
        let plan = session.plan();
        let signal = |(id, signal): (SignalId, &SignalDecl)| HeaderSignal {
            name: signal.name.clone(),
            ty: signal.ty,
            unit: signal.unit.clone(),
            writer: session.writer(id).cloned(),
            recorded: columns.iter().any(|column| column.name == signal.name),
        };
        let coupling = match plan.coupling() {
            Coupling::Parallel => Coupling::Parallel,
            Coupling::Sequential { order } => {
                Coupling::Sequential { order: order.iter().map(|id| plan.clients()[id.index()].clone()).collect() }
            }
        };
        Self {
            recording: FORMAT,
            provenance: provenance.clone(),
            step: plan.step(),
            coupling,
            clients: plan.clients().to_vec(),
            signals: session.layout().signals().zip(plan.signals()).map(signal).collect(),
            first_step: session.cycle().steps(),
        }
    }
}
