//! A component of a checked scene: plain data.

use onescan_server::signal::SignalName;
use serde::Serialize;

use super::kind::Setting;
use super::origin::Origin;
use crate::model::{Bound, NumberType};

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Component {
    pub name: String,
    /// Its kind, one of the library's or of the user's own.
    pub kind: Origin,
    /// A digest of the kind's source, if it is of the user's own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub code: Option<String>,
    /// Its settings, one for each parameter of its kind.
    pub settings: Vec<Setting>,
    /// What of the world it is bound to.
    pub bound: Bound,
    /// Where its inputs come from, one for each of its kind.
    pub inputs: Vec<Wire>,
    /// Where its outputs go to, one for each of its kind.
    pub outputs: Vec<Option<SignalName>>,
    /// Type of its number signals.
    pub number: NumberType,
    /// Bytes in the windows of the signals that are lines.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub window: Option<u16>,
    /// Where pictures show it, m, in world coordinates, if nothing that it is bound to says so. The plant does not depend on it.
    #[serde(skip)]
    pub shown_at_m: Option<[f64; 3]>,
    /// How and when it fails.
    pub failures: Vec<FailureSwitch>,
}

/// Where an input comes from.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Wire {
    /// Nowhere: it keeps the value that its kind gives it.
    Open,
    /// The scene itself: a constant.
    Constant(Setting),
    /// A signal of the session.
    Signal(SignalName),
    /// An output of a component, both by index.
    Output { component: usize, output: usize },
}

/// When a component fails in one way.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FailureSwitch {
    /// Index of the mode among those of its kind.
    pub mode: usize,
    pub when: When,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum When {
    /// While a BOOL signal is true.
    Signal(SignalName),
    /// Between two virtual times.
    Between(Between),
}

/// From one virtual time on, until another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Between {
    /// From here on, ns.
    pub from_ns: u64,
    /// Up to here, not included, ns.
    pub until_ns: u64,
}

/// The inputs of a component that are of use and that nobody drives, each with what it is all the time.
pub fn open_inputs(component: &Component) -> Vec<(&str, Setting)> {
    let inputs = component.kind.inputs.iter().zip(&component.inputs).enumerate();
    let open = inputs.filter(|(at, (_, wire))| **wire == Wire::Open && component.kind.uses(&component.settings, *at));
    open.filter_map(|(_, (input, _))| Some((&*input.key, input.preset?))).collect()
}
