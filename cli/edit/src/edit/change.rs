//! A change, as data, and the files that it is made in.

use std::collections::BTreeMap;
use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use toml_edit::Value;

use super::document::quoted;
use super::error::EditError;

/// The files of a scenario that can be changed, as text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Texts {
    /// `scenario.toml`.
    pub scenario: String,
    /// The scenes of its plants, by the names that the scenario has for their files.
    pub scenes: BTreeMap<String, String>,
}

impl Texts {
    pub(super) fn scene(&self, file: &str) -> Result<&str, EditError> {
        self.scenes.get(file).map(String::as_str).ok_or_else(|| EditError::NoScene(file.to_owned()))
    }

    /// The same with another scene.
    pub(super) fn with_scene(&self, file: &str, text: String) -> Self {
        let mut texts = self.clone();
        texts.scenes.insert(file.to_owned(), text);
        texts
    }
}

/// Sorts of tables of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Sort {
    /// `[[body]]`
    Body,
    /// `[[shape]]`
    Shape,
    /// `[[joint]]`
    Joint,
    /// `[[fitting]]`
    Fitting,
    /// `[[coupling]]`
    Coupling,
    /// `[[axis]]`
    Axis,
    /// `[[sensor]]`
    Sensor,
    /// `[[component]]`
    Component,
}

impl Sort {
    /// All, in the order in which a scene has them.
    pub const ALL: [Self; 8] = [
        Self::Body,
        Self::Shape,
        Self::Joint,
        Self::Fitting,
        Self::Coupling,
        Self::Axis,
        Self::Sensor,
        Self::Component,
    ];

    /// As a scene calls it.
    pub const fn key(self) -> &'static str {
        match self {
            Self::Body => "body",
            Self::Shape => "shape",
            Self::Joint => "joint",
            Self::Fitting => "fitting",
            Self::Coupling => "coupling",
            Self::Axis => "axis",
            Self::Sensor => "sensor",
            Self::Component => "component",
        }
    }
}

/// A value that a key is given.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Given {
    /// Yes or no.
    Flag(bool),
    /// A number, in the unit of its key.
    Number(f64),
    /// A word, or a name.
    Text(String),
    /// Numbers, as of a position.
    Numbers(Vec<f64>),
    /// Names.
    Texts(Vec<String>),
}

impl fmt::Display for Given {
    /// As TOML has it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Flag(flag) => write!(f, "{flag}"),
            Self::Number(number) => write!(f, "{number}"),
            Self::Text(text) => f.write_str(&quoted(text)),
            Self::Numbers(numbers) => {
                let all: Vec<_> = numbers.iter().map(|number| float(*number)).collect();
                write!(f, "[{}]", all.join(", "))
            }
            Self::Texts(texts) => {
                write!(f, "[{}]", texts.iter().map(|text| quoted(text)).collect::<Vec<_>>().join(", "))
            }
        }
    }
}

impl Given {
    /// As it is written for a key that takes any number.
    pub(super) fn written(&self) -> String {
        if let Self::Number(number) = self { float(*number) } else { self.to_string() }
    }
}

/// A number that cannot be taken for a whole one.
fn float(number: f64) -> String {
    Value::from(number).to_string()
}

/// A change of the files.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub enum Edit {
    /// A signal is this variable of the PLC, by a line of its `bind`.
    Connect {
        /// The PLC.
        client: String,
        /// The signal.
        signal: String,
        /// The path of the variable.
        variable: String,
    },
    /// That line goes.
    Disconnect {
        /// The PLC.
        client: String,
        /// The signal.
        signal: String,
    },
    /// A signal of the session.
    Declare {
        /// Its name.
        signal: String,
        /// Its type.
        #[serde(rename = "type")]
        ty: String,
        /// Who writes it.
        writer: String,
        /// Its unit.
        #[serde(default)]
        unit: Option<String>,
        /// What it means.
        #[serde(default)]
        about: Option<String>,
    },
    /// A signal goes that nobody refers to.
    Withdraw {
        /// Its name.
        signal: String,
    },
    /// A body, a joint, a component, …
    Add {
        /// The file of the scene.
        scene: String,
        /// What it is.
        sort: Sort,
        /// Its name.
        name: String,
        /// Its keys, in their order.
        keys: Vec<(String, Given)>,
    },
    /// A key gets another value, or goes.
    Set {
        /// The file of the scene.
        scene: String,
        /// What it is.
        sort: Sort,
        /// Its name.
        name: String,
        /// The key.
        key: String,
        /// The value; none takes the key away.
        value: Option<Given>,
    },
    /// A body gets another place.
    Move {
        /// The file of the scene.
        scene: String,
        /// The body.
        body: String,
        /// Its origin, m.
        position_m: [f64; 3],
    },
    /// A thing gets another name, with all that refers to it.
    Rename {
        /// The file of the scene.
        scene: String,
        /// What it is.
        sort: Sort,
        /// Its name.
        name: String,
        /// Its new name.
        to: String,
    },
    /// A thing goes that nobody refers to.
    Remove {
        /// The file of the scene.
        scene: String,
        /// What it is.
        sort: Sort,
        /// Its name.
        name: String,
    },
}

impl fmt::Display for Edit {
    /// In a few words, for a list of what can be taken back.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Connect { signal, variable, .. } => write!(f, "connect {signal} with {variable}"),
            Self::Disconnect { signal, .. } => write!(f, "disconnect {signal}"),
            Self::Declare { signal, .. } => write!(f, "declare {signal}"),
            Self::Withdraw { signal } => write!(f, "withdraw {signal}"),
            Self::Add { sort, name, .. } => write!(f, "add {} {name}", sort.key()),
            Self::Set { name, key, value: Some(value), .. } => write!(f, "set {name}.{key} to {value}"),
            Self::Set { name, key, value: None, .. } => write!(f, "take {name}.{key} away"),
            Self::Move { body, .. } => write!(f, "move {body}"),
            Self::Rename { name, to, .. } => write!(f, "rename {name} to {to}"),
            Self::Remove { sort, name, .. } => write!(f, "remove {} {name}", sort.key()),
        }
    }
}
