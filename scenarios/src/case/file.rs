//! `[[case]]` of `cases.toml` as it is written. Times are text with a unit, as in `"10ms"`.

use onescan_server::signal::SignalName;
use onescan_server::time::VirtualTime;
use schemars::JsonSchema;
use serde::Deserialize;
use toml::Spanned;

pub use crate::disturbance_file::{DisturbanceFile, DisturbanceKind, IntervalFile};
use crate::file::ExpectFile;
use crate::form::{CaseName, Matrix, Name, Ordinal, Scalar, Settings, Time, from_optional_text, from_text};
use crate::timed::timed;

/// One `[[case]]`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CaseFile {
    /// Its name: letters, digits, `-`, `_` and `.`; unique, without regard to case.
    #[schemars(with = "CaseName")]
    pub name: Spanned<String>,
    /// What it is about, in one line.
    pub about: Option<String>,
    /// Words by which to select it.
    #[serde(default)]
    pub tags: Vec<String>,
    /// Seed of all randomness; the scenario's if absent.
    pub seed: Option<u64>,
    /// Virtual time at which its run is complete; the scenario's if absent.
    #[serde(default, deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub until: Option<VirtualTime>,
    /// Values by path: parameters of plants, initial values and constants of PLCs, as in
    /// `plant.clamp.stroke_m = 0.08`.
    #[serde(default)]
    #[schemars(with = "Settings")]
    pub set: toml::Table,
    /// Lists of values by path, or `seed`: one case for each combination.
    #[serde(default)]
    #[schemars(with = "Matrix")]
    pub matrix: toml::Table,
    /// An operator's inputs.
    #[serde(default, rename = "input")]
    #[schemars(with = "Vec<InputFile>")]
    pub inputs: Vec<Spanned<InputFile>>,
    /// Components that fail.
    #[serde(default, rename = "fault")]
    #[schemars(with = "Vec<FaultFile>")]
    pub faults: Vec<Spanned<FaultFile>>,
    /// Signals that are held.
    #[serde(default, rename = "force")]
    #[schemars(with = "Vec<ForceFile>")]
    pub forces: Vec<Spanned<ForceFile>>,
    /// Signals that do not arrive as they were sent.
    #[serde(default, rename = "disturbance")]
    #[schemars(with = "Vec<DisturbanceFile>")]
    pub disturbances: Vec<Spanned<DisturbanceFile>>,
    /// Parameters of plants that change while it runs.
    #[serde(default, rename = "parameter")]
    #[schemars(with = "Vec<ParameterFile>")]
    pub parameters: Vec<Spanned<ParameterFile>>,
    /// Variables of PLCs that are forced or written.
    #[serde(default, rename = "variable")]
    #[schemars(with = "Vec<VariableFile>")]
    pub variables: Vec<Spanned<VariableFile>>,
    /// Tasks of PLCs that run late.
    #[serde(default, rename = "task")]
    #[schemars(with = "Vec<TaskFile>")]
    pub tasks: Vec<Spanned<TaskFile>>,
    /// Other programs in soft PLCs.
    #[serde(default)]
    #[schemars(with = "Vec<CodeFile>")]
    pub code: Vec<Spanned<CodeFile>>,
    /// Expectations of the scenario that this case need not meet.
    #[serde(default)]
    #[schemars(with = "Vec<String>")]
    pub waive: Vec<Spanned<String>>,
    /// What this case must show in addition to what the scenario expects.
    #[serde(default)]
    pub expect: Vec<ExpectFile>,
}

impl CaseFile {
    /// A case that does nothing.
    pub(crate) fn empty(name: &Spanned<String>) -> Self {
        Self {
            name: name.clone(),
            about: None,
            tags: Vec::new(),
            seed: None,
            until: None,
            set: toml::Table::new(),
            matrix: toml::Table::new(),
            inputs: Vec::new(),
            faults: Vec::new(),
            forces: Vec::new(),
            disturbances: Vec::new(),
            parameters: Vec::new(),
            variables: Vec::new(),
            tasks: Vec::new(),
            code: Vec::new(),
            waive: Vec::new(),
            expect: Vec::new(),
        }
    }
}

/// A signal takes a value at an instant and keeps it until its next input.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InputFile {
    /// The signal's name.
    #[schemars(with = "Name")]
    pub signal: Spanned<SignalName>,
    /// A value of the signal's type: `true`, `3`, `2.5`, `"200ms"`.
    #[schemars(with = "Scalar")]
    pub value: Spanned<toml::Value>,
    /// From when on the signal has the value.
    #[serde(deserialize_with = "from_text")]
    #[schemars(with = "Time")]
    pub at: VirtualTime,
}

timed! {
    /// A component fails for a time.
    pub struct FaultFile {
        /// The plant, if there are several.
        #[schemars(with = "Option<Name>")]
        pub client: Option<Spanned<String>>,
        /// The component that fails.
        #[schemars(with = "String")]
        pub component: Spanned<String>,
        /// How it fails: one of the modes that `onescan components KIND` lists.
        #[schemars(with = "String")]
        pub mode: Spanned<String>,
    }
}

timed! {
    /// A signal keeps a value for a time, whatever its writer gives.
    pub struct ForceFile {
        /// The signal's name.
        #[schemars(with = "Name")]
        pub signal: Spanned<SignalName>,
        /// A value of the signal's type: `true`, `3`, `2.5`, `"200ms"`.
        #[schemars(with = "Scalar")]
        pub value: Spanned<toml::Value>,
    }
}

timed! {
    /// A variable of a PLC is forced for a time, or written once.
    pub struct VariableFile {
        /// The soft PLC, if there are several.
        #[schemars(with = "Option<Name>")]
        pub client: Option<Spanned<String>>,
        /// The variable's path: `Main.limit`.
        #[schemars(with = "String")]
        pub variable: Spanned<String>,
        /// A number, a BOOL, or a literal of IEC 61131-3 as text.
        #[schemars(with = "Scalar")]
        pub value: Spanned<toml::Value>,
        /// When it is written, once; the program may overwrite it. Without `at` it is forced.
        #[serde(default, deserialize_with = "from_optional_text")]
        #[schemars(with = "Option<Time>")]
        pub at: Option<VirtualTime>,
    }
}

timed! {
    /// A parameter of a component has another value for a time: wear, a setting that somebody turned, a supply that gave way.
    pub struct ParameterFile {
        /// The plant, if there are several.
        #[schemars(with = "Option<Name>")]
        pub client: Option<Spanned<String>>,
        /// The component.
        #[schemars(with = "String")]
        pub component: Spanned<String>,
        /// The parameter: one of those that `onescan components KIND` lists.
        #[schemars(with = "String")]
        pub parameter: Spanned<String>,
        /// A value that the parameter takes: `0.08`, `true`, `"nc"`.
        #[schemars(with = "Scalar")]
        pub value: Spanned<toml::Value>,
    }
}

timed! {
    /// A task of a PLC runs late: as long as this lasts each time, and in time again afterwards.
    pub struct TaskFile {
        /// The soft PLC, if there are several.
        #[schemars(with = "Option<Name>")]
        pub client: Option<Spanned<String>>,
        /// The task; all tasks of the PLC if absent, as if it had been started later.
        #[schemars(with = "Option<String>")]
        pub task: Option<Spanned<String>>,
        /// By how much it is late, in whole steps.
        #[schemars(with = "Time")]
        pub by: Spanned<String>,
    }
}

/// Another program in a soft PLC: a file in the place of one of its sources, or a text in the place of another.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CodeFile {
    /// The soft PLC, if there are several.
    #[schemars(with = "Option<Name>")]
    pub client: Option<Spanned<String>>,
    /// The source, as the scenario names it.
    #[schemars(with = "String")]
    pub source: Spanned<String>,
    /// The file in its place, relative to the scenario.
    #[schemars(with = "Option<String>")]
    pub by: Option<Spanned<String>>,
    /// The line at which `was` begins, from 1.
    #[schemars(with = "Option<Ordinal>")]
    pub line: Option<u32>,
    /// The character of that line at which it begins, from 1.
    #[schemars(with = "Option<Ordinal>")]
    pub column: Option<u32>,
    /// The text that stands there.
    pub was: Option<String>,
    /// The text in its place; empty to leave it out.
    pub is: Option<String>,
}

impl CodeFile {
    /// As it is written.
    pub(super) fn keys(&self) -> toml::Table {
        let text = |text: &Option<String>| text.as_deref().map(toml::Value::from);
        let name = |name: Option<&Spanned<String>>| name.map(|name| toml::Value::from(name.get_ref().as_str()));
        let number = |number: Option<u32>| number.map(|number| toml::Value::from(i64::from(number)));
        let keys = [
            ("client", name(self.client.as_ref())),
            ("source", name(Some(&self.source))),
            ("by", name(self.by.as_ref())),
            ("line", number(self.line)),
            ("column", number(self.column)),
            ("was", text(&self.was)),
            ("is", text(&self.is)),
        ];
        keys.into_iter().filter_map(|(key, value)| Some((key.to_owned(), value?))).collect()
    }
}
