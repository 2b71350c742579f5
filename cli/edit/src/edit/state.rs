//! All that the page shows: the files checked by the code of every other command, and what came of it.

use std::collections::BTreeMap;

use onescan_plant::component::kinds;
use onescan_scenario::Scenario;
use onescan_scenario::file::ClientFile;
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::{Map as Object, Value as Json};
use toml_edit::{Item, Value};

use super::change::{Sort, Texts};
use super::document::Document;
use super::ends::{self, End};
use super::field::{self, Field};
use super::files::{Files, scenes_of};
use super::finding::{self, Finding};
use super::join::Line;
use super::workspace::Workspace;
use crate::wiring::Map;
use onescan_runner::web::machine::{self, Body};

/// The version of the protocol, `web/PROTOCOL.md`.
pub(super) const PROTOCOL: u32 = 1;

/// What is known of the files as they are.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "EditState")]
pub(super) struct State {
    protocol: u32,
    scenario: String,
    revision: u64,
    /// What would be taken back, and done again.
    undo: Option<String>,
    redo: Option<String>,
    /// Files that somebody else has changed since.
    pub(super) changed: Vec<String>,
    findings: Vec<Finding>,
    clients: Vec<Client>,
    /// The signals that are declared, arrays and structures as they are written.
    signals: Vec<String>,
    /// None while something keeps the wiring from being known.
    map: Option<Map>,
    pub(super) ends: Vec<End>,
    scenes: Vec<SceneState>,
    #[serde(skip)]
    pub(super) lines: Vec<Line>,
}

/// A client, as far as its file says it.
#[derive(Debug, Serialize, JsonSchema)]
struct Client {
    name: String,
    kind: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    scene: Option<String>,
}

/// A scene, for the machine and for the forms.
#[derive(Debug, Serialize, JsonSchema)]
struct SceneState {
    file: String,
    /// None while the scene is wrong.
    bodies: Option<Vec<Body>>,
    tables: Vec<Table>,
}

/// A table of a scene as it is written.
#[derive(Debug, Serialize, JsonSchema)]
struct Table {
    sort: Sort,
    name: String,
    line: usize,
    #[schemars(with = "BTreeMap<String, Json>")]
    keys: Object<String, Json>,
}

/// Checks the files, which are on the disk as they are in the workspace.
pub(super) fn of(files: &Files, workspace: &Workspace) -> State {
    let texts = workspace.texts();
    let mut state = State {
        protocol: PROTOCOL,
        scenario: name_of(files),
        revision: workspace.revision(),
        undo: workspace.steps().0.map(str::to_owned),
        redo: workspace.steps().1.map(str::to_owned),
        changed: files.changed(texts),
        findings: Vec::new(),
        clients: clients(&texts.scenario),
        signals: signals(&texts.scenario),
        map: None,
        ends: Vec::new(),
        scenes: scenes_of(&texts.scenario).into_iter().map(|file| scene_state(file, texts)).collect(),
        lines: Vec::new(),
    };
    match Scenario::load(&files.path) {
        Ok(scenario) => check(&mut state, &scenario, texts),
        Err(error) => finding::of_error(&error, &mut state.findings),
    }
    state
}

fn name_of(files: &Files) -> String {
    let name = files.folder().file_name().map(|name| name.to_string_lossy().into_owned());
    name.unwrap_or_else(|| "scenario".to_owned())
}

/// Scenes, programs and the wiring between them.
fn check(state: &mut State, scenario: &Scenario, texts: &Texts) {
    for (name, client) in &scenario.file().clients {
        match client.get_ref() {
            ClientFile::Plant { scene: file, .. } => match scenario.scene_of(name, file) {
                Ok(scene) => {
                    let text = texts.scenes.get(file).map(String::as_str).unwrap_or_default();
                    if let Ok(document) = Document::parse(file, text) {
                        state.ends.extend(ends::of_plant(name.as_str(), file, &scene, &document));
                    }
                    if let Some(known) = state.scenes.iter_mut().find(|known| known.file == *file) {
                        known.bodies = Some(machine::bodies_of(&scene));
                    }
                }
                Err(error) => finding::of_error(&error, &mut state.findings),
            },
            ClientFile::SoftPlc { sources, dialect, bind, .. } => {
                match scenario.compiled(name, sources, *dialect, bind) {
                    Ok(compiled) => state.ends.extend(ends::of_plc(name.as_str(), &compiled.application)),
                    Err(error) => finding::of_error(&error, &mut state.findings),
                }
            }
            ClientFile::Gateway { .. }
            | ClientFile::Operator { .. }
            | ClientFile::OpcUa { .. }
            | ClientFile::External { .. } => {}
        }
    }
    if !state.findings.is_empty() {
        return;
    }
    match Map::of(scenario) {
        Ok(map) => {
            ends::connect(&mut state.ends, &map);
            state.findings.extend(finding::of_map(&map, texts));
            let line = |(name, signal): (
                &onescan_server::signal::SignalName,
                &toml::Spanned<onescan_scenario::file::SignalFile>,
            )| Line {
                name: name.to_string(),
                ty: signal.get_ref().ty.to_string(),
                writer: signal.get_ref().writer.to_string(),
            };
            state.lines = scenario.file().signals.iter().map(line).collect();
            state.map = Some(map);
        }
        Err(error) => finding::of_error(&error, &mut state.findings),
    }
}

fn signals(scenario: &str) -> Vec<String> {
    let Ok(document) = toml_edit::Document::parse(scenario) else { return Vec::new() };
    let signals = document.as_table().get("signals").and_then(Item::as_table_like);
    signals.into_iter().flat_map(|signals| signals.iter()).map(|(name, _)| name.to_owned()).collect()
}

fn clients(scenario: &str) -> Vec<Client> {
    let Ok(document) = toml_edit::Document::parse(scenario) else { return Vec::new() };
    let text = |item: &Item, key: &str| item.get(key).and_then(Item::as_str).map(str::to_owned);
    let clients = document.as_table().get("clients").and_then(Item::as_table_like);
    let client = |(name, item): (&str, &Item)| Client {
        name: name.to_owned(),
        kind: text(item, "kind").unwrap_or_default(),
        scene: text(item, "scene"),
    };
    clients.into_iter().flat_map(|clients| clients.iter()).map(client).collect()
}

/// The tables of a scene, wrong or not, as far as it is TOML.
fn scene_state(file: String, texts: &Texts) -> SceneState {
    let text = texts.scenes.get(&file).map(String::as_str).unwrap_or_default();
    let mut tables = Vec::new();
    if let Ok(document) = Document::parse(&file, text) {
        for sort in Sort::ALL {
            for table in document.tables(sort.key()) {
                let keys = table.iter().filter_map(|(key, item)| Some((key.to_owned(), json(item.as_value()?))));
                tables.push(Table {
                    sort,
                    name: table.get("name").and_then(Item::as_str).unwrap_or_default().to_owned(),
                    line: document.place(table.span().map_or(0, |span| span.start)).line,
                    keys: keys.collect(),
                });
            }
        }
    }
    SceneState { file, bodies: None, tables }
}

/// A value as the page reads it.
fn json(value: &Value) -> Json {
    match value {
        Value::String(text) => Json::from(text.value().as_str()),
        Value::Integer(whole) => Json::from(*whole.value()),
        Value::Float(number) => Json::from(*number.value()),
        Value::Boolean(flag) => Json::from(*flag.value()),
        Value::Datetime(time) => Json::from(time.value().to_string()),
        Value::Array(all) => all.iter().map(json).collect(),
        Value::InlineTable(table) => {
            Json::Object(table.iter().map(|(key, value)| (key.to_owned(), json(value))).collect())
        }
    }
}

/// What can be placed: the kinds of components, and the keys of every sort of table.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Library {
    protocol: u32,
    kinds: Vec<KindState>,
    sorts: Vec<SortState>,
}

#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "Kind")]
struct KindState {
    name: String,
    about: String,
    /// Types of inputs and outputs, by the keys that name their signals.
    #[schemars(with = "BTreeMap<String, String>")]
    types: Object<String, Json>,
    fields: Vec<Field>,
}

#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "SortFields")]
struct SortState {
    sort: Sort,
    fields: Vec<Field>,
}

/// The library, as `onescan components` has it.
pub(super) fn library() -> Library {
    let kind = |kind: &onescan_plant::component::kind::Kind| KindState {
        name: kind.name.to_string(),
        about: kind.summary.to_string(),
        types: kind
            .inputs
            .iter()
            .chain(&kind.outputs)
            .map(|signal| (format!("{}_signal", signal.key), Json::from(signal.values.to_string())))
            .collect(),
        fields: field::of_component(kind),
    };
    let sorts = Sort::ALL.into_iter().filter(|sort| *sort != Sort::Component);
    Library {
        protocol: PROTOCOL,
        kinds: kinds().iter().map(kind).collect(),
        sorts: sorts.map(|sort| SortState { sort, fields: field::of_sort(sort) }).collect(),
    }
}
