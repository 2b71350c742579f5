//! `[[panel]]` of `scenario.toml` as it is written.

use onescan_server::signal::SignalName;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use toml::Spanned;

use crate::disturbance_file::DisturbanceFile;
use crate::form::Name;

/// What people see and operate of a session, laid out on a grid.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PanelFile {
    /// Its name; unique.
    #[schemars(with = "String")]
    pub name: Spanned<String>,
    /// Whose it is.
    #[serde(default)]
    pub seat: Seat,
    /// It is a page: it is shown while a signal has a value.
    #[schemars(with = "Option<PageFile>")]
    pub page: Option<Spanned<PageFile>>,
    /// How many columns the grid has.
    #[serde(default = "columns")]
    #[schemars(range(min = 1, max = 24))]
    pub columns: u32,
    /// The picture that lies behind it, a file of the scenario: PNG, JPEG or SVG. It is stretched over the grid.
    #[schemars(with = "Option<String>")]
    pub picture: Option<Spanned<String>>,
    /// What is on it.
    #[schemars(with = "Vec<ElementFile>")]
    pub element: Vec<Spanned<ElementFile>>,
}

/// When a panel is shown that is one of several pages.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PageFile {
    /// The signal that says which page is shown; whoever opens a page writes it.
    #[schemars(with = "Name")]
    pub signal: Spanned<SignalName>,
    /// Its value while this one is.
    pub value: i64,
}

/// Whose a panel is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Seat {
    /// The machine's operator.
    #[default]
    Operator,
    /// Who trains operators.
    Trainer,
}

/// One thing on a panel.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ElementFile {
    /// What it is.
    pub kind: ElementKind,
    /// What stands on it; the name of the signal if absent.
    pub label: Option<String>,
    /// The signal that it shows or writes.
    #[schemars(with = "Option<Name>")]
    pub signal: Option<Spanned<SignalName>>,
    /// The signal of a joystick's way up and down.
    #[schemars(with = "Option<Name>")]
    pub signal_y: Option<Spanned<SignalName>>,
    /// What it lets fail and repairs, in place of a signal: `component.mode`.
    #[schemars(with = "Option<String>")]
    pub failure: Option<Spanned<FailureName>>,
    /// The fault on the way of signals that it begins and ends, in place of a signal: the keys of a case's, without a time.
    #[schemars(with = "Option<DisturbanceFile>")]
    pub disturbance: Option<Spanned<DisturbanceFile>>,
    /// Column and row of its upper left corner, from 0.
    pub at: [u32; 2],
    /// How many columns and rows it takes.
    #[serde(default = "one_cell")]
    pub span: [u32; 2],
    /// The least value of a slider, a joystick or a bar, in the signal's unit.
    pub min: Option<f64>,
    /// The greatest one.
    pub max: Option<f64>,
    /// Its colour: `#rrggbb`, or a word such as `red`.
    pub colour: Option<String>,
    /// Whether a button stays where it is put.
    #[serde(default)]
    pub latching: bool,
    /// What a press of a button does to the session; with a `signal`, it presses that, too.
    #[schemars(with = "Option<KeyAction>")]
    pub action: Option<Spanned<KeyAction>>,
    /// The part of the machine on which it lies, too: a body, a figure or a component. A click on that presses it.
    #[schemars(with = "Option<String>")]
    pub part: Option<Spanned<String>>,
}

/// What a key does to the session.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum KeyAction {
    /// Machine and programs begin again together, at virtual time 0. The button's signal is pressed in the session that begins.
    Reset,
}

/// A mode of failure of a component, as `component.mode`.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(transparent)]
pub struct FailureName(String);

impl FailureName {
    /// The component and the mode; nothing if it is not written so.
    pub fn parts(&self) -> Option<[&str; 2]> {
        let (component, mode) = self.0.rsplit_once('.')?;
        (!component.is_empty() && !mode.is_empty()).then_some([component, mode])
    }
}

/// What an element is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ElementKind {
    /// Is TRUE while it is pressed.
    Button,
    /// An emergency stop: latches when it is struck, and is turned to be released. Its signal is TRUE until then.
    #[serde(rename = "emergency-stop")]
    EmergencyStop,
    /// Is on or off.
    Switch,
    /// One of the names of the signal's values.
    Selector,
    /// A number.
    Slider,
    /// Two numbers, or one; it goes back to the middle.
    Joystick,
    /// Lights while the signal is TRUE.
    Lamp,
    /// The value.
    Number,
    /// The value as a length.
    Bar,
    /// The value over time.
    Trend,
    /// The alarms of `[report]`, to be acknowledged; its signal is TRUE while that is pressed.
    Alarms,
}

impl ElementKind {
    /// Whether it is a key, which a click on the machine can press.
    pub fn is_key(self) -> bool {
        matches!(self, Self::Button | Self::Switch | Self::EmergencyStop)
    }

    /// Whether people write with it.
    pub fn writes(self) -> bool {
        matches!(
            self,
            Self::Button | Self::EmergencyStop | Self::Switch | Self::Selector | Self::Slider | Self::Joystick
        )
    }
}

fn columns() -> u32 {
    6
}

fn one_cell() -> [u32; 2] {
    [1, 1]
}
