//! What a page asks, and what the session is to do for it.

use onescan_server::layout::ImageLayout;
use onescan_server::operation::{Operation, SignalFault};
use onescan_server::signal::{ClientName, SignalDecl, SignalId, SignalName, SignalType};
use onescan_server::time::VirtualTime;
use schemars::JsonSchema;
use serde::Deserialize;

use super::error::Refused;
use super::known::Known;
use super::online::Action;
use super::training::{AtWork, Training, Turn};

/// The longest time for which an alarm may be put aside, s.
const SHELF_S_MAX: f64 = 86_400.0;

/// What the page asks.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "lowercase", deny_unknown_fields)]
pub(super) enum Ask {
    /// The signals that pictures have from now on; the next picture has all of them.
    Subscribe { signals: Vec<usize> },
    /// An operator's input at the next step boundary.
    Write { signal: usize, value: f64 },
    /// Holds virtual time, lets it go on, makes one step; or ends the session.
    Operate { operation: Verb },
    /// Resets the session at the next step boundary, by a key of this panel.
    Reset { panel: String },
    /// Takes or leaves a seat.
    Seat { panel: String, take: bool },
    /// Fails a component, or repairs it.
    Fail { component: String, failure: String, active: bool },
    /// Begins a fault on the way of signals, or ends it; all of its signals at one boundary. It is named by its number on the
    /// panels.
    Disturb { disturbance: usize, active: bool },
    /// How the lesson continues, on the trainer's page: from its start, from an earlier moment, or from a prepared state.
    Train(TrainAsk),
    /// Shows this viewer a moment of the past: the last step at or before it. What it asked for before counts no more.
    Show { t_ns: f64 },
    /// Shows a view of the scenario to all viewers; from a trainer's seat where there is one, of a lesson on the trainer's page.
    View { view: String },
    /// The values of a drawing's instance from now on; `null` for none.
    Draw { drawing: Option<usize>, instance: usize },
    /// The PLCs' own variables that `variables` has from now on.
    Watch { variables: Vec<usize> },
    /// These maps from now on.
    Maps { maps: Vec<usize> },
    /// Writes, forces or releases a variable of a PLC; the value is a literal of the variable's type.
    Variable { variable: usize, action: Action, value: String },
    /// Forces a signal; releases it without a value.
    Force { signal: usize, value: Option<String> },
    /// Acknowledges these alarms, for all viewers.
    Acknowledge { alarms: Vec<usize> },
    /// Puts an alarm aside for so long in virtual time, for all viewers; takes it back without a time.
    Shelve { alarm: usize, for_s: Option<f64> },
    /// A parameter of a component takes another value; that of the scene again without one.
    Parameter { component: String, parameter: String, value: Option<String> },
    /// What operators have done so far, as a case of this name; `save` writes it into the scenario's file of cases.
    Case { name: String, save: bool },
    /// What signals did in a span of the past, in so many parts: of each the first, the least, the greatest and the last value.
    Trace { signals: Vec<usize>, from_ns: f64, until_ns: f64, parts: u32 },
    /// Shows this viewer the live edge again.
    Live,
    /// Starts a session from a moment of the past, beside this one; it ends as this one does, or at `until_ns`.
    Fork {
        t_ns: f64,
        #[serde(default)]
        until_ns: Option<f64>,
    },
}

/// How a lesson continues.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(tag = "turn", rename_all = "lowercase", deny_unknown_fields)]
pub(super) enum TrainAsk {
    Repeat,
    Back { t_ns: f64 },
    Jump { start: String },
}

/// What is done with virtual time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum Verb {
    Hold,
    Go,
    Step,
    Stop,
}

impl Ask {
    /// Reads a message.
    pub(super) fn read(text: &str) -> Result<Self, Refused> {
        serde_json::from_str(text).map_err(|error| Refused::Garbage(error.to_string()))
    }
}

/// The signals of these places.
pub(super) fn signals(places: &[usize], layout: &ImageLayout) -> Result<Vec<SignalId>, Refused> {
    let all: Vec<SignalId> = layout.signals().collect();
    places.iter().map(|place| all.get(*place).copied().ok_or(Refused::NoSignal(*place))).collect()
}

/// People write this signal.
pub(super) fn writer(declared: &SignalDecl, known: &Known) -> Result<(), Refused> {
    match declared.writer.as_ref().filter(|writer| !known.operators.contains(*writer)) {
        Some(writer) => Err(Refused::Writer { signal: declared.name.to_string(), writer: writer.to_string() }),
        None => Ok(()),
    }
}

/// A signal takes a value.
pub(super) fn write(declared: &SignalDecl, value: f64, known: &Known) -> Result<Operation, Refused> {
    writer(declared, known)?;
    let wrong = || Refused::Value { signal: declared.name.to_string(), ty: declared.ty, value: value.to_string() };
    let text = match declared.ty {
        SignalType::BOOL if value == 0.0 || value == 1.0 => if value == 1.0 { "TRUE" } else { "FALSE" }.to_owned(),
        SignalType::BOOL => return Err(wrong()),
        _ if !value.is_finite() => return Err(wrong()),
        _ => value.to_string(),
    };
    declared.ty.parse_text(&text).map_err(|_| wrong())?;
    Ok(Operation::Write { signal: declared.name.clone(), value: text })
}

/// What whoever resets a session has to know of PLCs that the link cannot start; nothing if there are none.
pub(super) fn start_by_hand(plcs: &[ClientName]) -> Option<String> {
    let names: Vec<String> = plcs.iter().map(|name| format!("`{name}`")).collect();
    (!names.is_empty()).then(|| {
        let names = names.join(", ");
        format!("the session begins again when the PLC of client {names} has: start it cold now, if it does not start itself")
    })
}

/// A signal is forced, or released without a value. Whether the text is a value of its type, the session says.
pub(super) fn force(declared: &SignalDecl, value: Option<String>) -> Operation {
    let signal = declared.name.clone();
    match value {
        Some(value) => Operation::Force { signal, value },
        None => Operation::Release { signal },
    }
}

/// A component fails, or is repaired. Whether it has that mode, the plant says.
pub(super) fn fail(component: String, mode: String, active: bool, known: &Known) -> Result<Operation, Refused> {
    let client = known.plants.get(&component).ok_or_else(|| Refused::NoComponent(component.clone()))?.clone();
    Ok(if active { Operation::Fail { client, component, mode } } else { Operation::Repair { client, component, mode } })
}

/// A parameter takes another value, or the scene's again. Whether the component has it and takes that, the plant says.
pub(super) fn parameter(
    component: String,
    parameter: String,
    value: Option<String>,
    known: &Known,
) -> Result<Operation, Refused> {
    let client = known.plants.get(&component).ok_or_else(|| Refused::NoComponent(component.clone()))?.clone();
    Ok(match value {
        Some(value) => Operation::ChangeParameter { client, component, parameter, value },
        None => Operation::RestoreParameter { client, component, parameter },
    })
}

/// A fault on the way of signals begins, or ends where it is at work.
pub(super) fn disturb(number: usize, active: bool, known: &Known, now: &AtWork) -> Result<Vec<Operation>, Refused> {
    let disturbance = known.disturbances.get(number).ok_or(Refused::NoDisturbance(number))?;
    let begun = disturbance.iter().filter(|(signal, fault)| active || now.has(signal, fault));
    let operation = |(signal, fault): &(SignalName, SignalFault)| {
        let (signal, fault) = (signal.clone(), fault.clone());
        if active { Operation::Disturb { signal, fault } } else { Operation::Mend { signal } }
    };
    Ok(begun.map(operation).collect())
}

/// Alarms that there are.
pub(super) fn alarms(alarms: Vec<usize>, known: &Known) -> Result<Vec<usize>, Refused> {
    match alarms.iter().find(|alarm| **alarm >= known.alarms) {
        Some(unknown) => Err(Refused::NoAlarm(*unknown)),
        None => Ok(alarms),
    }
}

/// How long an alarm is put aside, in nanoseconds.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most a day, and positive")]
pub(super) fn shelf_ns(for_s: f64) -> Result<u64, Refused> {
    if !(for_s > 0.0 && for_s <= SHELF_S_MAX) {
        return Err(Refused::NoShelf(for_s.to_string()));
    }
    Ok((for_s * 1e9) as u64)
}

/// How the lesson goes on.
pub(super) fn turn(asked: TrainAsk, training: &Training) -> Result<Turn, Refused> {
    match asked {
        TrainAsk::Repeat => Ok(Turn::Repeat),
        TrainAsk::Back { t_ns } => Ok(Turn::Back(past(t_ns))),
        TrainAsk::Jump { start } if training.starts.contains(&start) => Ok(Turn::Jump(start)),
        TrainAsk::Jump { start } => Err(Refused::NoStart(start)),
    }
}

/// A time as a page has it: what is before the start is the start.
fn past(t_ns: f64) -> VirtualTime {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates, and a time has no sign")]
    VirtualTime::from_nanos(t_ns.max(0.0) as u64)
}

impl From<Verb> for Operation {
    fn from(verb: Verb) -> Self {
        match verb {
            Verb::Hold => Self::Pause,
            Verb::Go => Self::Resume,
            Verb::Step => Self::Step,
            Verb::Stop => Self::Stop,
        }
    }
}
