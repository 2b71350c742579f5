//! What of a session does not change while it runs, as the page reads it.

use std::collections::{BTreeMap, BTreeSet};

use onescan_base::regular;
use onescan_plant::component::kind::{self, unit};
use onescan_plant::scene::model::{BodyKind, Component, Wire};
use onescan_plant::{Form, Frame, Geometry, Scene};
use onescan_scenario::file::{ClientFile, SignalFile};
use onescan_scenario::map_file::MapFile;
use onescan_scenario::panel_picture::PanelPicture;
use onescan_scenario::{Scenario, ScenarioError};
use onescan_server::operation::SignalFault;
use onescan_server::signal::{ClientName, SignalDecl, SignalName};
use serde::Serialize;

use super::alarms::Bell;
use super::desk::{AtWork, Role, Training};
use super::drawings::{self, Drawing, States};
use super::looks::{self, Judge, Look, View};
use super::maps::{self, Map};
use super::online::{self, Online};
use super::panel::{self, Panel};
use super::picture::Stage;

/// The version of the protocol, `web/PROTOCOL.md`.
const PROTOCOL: u32 = 1;
/// The largest source that is shown, bytes.
const SOURCE_MAX: usize = 1_000_000;

/// The answer to `GET /api/session`.
#[derive(Debug, Serialize)]
pub(super) struct Structure {
    protocol: u32,
    title: String,
    scenario: String,
    step_ns: u64,
    until_ns: u64,
    pub(super) live: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    training: Option<Lesson>,
    signals: Vec<Signal>,
    bodies: Vec<Body>,
    components: Vec<Part>,
    views: Vec<View>,
    looks: Vec<Look>,
    panels: Vec<Panel>,
    expectations: Vec<Expectation>,
    sources: Vec<Source>,
    drawings: Vec<Drawing>,
    plcs: Vec<online::Plc>,
    maps: Vec<Map>,
}

/// A lesson, as its page shows it.
#[derive(Debug, Serialize)]
struct Lesson {
    role: Role,
    #[serde(rename = "lesson")]
    name: String,
    about: Option<String>,
    /// Prepared states to jump to; none on the trainee's page.
    starts: Vec<String>,
}

impl Lesson {
    fn of(training: &Training) -> Self {
        let starts = if training.role == Role::Trainer { training.starts.clone() } else { Vec::new() };
        Self { role: training.role, name: training.lesson.clone(), about: training.about.clone(), starts }
    }
}

/// Beside the structure, what the server needs to answer.
#[derive(Debug, Default)]
pub(super) struct Known {
    /// Which of the page's bodies move with which.
    pub(super) stage: Stage,
    /// The plant of each component.
    pub(super) plants: BTreeMap<String, ClientName>,
    /// Clients that are people.
    pub(super) operators: BTreeSet<ClientName>,
    /// The faults on the way of signals that panels begin and end, each with what it does to its signals.
    pub(super) disturbances: Vec<Vec<(SignalName, SignalFault)>>,
    /// Panels that are not on this page.
    pub(super) hidden: BTreeSet<String>,
    /// Where the states of drawings are.
    pub(super) states: States,
    /// Which alarms are on.
    pub(super) bell: Bell,
    /// Which looks are on.
    pub(super) looks: Judge,
    /// The panels, each with the signals that it writes.
    pub(super) panels: BTreeMap<String, BTreeSet<String>>,
    /// What lies behind them.
    pub(super) pictures: Vec<PanelPicture>,
    /// The PLCs, as they are looked into.
    pub(super) online: Online,
    /// The panels of trainers.
    pub(super) trainers: BTreeSet<String>,
    /// The maps, as the scenario has them.
    pub(super) maps: Vec<MapFile>,
}

impl Known {
    /// The numbers of the panels' disturbances that are at work: all of their signals have them.
    pub(super) fn disturbed(&self, at_work: &AtWork) -> BTreeSet<usize> {
        let is_on = |all: &[(SignalName, SignalFault)]| all.iter().all(|(signal, fault)| at_work.has(signal, fault));
        self.disturbances.iter().enumerate().filter(|(_, all)| is_on(all)).map(|(number, _)| number).collect()
    }
}

#[derive(Debug, Serialize)]
struct Signal {
    name: String,
    #[serde(rename = "type")]
    ty: String,
    writer: String,
    unit: Option<String>,
    about: String,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    names: BTreeMap<String, String>,
}

/// A body, or a shape of one, where the scene has it.
#[derive(Debug, Serialize)]
pub struct Body {
    pub(super) name: String,
    pub(super) kind: &'static str,
    pub(super) shape: Shape,
    pub(super) position_m: [f64; 3],
    pub(super) rotation: [f64; 4],
    /// The body in whose frame it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) on: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) colour: Option<String>,
    #[serde(skip_serializing_if = "is_zero")]
    pub(super) transparent: f64,
}

#[derive(Debug, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub(super) enum Shape {
    None,
    Box { size_m: [f64; 3] },
    Sphere { radius_m: f64 },
    Cylinder { radius_m: f64, length_m: f64 },
    Round { radius_m: f64, top_radius_m: f64, length_m: f64, open: bool },
    Capsule { radius_m: f64, length_m: f64 },
    Mesh { positions_m: Vec<f64>, indices: Vec<u32> },
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde asks for it")]
fn is_zero(share: &f64) -> bool {
    *share == 0.0
}

#[derive(Debug, Serialize)]
pub(super) struct Part {
    pub(super) name: String,
    kind: String,
    pub(super) body: Option<String>,
    signals: Vec<String>,
    senses: Option<String>,
    parameters: Vec<Parameter>,
    failures: Vec<Failure>,
}

#[derive(Debug, Serialize)]
struct Parameter {
    name: String,
    value: String,
    unit: Option<&'static str>,
}

#[derive(Debug, Serialize)]
struct Failure {
    name: String,
}

#[derive(Debug, Serialize)]
struct Expectation {
    name: String,
    text: String,
}

#[derive(Debug, Serialize)]
struct Source {
    path: String,
    text: String,
    lines: Vec<SourceLine>,
}

#[derive(Debug, Serialize)]
struct SourceLine {
    #[serde(rename = "line")]
    number: usize,
    variables: Vec<String>,
    /// Numbers of variables of the PLC.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    inner: Vec<usize>,
}

/// The structure of the scenario's sessions, and what the server needs beside it.
///
/// # Errors
/// A scene that cannot be read; it was read before, so it has just changed.
pub(super) fn of(scenario: &Scenario, training: Option<&Training>) -> Result<(Structure, Known), ScenarioError> {
    let file = scenario.file();
    let mut known = Known::default();
    let (mut bodies, mut components) = (Vec::new(), Vec::new());
    for (name, client) in &file.clients {
        if let ClientFile::Operator { .. } = client.get_ref() {
            known.operators.insert(name.clone());
        }
        if let ClientFile::Plant { scene, .. } = client.get_ref() {
            let scene = scenario.scene_of(name, scene)?;
            add_bodies(&scene, &mut bodies, &mut known.stage);
            for component in &scene.components {
                known.plants.insert(component.name.clone(), name.clone());
                components.push(part(component, &scene));
            }
        }
    }
    let (drawings, states) = drawings::of(scenario)?;
    known.states = states;
    let looks = looks::of(scenario, &mut bodies, &components)?;
    (known.looks, known.bell) = (Judge::of(scenario), Bell::of(scenario));
    known.disturbances = scenario.panel_disturbances()?;
    let (mut panels, pictures) = panel::of(scenario)?;
    known.pictures = pictures;
    known.panels = panels.iter().map(|panel| (panel.name.clone(), panel.written())).collect();
    known.trainers = panels.iter().filter(|panel| panel.is_trainers()).map(|panel| panel.name.clone()).collect();
    let (plcs, looked_into) = Online::of(scenario)?;
    known.online = looked_into;
    known.maps.clone_from(&file.map);
    if let Some(Training { role: role @ Role::Trainee, .. }) = training {
        let hidden = panels.iter().filter(|panel| !role.sees(panel.seat));
        known.hidden = hidden.map(|panel| panel.name.clone()).collect();
        panels.retain(|panel| role.sees(panel.seat));
        for part in &mut components {
            part.failures.clear();
        }
    }
    let structure = Structure {
        protocol: PROTOCOL,
        title: file.title.clone(),
        scenario: scenario.name().to_owned(),
        step_ns: file.step.as_nanos(),
        until_ns: scenario.until().as_nanos(),
        live: true,
        training: training.map(Lesson::of),
        signals: scenario.plan().signals().iter().map(|declared| signal(declared, scenario)).collect(),
        bodies,
        components,
        views: looks::views(scenario),
        looks,
        panels,
        expectations: file
            .expect
            .iter()
            .map(|expect| Expectation { name: expect.name.get_ref().clone(), text: expect.formula.get_ref().clone() })
            .collect(),
        sources: sources(scenario, &known.online),
        plcs,
        maps: maps::of(scenario),
        drawings,
    };
    Ok((structure, known))
}

/// The bodies of a scene, as it is set up.
pub fn bodies_of(scene: &Scene) -> Vec<Body> {
    let mut bodies = Vec::new();
    add_bodies(scene, &mut bodies, &mut Stage::default());
    bodies
}

pub(super) fn written(scenario: &Scenario, declared: &SignalDecl) -> Option<SignalFile> {
    scenario.file().signals.get(&declared.name).map(|signal| signal.get_ref().clone())
}

fn signal(declared: &SignalDecl, scenario: &Scenario) -> Signal {
    let file = written(scenario, declared);
    let names = file.as_ref().map(|file| file.names.pairs()).into_iter().flatten();
    Signal {
        name: declared.name.to_string(),
        ty: declared.ty.to_string(),
        writer: declared.writer.as_ref().map(ToString::to_string).unwrap_or_default(),
        unit: declared.unit.clone(),
        about: file.as_ref().and_then(|file| file.about.clone()).unwrap_or_default(),
        names: names.map(|(value, name)| (value.to_string(), name)).collect(),
    }
}

fn add_bodies(scene: &Scene, bodies: &mut Vec<Body>, stage: &mut Stage) {
    let frames: Vec<Frame> = scene.frames().collect();
    for form in scene.forms() {
        let number = u32::try_from(bodies.len()).unwrap_or(u32::MAX);
        if form.kind != BodyKind::Fixed {
            stage.follow(form.body, number, form.within);
        }
        let place = form.within.seen_from(frames[form.index]);
        let Form { body, attached, kind, geometry, .. } = form;
        bodies.push(Body {
            name: attached.map_or_else(|| body.to_owned(), |shape| format!("{body}/{shape}")),
            kind: match kind {
                BodyKind::Fixed => "fixed",
                BodyKind::Kinematic => "kinematic",
                BodyKind::Dynamic => "dynamic",
            },
            shape: shape(geometry),
            position_m: place.position_m,
            rotation: place.rotation_xyzw,
            on: None,
            colour: None,
            transparent: 0.0,
        });
    }
}

fn shape(geometry: Geometry) -> Shape {
    match geometry {
        Geometry::Nothing => Shape::None,
        Geometry::Box { size_m } => Shape::Box { size_m },
        Geometry::Sphere { radius_m } => Shape::Sphere { radius_m },
        Geometry::Cylinder { radius_m, length_m } => Shape::Cylinder { radius_m, length_m },
        Geometry::Capsule { radius_m, length_m } => Shape::Capsule { radius_m, length_m },
        Geometry::Mesh { corners_m, triangles } => Shape::Mesh {
            positions_m: corners_m.into_iter().flatten().collect(),
            indices: triangles.into_iter().flatten().collect(),
        },
    }
}

fn part(component: &Component, scene: &Scene) -> Part {
    let taken = component.inputs.iter().filter_map(|wire| match wire {
        Wire::Signal(name) => Some(name.to_string()),
        Wire::Open | Wire::Constant(_) | Wire::Output { .. } => None,
    });
    let given: Vec<String> = component.outputs.iter().flatten().map(ToString::to_string).collect();
    let parameter = |(parameter, setting): (&kind::Parameter, &kind::Setting)| {
        let (name, unit) = unit(&parameter.key);
        Parameter { name: name.to_owned(), value: setting.to_string(), unit }
    };
    Part {
        name: component.name.clone(),
        kind: component.kind.name.to_string(),
        body: component.bound.body.and_then(|body| scene.bodies.get(body)).map(|body| body.name.clone()),
        senses: senses(component),
        signals: taken.chain(given.iter().cloned()).collect(),
        parameters: component.kind.parameters.iter().zip(&component.settings).map(parameter).collect(),
        failures: component.kind.failures.iter().map(|mode| Failure { name: mode.mode.to_string() }).collect(),
    }
}

/// The signal that is true while a sensor sees something.
fn senses(component: &Component) -> Option<String> {
    const SEES: &[&str] = &["detected", "contact", "pulse", "present", "in_range"];
    let mut outputs = component.kind.outputs.iter().zip(&component.outputs);
    outputs.find(|(output, _)| SEES.contains(&&*output.key))?.1.as_ref().map(ToString::to_string)
}

/// The programs of the soft PLCs that are text, each with the signals on its lines.
fn sources(scenario: &Scenario, online: &Online) -> Vec<Source> {
    let mut sources = Vec::new();
    for plc in scenario.plcs() {
        for path in plc.sources.iter().filter(|path| !path.to_ascii_lowercase().ends_with("xml")) {
            // it has just been compiled; what cannot be read any more is not shown
            let Ok(text) = regular::read_text(&scenario.folder().join(path)) else { continue };
            if text.len() > SOURCE_MAX || sources.iter().any(|known: &Source| known.path == *path) {
                continue;
            }
            let lines = lines(&text, scenario, &|program, word| online.number(plc.name, &format!("{program}.{word}")));
            sources.push(Source { path: path.clone(), text, lines });
        }
    }
    sources
}

/// Signals by whose names, without those of what they are in, a line has words; and variables of the program that the line is
/// in, which `inner` finds.
fn lines(text: &str, scenario: &Scenario, inner: &dyn Fn(&str, &str) -> Option<usize>) -> Vec<SourceLine> {
    let mut by_word: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for declared in scenario.plan().signals() {
        let name = declared.name.to_string();
        let last = name.rsplit('.').next().unwrap_or(&name);
        let word = last.split('[').next().unwrap_or(last).to_ascii_uppercase();
        by_word.entry(word).or_default().push(name);
    }
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let mut program = String::new();
    let line = |(index, line): (usize, &str)| {
        let (mut variables, mut numbers): (Vec<String>, Vec<usize>) = (Vec::new(), Vec::new());
        let mut words = line.split(|c| !is_word(c)).filter(|word| !word.is_empty());
        match words.next() {
            Some(word) if word.eq_ignore_ascii_case("PROGRAM") => words.next().unwrap_or("").clone_into(&mut program),
            Some(word) if word.eq_ignore_ascii_case("END_PROGRAM") => program.clear(),
            _ => {}
        }
        for word in line.split(|c| !is_word(c)) {
            for name in by_word.get(&word.to_ascii_uppercase()).into_iter().flatten() {
                if !variables.contains(name) {
                    variables.push(name.clone());
                }
            }
            let number = if program.is_empty() { None } else { inner(&program, word) };
            numbers.extend(number.filter(|number| !numbers.contains(number)));
        }
        let is_told = !variables.is_empty() || !numbers.is_empty();
        is_told.then_some(SourceLine { number: index + 1, variables, inner: numbers })
    };
    text.lines().enumerate().filter_map(line).collect()
}
