//! What a process says of its run, as JSON on its standard output.

use std::collections::BTreeMap;

use onescan_server::client::SourcePlace;
use serde::{Deserialize, Serialize};

/// What was read out of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Reading {
    /// The digest over all steps.
    pub digest: Option<String>,
    /// Virtual time of the last of them.
    pub virtual_time_ns: u64,
    /// The failure that ended it.
    pub failure: Option<Failure>,
    /// The first image with the fault.
    pub activated_ns: Option<u64>,
    /// After how long the control detected it.
    #[serde(alias = "told_after_ns")]
    pub detected_after_ns: Option<u64>,
    /// Whether the machine was safe; absent if the campaign does not say what that means.
    pub safe: Option<bool>,
    /// Whether something came to harm; absent if the campaign does not say what that means.
    pub collision: Option<bool>,
    /// How often each alarm of the scenario's `[report]` came from the fault on, of those that did.
    pub alarms: BTreeMap<String, u64>,
    /// A hash of the trajectory of each readout.
    pub readouts: Vec<String>,
    /// A hash of its state at the end; nothing if it failed before, or if a client cannot save its state.
    #[serde(default)]
    pub state: Option<String>,
    /// Where it was in the state of the run without faults again, so that the rest was read out of that one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joined_ns: Option<u64>,
    /// Why its run came to no end, if it did not: nothing else is known of it then.
    #[serde(default)]
    pub unfinished: Option<String>,
}

/// What the process of the runs without faults says: what was read out of each, and where the cases fork from it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BaseRuns {
    /// What was read out of the run of each variant.
    pub readings: Vec<Reading>,
    /// Where the run of each case begins, in the order of the campaign's cases.
    pub ways: Vec<Way>,
}

/// Where the run of a case begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Way {
    /// At the start, as that of any case.
    Start,
    /// At the checkpoint of this virtual time, in nanoseconds, of the run without faults.
    Fork(u64),
    /// Nowhere: the condition of its fault does not come true, so it is the run without faults.
    Never,
}

/// A failure that ended a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Failure {
    /// What happened, as it is reported, without its place.
    pub text: String,
    /// True if it is of a PLC.
    pub of_plc: bool,
    /// Where in the PLC's sources.
    pub place: Option<SourcePlace>,
}
