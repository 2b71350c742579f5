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
    /// After how long the control told of it.
    pub told_after_ns: Option<u64>,
    /// Whether the machine was safe; absent if the campaign does not say what that means.
    pub safe: Option<bool>,
    /// Whether something came to harm; absent if the campaign does not say what that means.
    pub collision: Option<bool>,
    /// How often each alarm of the scenario's `[report]` came, of those that did.
    pub alarms: BTreeMap<String, u64>,
    /// A hash of the trajectory of each readout.
    pub readouts: Vec<String>,
}

/// A failure that ended a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Failure {
    /// What happened, as people are told, without its place.
    pub text: String,
    /// True if it is of a PLC.
    pub of_plc: bool,
    /// Where in the PLC's sources.
    pub place: Option<SourcePlace>,
}
