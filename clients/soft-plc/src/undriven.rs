//! Inputs of a PLC that nobody drives: no signal goes to them, and nothing in the program gives them a value.

use std::collections::BTreeSet;

use onescan_base::nearest;
use onescan_iec::diagnostic::{Code, Diagnostic};
use onescan_iec_run::{Application, MemorySet, OpenInput, Variable};
use onescan_server::signal::{SignalDecl, SignalName};

use crate::bind::{Bindings, Bound};

/// A warning at the declaration of each input of `application` to which no signal goes, which the application itself
/// does not write, and which is none of `others`, the variables that something else than a signal writes. `signals`
/// are those of the session: one of a similar name may be meant.
pub fn undriven(
    application: &Application,
    bindings: &Bindings,
    signals: &[SignalDecl],
    others: &[Variable],
) -> Vec<Diagnostic> {
    let (foreign, driven) = (Foreign::of(bindings, signals), driven(bindings, others));
    let mut found = Vec::new();
    for mut input in application.open_inputs() {
        input.parts.retain(|part| !driven.meets_variable(part));
        if !input.parts.is_empty() {
            found.push(warning(application, &input, &foreign));
        }
    }
    found
}

/// Signals that others write.
struct Foreign<'a> {
    /// Those that the PLC does not read, which are the likelier to be meant.
    unread: Vec<&'a str>,
    read: Vec<&'a str>,
}

impl<'a> Foreign<'a> {
    fn of(bindings: &'a Bindings, signals: &'a [SignalDecl]) -> Self {
        let names =
            |bound: &'a [Bound]| -> BTreeSet<&'a SignalName> { bound.iter().map(|bound| &bound.port.name).collect() };
        let (outputs, inputs) = (names(&bindings.outputs), names(&bindings.inputs));
        let foreign = signals.iter().filter(|signal| !outputs.contains(&signal.name));
        let (read, unread): (Vec<&SignalDecl>, _) = foreign.partition(|signal| inputs.contains(&signal.name));
        let names = |signals: Vec<&'a SignalDecl>| signals.iter().map(|signal| signal.name.as_str()).collect();
        Self { unread: names(unread), read: names(read) }
    }

    fn nearest(&self, name: &str) -> Option<&'a str> {
        nearest(name, self.unread.iter().copied()).or_else(|| nearest(name, self.read.iter().copied()))
    }
}

/// What signals write, and `others`.
fn driven(bindings: &Bindings, others: &[Variable]) -> MemorySet {
    let mut driven = MemorySet::default();
    for bound in &bindings.inputs {
        let len = bound.port.ty.size();
        bound.places.iter().for_each(|place| driven.insert(place.bytes(len), place.bit));
    }
    for other in others {
        driven.insert_variable(other);
    }
    driven
}

fn warning(application: &Application, input: &OpenInput, foreign: &Foreign<'_>) -> Diagnostic {
    let path = &input.variable.path;
    let message = match (&*input.parts, input.part_count) {
        ([only], 1) => {
            let value = application.value_text(only, application.initial_memory());
            format!("nobody drives the input `{path}`: it stays {value}")
        }
        (parts, count) if parts.len() == count => {
            format!("nobody drives the input `{path}`: its {count} parts stay as they are at the start")
        }
        ([only], _) => {
            let value = application.value_text(only, application.initial_memory());
            format!("nobody drives the input `{}`: it stays {value}", only.path)
        }
        ([first, rest @ ..], count) => {
            let more = rest.len();
            format!("nobody drives `{}` and {more} more of the {count} parts of the input `{path}`", first.path)
        }
        ([], _) => format!("nobody drives the input `{path}`"),
    };
    let name = path.rsplit('.').next().unwrap_or(path);
    let can_be_signal = |part: &Variable| part.signal_type.is_some() && !is_reference(part);
    let help = match foreign.nearest(name) {
        _ if OF_THE_SYSTEM.iter().any(|known| known.eq_ignore_ascii_case(name)) => {
            "the system of the controller sets it before it calls the block; here it keeps its first value".to_owned()
        }
        _ if !input.parts.iter().any(can_be_signal) => {
            let ty = &input.variable.type_name;
            format!(
                "no signal is of type {ty}: give it a value in a unit that calls the program or assigns to its input"
            )
        }
        Some(near) if near.eq_ignore_ascii_case(name) => {
            format!("the signal `{near}` goes elsewhere: name the input under `bind` as well")
        }
        Some(near) => {
            format!("did you mean the signal `{near}`? Give both the same name, or name the input under `bind`")
        }
        None if input.assigned.is_some() => {
            "its own program assigns to it, and nobody else does: declare it under VAR".to_owned()
        }
        None => "declare a signal of its name, or bind one to it under `bind`".to_owned(),
    };
    let found = Diagnostic::warning(Code::UndrivenInput, input.span, message).with_help(help);
    match input.assigned {
        Some(place) => found.with_label(place, "assigned here"),
        None => found,
    }
}

/// Inputs that an S7-1500 gives its organization blocks of the cycle and of the start.
const OF_THE_SYSTEM: [&str; 4] = ["Initial_Call", "Remanence", "LostRetentive", "LostRTC"];

/// True for what refers to another variable, which no signal can name.
fn is_reference(part: &Variable) -> bool {
    ["POINTER TO ", "REFERENCE TO ", "REF_TO "].iter().any(|kind| part.type_name.starts_with(kind))
}
