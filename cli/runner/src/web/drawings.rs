//! Drawings of PLCs: ladders, function blocks and charts as they are laid out, and the values of their states.

use std::collections::{BTreeMap, BTreeSet};

use onescan_base::regular;
use onescan_iec::input::layout::{self, Language, Sheet};
use onescan_iec_run::{Application, Variable};
use onescan_scenario::{Scenario, ScenarioError};
use onescan_server::published::SessionView;
use onescan_server::signal::ClientName;
use schemars::JsonSchema;
use serde::Serialize;

use super::error::Refused;

/// Most instances of a unit that can be chosen.
const INSTANCES_MAX: usize = 500;

/// A body of a unit that is drawn, as it is laid out in its file.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(extend("x-check" = "drawing"))]
pub(super) struct Drawing {
    path: String,
    unit: String,
    part: Option<String>,
    language: DrawingLanguage,
    elements: Vec<Element>,
    wires: Vec<Wire>,
    /// What there is of its unit.
    instances: Vec<Instance>,
    /// The paths of all states within the unit, in the order of their values.
    states: Vec<String>,
}

/// How a body is drawn.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
enum DrawingLanguage {
    Ladder,
    Blocks,
    Chart,
}

#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "DrawingElement")]
struct Element {
    id: String,
    kind: String,
    #[schemars(default)]
    text: String,
    instance: Option<String>,
    /// The path of the variable that is its state, within the unit.
    state: Option<String>,
    #[schemars(default)]
    marks: Vec<&'static str>,
    at: [f64; 2],
    size: [f64; 2],
    pins: Vec<Pin>,
    line: u32,
}

#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "DrawingPin")]
struct Pin {
    #[schemars(default)]
    name: String,
    #[schemars(default)]
    output: bool,
    #[schemars(default)]
    marks: Vec<&'static str>,
    /// The path of the variable that it gives, within the unit.
    state: Option<String>,
    at: [f64; 2],
}

/// From an output to an input, each an element and one of its pins.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "DrawingWire")]
struct Wire {
    from: [usize; 2],
    to: [usize; 2],
    points: Vec<[f64; 2]>,
    line: u32,
}

#[derive(Debug, Serialize, JsonSchema)]
struct Instance {
    client: String,
    path: String,
}

/// By drawing and instance: where the values of its states lie.
#[derive(Debug, Default)]
pub(super) struct States(Vec<Vec<Places>>);

/// Where the values of an instance's states lie in the memory of its PLC; nothing for what is not a variable.
#[derive(Debug)]
struct Places {
    client: ClientName,
    variables: Vec<Option<Variable>>,
}

/// All drawings of the scenario's soft PLCs.
///
/// # Errors
/// A program that does not compile any more.
pub(super) fn of(scenario: &Scenario) -> Result<(Vec<Drawing>, States), ScenarioError> {
    let (mut drawings, mut states) = (Vec::new(), States::default());
    for plc in scenario.plcs() {
        let drawn: Vec<&String> =
            plc.sources.iter().filter(|path| path.to_ascii_lowercase().ends_with("xml")).collect();
        if drawn.is_empty() {
            continue;
        }
        let Some(compiled) = scenario.compiled_plc(plc.name)? else { continue };
        let instances = instances(&compiled.application);
        for path in drawn {
            // it has just been compiled; what cannot be read any more is not drawn
            let Ok(text) = regular::read_text(&scenario.folder().join(path)) else { continue };
            for sheet in layout::sheets(&text) {
                let known = instances.get(&sheet.unit.to_ascii_uppercase()).cloned().unwrap_or_default();
                let (drawing, places) = drawing(path, sheet, plc.name, &known, &compiled.application);
                drawings.push(drawing);
                states.0.push(places);
            }
        }
    }
    Ok((drawings, states))
}

/// The paths of all instances, by the name of their unit in capitals.
fn instances(application: &Application) -> BTreeMap<String, Vec<String>> {
    let mut prefixes: BTreeSet<String> = BTreeSet::new();
    for leaf in application.leaves() {
        let ends = leaf.path.match_indices('.').map(|(at, _)| at);
        prefixes.extend(ends.filter_map(|end| leaf.path.get(..end)).map(str::to_owned));
    }
    let mut by_unit: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for program in application.programs() {
        by_unit.entry(program.name.to_ascii_uppercase()).or_default().push(program.name.clone());
    }
    for path in prefixes {
        let Ok(variable) = application.variable(&path) else { continue };
        let known = by_unit.entry(variable.type_name.to_ascii_uppercase()).or_default();
        if known.len() < INSTANCES_MAX && !known.contains(&path) {
            known.push(path);
        }
    }
    by_unit
}

fn drawing(
    path: &str,
    sheet: Sheet,
    client: &ClientName,
    instances: &[String],
    application: &Application,
) -> (Drawing, Vec<Places>) {
    let of_elements = sheet.elements.iter().filter_map(|element| element.state.clone());
    let of_pins = sheet.elements.iter().flat_map(|element| &element.pins).filter_map(|pin| pin.state.clone());
    let states: Vec<String> = of_elements.chain(of_pins).collect::<BTreeSet<_>>().into_iter().collect();
    let places = |instance: &String| Places {
        client: client.clone(),
        variables: states.iter().map(|state| variable(application, instance, state)).collect(),
    };
    let all = instances.iter().map(places).collect();
    let Sheet { unit, part, language, elements, wires } = sheet;
    let drawing = Drawing {
        path: path.to_owned(),
        unit,
        part,
        language: match language {
            Language::Ladder => DrawingLanguage::Ladder,
            Language::Blocks => DrawingLanguage::Blocks,
            Language::Chart => DrawingLanguage::Chart,
        },
        elements: elements.into_iter().map(element).collect(),
        wires: wires
            .into_iter()
            .map(|layout::Wire { from, to, points, line }| Wire { from, to, points, line })
            .collect(),
        instances: instances.iter().map(|path| Instance { client: client.to_string(), path: path.clone() }).collect(),
        states,
    };
    (drawing, all)
}

/// A variable of an instance, or a global one.
fn variable(application: &Application, instance: &str, state: &str) -> Option<Variable> {
    application.variable(&format!("{instance}.{state}")).or_else(|_| application.variable(state)).ok()
}

fn element(element: layout::Element) -> Element {
    let layout::Element { id, kind, text, instance, state, marks, at, size, pins, line } = element;
    let pin = |layout::Pin { name, is_output, marks, state, at }| Pin { name, output: is_output, marks, state, at };
    Element { id, kind, text, instance, state, marks, at, size, pins: pins.into_iter().map(pin).collect(), line }
}

impl States {
    /// A drawing and its instance, if there are such.
    pub(super) fn check(&self, drawing: usize, instance: usize) -> Result<(usize, usize), Refused> {
        let found = self.0.get(drawing).and_then(|instances| instances.get(instance));
        found.map(|_| (drawing, instance)).ok_or(Refused::NoDrawing(drawing))
    }

    /// The values of the states of an instance in a view, in the order of the drawing's states.
    pub(super) fn values(&self, (drawing, instance): (usize, usize), view: &SessionView) -> Vec<Option<f64>> {
        let Some(places) = self.0.get(drawing).and_then(|instances| instances.get(instance)) else { return Vec::new() };
        let memory = view.clients.memories.iter().find(|memory| memory.client == places.client);
        let bytes = memory.map_or(&[][..], |memory| memory.bytes.as_slice());
        places.variables.iter().map(|variable| variable.as_ref().and_then(|variable| number(variable, bytes))).collect()
    }
}

/// A variable as a number.
fn number(variable: &Variable, memory: &[u8]) -> Option<f64> {
    let start = usize::try_from(variable.offset).ok()?;
    let bytes = memory.get(start..start.checked_add(usize::try_from(variable.size).ok()?)?)?;
    match (variable.bit, bytes) {
        (Some(bit), [byte, ..]) => Some(f64::from(byte >> bit & 1)),
        _ => variable.signal_type?.as_f64(bytes).filter(|number| number.is_finite()),
    }
}
