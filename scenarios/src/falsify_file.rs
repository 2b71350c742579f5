//! `[falsify]` of `scenario.toml`, as it is written.

use onescan_server::signal::SignalName;
use onescan_server::time::{TimeSpan, VirtualTime};
use schemars::JsonSchema;
use serde::Deserialize;
use toml::Spanned;

use crate::form::{Name, Time, from_optional_text};

/// `[falsify]`: what may be varied to break what is expected. `onescan falsify` does; other runs take no notice of it.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FalsifyFile {
    /// Operator's inputs over time.
    #[serde(default)]
    pub input: Vec<VariedInputFile>,
    /// Parameters of plants, and initial values and constants of PLCs.
    #[serde(default)]
    pub parameter: Vec<VariedParameterFile>,
}

/// An operator's input that is varied over time.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VariedInputFile {
    /// The signal: a BOOL, an integer, REAL or LREAL.
    #[schemars(with = "Name")]
    pub signal: Spanned<SignalName>,
    /// Least and greatest value; absent for a BOOL, which has two.
    #[serde(default)]
    #[schemars(with = "Option<[f64; 2]>")]
    pub range: Option<Spanned<[f64; 2]>>,
    /// What it is between its control points.
    #[serde(default)]
    pub shape: ShapeFile,
    /// How many control points it has, evenly from `from` to `until`.
    #[schemars(with = "u32", range(min = 1, max = 1000))]
    pub points: Spanned<u32>,
    /// Time of the first control point; the start if absent.
    #[serde(default, deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub from: Option<VirtualTime>,
    /// Time of the last control point, or end of the last piece; the end of the run if absent.
    #[serde(default, deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub until: Option<VirtualTime>,
    /// How often a `linear` input changes between its control points; each step if absent.
    #[serde(default, deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub every: Option<TimeSpan>,
}

/// What an input is between its control points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ShapeFile {
    /// The value of the control point before.
    #[default]
    PiecewiseConstant,
    /// A straight line from one control point to the next.
    Linear,
}

/// A value that is varied from run to run.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VariedParameterFile {
    /// Its path, as in `set` of a case: `plant.clamp.stroke_m`, `plc.Main.Speed`.
    #[schemars(with = "String")]
    pub path: Spanned<String>,
    /// Least and greatest value.
    #[schemars(with = "[f64; 2]")]
    pub range: Spanned<[f64; 2]>,
    /// Whole numbers only.
    #[serde(default)]
    pub whole: bool,
}
