//! The ends of connections: what of each client can be connected, and by what it is written.

use onescan_iec_run::{Application, Variable};
use onescan_plant::Scene;
use onescan_plant::component::kind::Values;
use onescan_plant::scene::model::Wire;
use schemars::JsonSchema;
use serde::Serialize;
use toml_edit::Item;

use super::change::Sort;
use super::document::Document;
use crate::wiring::Map;

/// Where a connection can begin or end.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct End {
    /// The client.
    pub client: String,
    /// What it is there: an input or output of a component, a variable.
    pub at: String,
    /// Its type.
    #[serde(rename = "type")]
    pub ty: String,
    /// Whether it writes.
    pub gives: bool,
    /// The signals that it is connected to.
    pub signals: Vec<String>,
    /// What says so.
    pub hand: Hand,
}

/// What is written to connect an end.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Hand {
    /// A key of a table of a scene.
    Key {
        /// The file.
        scene: String,
        /// The sort of the table.
        sort: Sort,
        /// Its name.
        name: String,
        /// The key.
        key: String,
    },
    /// A line of `bind`.
    Variable {
        /// Its path.
        path: String,
    },
    /// Nothing that the editor writes: an element of an array, a part of a kind of the user's own.
    Fixed,
}

/// The ends of a plant.
pub(super) fn of_plant(client: &str, file: &str, scene: &Scene, document: &Document<'_>) -> Vec<End> {
    let mut ends = Vec::new();
    let end = |at: String, ty: String, gives: bool, signals: Vec<String>, hand: Hand| End {
        client: client.to_owned(),
        at,
        ty,
        gives,
        signals,
        hand,
    };
    let table = |sort: Sort, name: &str| {
        document.tables(sort.key()).find(|table| table.get("name").and_then(Item::as_str) == Some(name))
    };
    let hand = |sort: Sort, name: &str, key: String| match table(sort, name) {
        Some(_) => Hand::Key { scene: file.to_owned(), sort, name: name.to_owned(), key },
        None => Hand::Fixed,
    };
    let ports = || scene.reads.iter().chain(&scene.writes);
    let type_of = |signal: &str| ports().find(|port| port.name.as_str() == signal).map(|port| port.ty.to_string());
    for component in &scene.components {
        let name = &component.name;
        let is_real = table(Sort::Component, name)
            .and_then(|table| table.get("signal_type"))
            .is_some_and(|ty| ty.as_str() == Some("REAL"));
        let ty =
            |values: Values| if is_real && values == Values::Number { "REAL".to_owned() } else { values.to_string() };
        for (input, wire) in component.kind.inputs.iter().zip(&component.inputs) {
            let signals = match wire {
                Wire::Signal(signal) => vec![signal.to_string()],
                Wire::Open => Vec::new(),
                Wire::Constant(_) | Wire::Output { .. } => continue,
            };
            let key = format!("{}_signal", input.key);
            ends.push(end(
                format!("{name}.{}", input.key),
                ty(input.values),
                false,
                signals,
                hand(Sort::Component, name, key),
            ));
        }
        for (output, signal) in component.kind.outputs.iter().zip(&component.outputs) {
            let signals = signal.iter().map(ToString::to_string).collect();
            let key = format!("{}_signal", output.key);
            ends.push(end(
                format!("{name}.{}", output.key),
                ty(output.values),
                true,
                signals,
                hand(Sort::Component, name, key),
            ));
        }
    }
    for sort in [Sort::Axis, Sort::Sensor] {
        for table in document.tables(sort.key()) {
            let name = table.get("name").and_then(Item::as_str).unwrap_or_default();
            for (key, signal) in table.iter().filter_map(|(key, item)| Some((key, item.as_str()?))) {
                // what a sensor has is its only one
                let part = if key == "signal" { Some("") } else { key.strip_suffix("_signal") };
                let (Some(part), Some(ty)) = (part, type_of(signal)) else { continue };
                let at = if part.is_empty() { name.to_owned() } else { format!("{name}.{part}") };
                let gives = scene.writes.iter().any(|port| port.name.as_str() == signal);
                ends.push(end(at, ty, gives, vec![signal.to_owned()], hand(sort, name, key.to_owned())));
            }
        }
    }
    ends
}

/// The ends of a soft PLC: what its programs take in and give out.
pub(super) fn of_plc(client: &str, application: &Application) -> Vec<End> {
    let end = |variable: Variable, gives: bool| {
        let ty = variable.signal_type?.to_string();
        let (client, hand) = (client.to_owned(), Hand::Variable { path: variable.path.clone() });
        Some(End { client, at: variable.path, ty, gives, signals: Vec::new(), hand })
    };
    let mut ends = Vec::new();
    for program in application.programs() {
        ends.extend(program.inputs.into_iter().filter_map(|variable| end(variable, false)));
        ends.extend(program.outputs.into_iter().filter_map(|variable| end(variable, true)));
    }
    ends
}

/// What the map knows of the ends: their signals, and ends that are connected by a path.
pub(super) fn connect(ends: &mut Vec<End>, map: &Map) {
    let is_plc = |client: &str| map.clients.iter().any(|member| member.name == client && member.kind == "soft-plc");
    for signal in &map.signals {
        let hooks = std::iter::once((&signal.writer, true)).chain(signal.readers.iter().map(|hook| (hook, false)));
        for (hook, gives) in hooks {
            for at in &hook.at {
                match ends.iter_mut().find(|end| end.client == hook.client && end.at == *at) {
                    Some(end) if end.signals.contains(&signal.name) => {}
                    Some(end) => end.signals.push(signal.name.clone()),
                    None => ends.push(End {
                        client: hook.client.clone(),
                        at: at.clone(),
                        ty: signal.ty.clone(),
                        gives,
                        signals: vec![signal.name.clone()],
                        hand: if is_plc(&hook.client) { Hand::Variable { path: at.clone() } } else { Hand::Fixed },
                    }),
                }
            }
        }
    }
}
