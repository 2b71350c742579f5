//! Panels: those that the scenario lays out, or one of all that operators write.

use std::collections::BTreeSet;
use std::ops::RangeFrom;

use onescan_scenario::file::ClientFile;
use onescan_scenario::panel_file::{ElementFile, ElementKind, KeyAction, PanelFile, Seat};
use onescan_scenario::panel_picture::PanelPicture;
use onescan_scenario::visible::{OnMachine, Visible};
use onescan_scenario::{Scenario, ScenarioError};
use onescan_server::signal::{ClientName, SignalDecl, SignalName, SignalType};
use schemars::JsonSchema;
use serde::Serialize;

use super::signals::written;

/// A panel of the page.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Panel {
    pub(super) name: String,
    pub(super) seat: Seat,
    #[serde(skip_serializing_if = "Option::is_none")]
    page: Option<Page>,
    columns: u32,
    rows: u32,
    /// Where a browser finds the picture behind it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) picture: Option<String>,
    elements: Vec<Element>,
}

/// When a panel is shown that is one of several pages: while the signal has the value.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "PanelPage")]
struct Page {
    signal: String,
    value: i64,
}

/// One thing on a panel.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "PanelElement")]
struct Element {
    kind: ElementKind,
    label: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    signal: Option<String>,
    /// The second axis of a joystick.
    #[serde(skip_serializing_if = "Option::is_none")]
    signal_y: Option<String>,
    /// The component and the mode of failure that it shows and causes.
    #[serde(skip_serializing_if = "Option::is_none")]
    failure: Option<[String; 2]>,
    /// The fault on the way of signals that it shows and causes, by its number.
    #[serde(skip_serializing_if = "Option::is_none")]
    disturbance: Option<usize>,
    /// Column and row, from 0.
    at: [u32; 2],
    #[schemars(default = "one_cell")]
    span: [u32; 2],
    #[serde(skip_serializing_if = "Option::is_none")]
    mode: Option<ButtonMode>,
    /// What a press does to the session, before it presses the signal.
    #[serde(skip_serializing_if = "Option::is_none")]
    action: Option<KeyAction>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", default = "least")]
    min: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", default = "most")]
    max: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    colour: Option<String>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schemars(default)]
    choices: Vec<Choice>,
    /// The bodies on which it lies, too: a click on one presses it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schemars(default)]
    bodies: Vec<usize>,
    /// The components on which it lies.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schemars(default)]
    components: Vec<String>,
}

fn one_cell() -> [u32; 2] {
    [1, 1]
}

#[expect(clippy::unnecessary_wraps, reason = "the default of an optional key")]
fn least() -> Option<f64> {
    Some(0.0)
}

#[expect(clippy::unnecessary_wraps, reason = "the default of an optional key")]
fn most() -> Option<f64> {
    Some(1.0)
}

/// Whether a button stays where it is put.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
enum ButtonMode {
    Toggle,
    /// As without a mode.
    #[expect(dead_code, reason = "other servers may say so")]
    Momentary,
}

/// A value of a selector.
#[derive(Debug, Serialize, JsonSchema)]
struct Choice {
    value: i64,
    label: String,
}

impl Panel {
    /// Whether it is a trainer's.
    pub(super) fn is_trainers(&self) -> bool {
        self.seat == Seat::Trainer
    }

    /// The signals of its keys that reset the session, of which some have none; nothing without such a key.
    pub(super) fn resets(&self) -> Option<BTreeSet<String>> {
        let mut keys = self.elements.iter().filter(|element| element.action == Some(KeyAction::Reset)).peekable();
        keys.peek()?;
        Some(keys.filter_map(|element| element.signal.clone()).collect())
    }

    /// The signals that people write with it.
    pub(super) fn written(&self) -> BTreeSet<String> {
        let writes = |element: &&Element| element.kind.writes() || element.kind == ElementKind::Alarms;
        let writing = self.elements.iter().filter(writes);
        writing.flat_map(|element| element.signal.iter().chain(&element.signal_y)).cloned().collect()
    }
}

/// The panels of a scenario's page, and the pictures behind them.
///
/// # Errors
/// A key lies on what is not there, or a picture cannot be read; it was read before, so it has just changed.
pub(super) fn of(scenario: &Scenario, visible: &Visible) -> Result<(Vec<Panel>, Vec<PanelPicture>), ScenarioError> {
    let laid_out = &scenario.file().panel;
    if laid_out.is_empty() {
        return Ok((pulpit(scenario).into_iter().collect(), Vec::new()));
    }
    let (mut panels, mut pictures, mut disturbances) = (Vec::new(), Vec::new(), 0..);
    for file in laid_out {
        let mut panel = panel(file, (scenario, visible), &mut disturbances)?;
        if let Some(picture) = scenario.picture_behind(file)? {
            panel.picture = Some(format!("api/panel/{}", pictures.len()));
            pictures.push(picture);
        }
        panels.push(panel);
    }
    Ok((panels, pictures))
}

/// A panel as the scenario has it; `disturbances` numbers those of all panels.
fn panel(
    file: &PanelFile,
    (scenario, visible): (&Scenario, &Visible),
    disturbances: &mut RangeFrom<usize>,
) -> Result<Panel, ScenarioError> {
    let elements: Vec<&ElementFile> = file.element.iter().map(toml::Spanned::get_ref).collect();
    Ok(Panel {
        name: file.name.get_ref().clone(),
        seat: file.seat,
        page: file
            .page
            .as_ref()
            .map(|page| Page { signal: page.get_ref().signal.get_ref().to_string(), value: page.get_ref().value }),
        columns: file.columns,
        rows: elements.iter().map(|element| element.at[1] + element.span[1]).max().unwrap_or(1),
        picture: None,
        elements: elements
            .into_iter()
            .map(|element| {
                let OnMachine { bodies, components } = scenario.on_machine(element, visible)?;
                Ok(Element { bodies, components, ..laid_out(element, scenario, disturbances) })
            })
            .collect::<Result<_, ScenarioError>>()?,
    })
}

/// An element as the scenario has it, with the names of its signal's values as choices.
fn laid_out(file: &ElementFile, scenario: &Scenario, disturbances: &mut RangeFrom<usize>) -> Element {
    let name = |signal: &toml::Spanned<SignalName>| signal.get_ref().to_string();
    let signal = file.signal.as_ref().map(name);
    let names = file.signal.as_ref().and_then(|signal| scenario.file().signals.get(signal.get_ref()));
    let is_selector = file.kind == ElementKind::Selector;
    Element {
        kind: file.kind,
        // a list of alarms has no signal to be called after
        label: file.label.clone().or_else(|| signal.as_deref().map(label)).unwrap_or_default(),
        signal,
        signal_y: file.signal_y.as_ref().map(name),
        failure: file
            .failure
            .as_ref()
            .and_then(|failure| failure.get_ref().parts())
            .map(|parts| parts.map(str::to_owned)),
        disturbance: file.disturbance.as_ref().and_then(|_| disturbances.next()),
        at: file.at,
        span: file.span,
        mode: file.latching.then_some(ButtonMode::Toggle),
        action: file.action.as_ref().map(|action| *action.get_ref()),
        min: file.min,
        max: file.max,
        colour: file.colour.clone(),
        choices: names
            .filter(|_| is_selector)
            .map(|signal| choices(signal.get_ref().names.pairs()))
            .unwrap_or_default(),
        bodies: Vec::new(),
        components: Vec::new(),
    }
}

fn choices(names: Vec<(i64, String)>) -> Vec<Choice> {
    names.into_iter().map(|(value, label)| Choice { value, label }).collect()
}

/// A panel of all that operators write, in the order of the file, and of the alarms.
fn pulpit(scenario: &Scenario) -> Option<Panel> {
    const COLUMNS: u32 = 6;
    const SPAN: u32 = 2;
    const ALARM_ROWS: u32 = 3;
    let file = scenario.file();
    let is_operator = |name: &ClientName| {
        matches!(file.clients.get(name).map(toml::Spanned::get_ref), Some(ClientFile::Operator { .. }))
    };
    let declared = scenario.plan().signals().iter();
    let mut elements = Vec::new();
    for declared in declared.filter(|declared| declared.writer.as_ref().is_some_and(is_operator)) {
        let number = u32::try_from(elements.len()).unwrap_or(u32::MAX);
        let at = [number % (COLUMNS / SPAN) * SPAN, number / (COLUMNS / SPAN)];
        elements.extend(element(declared, scenario, at, SPAN));
    }
    let mut rows = u32::try_from(elements.len()).unwrap_or(u32::MAX).div_ceil(COLUMNS / SPAN);
    if scenario.measures().is_some_and(|measures| !measures.alarms().is_empty()) {
        elements.push(Element { label: String::new(), ..bare(ElementKind::Alarms, [0, rows], [COLUMNS, ALARM_ROWS]) });
        rows += ALARM_ROWS;
    }
    (!elements.is_empty()).then(|| Panel {
        name: "operator".to_owned(),
        seat: Seat::Operator,
        page: None,
        columns: COLUMNS,
        rows,
        picture: None,
        elements,
    })
}

/// A signal's name without that of what it is in.
fn label(name: &str) -> String {
    name.rsplit('.').next().unwrap_or(name).replace('_', " ")
}

/// An element with a place and nothing else.
fn bare(kind: ElementKind, at: [u32; 2], span: [u32; 2]) -> Element {
    Element {
        kind,
        label: String::new(),
        signal: None,
        signal_y: None,
        failure: None,
        disturbance: None,
        at,
        span,
        mode: None,
        action: None,
        min: None,
        max: None,
        colour: None,
        choices: Vec::new(),
        bodies: Vec::new(),
        components: Vec::new(),
    }
}

/// What a signal is written with: a switch, a choice of its names, a slider. A text has none.
fn element(declared: &SignalDecl, scenario: &Scenario, at: [u32; 2], span: u32) -> Option<Element> {
    let names = written(scenario, declared).map(|file| file.names.pairs()).unwrap_or_default();
    let plain = |kind| Element {
        label: label(&declared.name.to_string()),
        signal: Some(declared.name.to_string()),
        ..bare(kind, at, [span, 1])
    };
    if declared.ty == SignalType::BOOL {
        return Some(Element { mode: Some(ButtonMode::Toggle), ..plain(ElementKind::Switch) });
    }
    if !names.is_empty() {
        let choices = choices(names);
        return Some(Element { choices, ..plain(ElementKind::Selector) });
    }
    let initial = initial(declared, scenario);
    declared.ty.as_f64(&vec![0; declared.ty.size()])?;
    let reach = if initial == 0.0 { 10.0 } else { 2.0 * initial.abs() };
    let least = if initial <= 0.0 { -reach } else { 0.0 };
    Some(Element { min: Some(least), max: Some(reach), ..plain(ElementKind::Slider) })
}

/// What the scenario says that a signal of an operator is at the start.
fn initial(declared: &SignalDecl, scenario: &Scenario) -> f64 {
    let client = declared.writer.as_ref().and_then(|name| scenario.file().clients.get(name));
    let Some(ClientFile::Operator { initial }) = client.map(toml::Spanned::get_ref) else { return 0.0 };
    match initial.get(&declared.name) {
        Some(toml::Value::Float(number)) => *number,
        #[expect(clippy::cast_precision_loss, reason = "a range for the eye")]
        Some(toml::Value::Integer(number)) => *number as f64,
        _ => 0.0,
    }
}
