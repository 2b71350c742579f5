//! Checked components, failures and conditions of signals: plain data, part of [`super::model`].

use onescan_server::signal::{SignalName, SignalType};
use serde::Serialize;

use super::format::NumberType;
use crate::component::kind::Setting;
use crate::component::origin::Origin;

/// One component.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Component {
    /// Its name.
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
    /// How and when it fails.
    pub failures: Vec<FailureSwitch>,
}

/// What of the world a component is bound to: what its coupling's keys name, and nothing else.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Bound {
    /// What it drives; nothing else in the scene does.
    pub drives: Option<Driven>,
    /// Index of the joint that it measures.
    pub measures: Option<usize>,
    /// Index of the body that carries it, is touched or gives the place; none for the ground.
    pub body: Option<usize>,
    /// Index of the only shape of the body that counts, all if none.
    pub shape: Option<usize>,
    /// Where it begins.
    pub point_m: Option<[f64; 3]>,
    /// Unit vector along which it points or runs.
    pub direction: Option<[f64; 3]>,
    /// Indices of the bodies that it sees, holds or places.
    pub targets: Vec<usize>,
}

/// What one axis or component alone drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Driven {
    /// The joint of this index.
    Joint(usize),
    /// The surface of the kinematic body of this index.
    Belt(usize),
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
    Output {
        /// The component.
        component: usize,
        /// Its output.
        output: usize,
    },
}

/// When a component fails in one way.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FailureSwitch {
    /// Index of the mode among those of its kind.
    pub mode: usize,
    /// When.
    pub when: When,
}

/// When something fails.
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

/// What happens to a signal between the plant and the session.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Condition {
    /// The signal.
    pub signal: SignalName,
    /// Its type inside of the plant; the session's is that of its port.
    pub inner: SignalType,
    /// What part of it is which raw value; as it is if none.
    pub scale: Option<Range>,
    /// Later by so much, ns.
    pub delay_ns: u64,
    /// And by up to so much more, ns.
    pub jitter_ns: u64,
    /// And by a time from N(0, σ) with this σ, ns.
    pub delay_sigma_ns: u64,
    /// Looked at so often, ns; in every period if 0.
    pub sample_ns: u64,
    /// Rounded to a multiple of this; not if 0.
    pub quantum: f64,
    /// Mean of the noise.
    pub noise_mean: f64,
    /// Standard deviation of the noise.
    pub noise_sigma: f64,
    /// How probable it is that a change is lost.
    pub lost_rate: f64,
    /// How probable it is, in each turn, that a bit arrives inverted.
    pub flip_rate: f64,
}

/// A range in a signal's unit, and the raw values of its ends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Range {
    /// In the signal's unit.
    pub range: [f64; 2],
    /// Raw.
    pub raw: [f64; 2],
}
