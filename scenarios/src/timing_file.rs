//! `[timing]` of `scenario.toml`, as it is written.

use onescan_server::signal::SignalName;
use onescan_server::time::TimeSpan;
use schemars::JsonSchema;
use serde::Deserialize;
use toml::Spanned;

use crate::form::{Name, Time, from_optional_text, from_text};

/// `[timing]`: what real links and real PLCs may do. `onescan explore` tries it; other runs take no notice of it.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TimingFile {
    /// Signals whose edges may arrive late, each by itself.
    #[serde(default)]
    pub late: Vec<LateFile>,
    /// Signals that travel together: a frame that may arrive late as a whole.
    #[serde(default)]
    pub together: Vec<LateFile>,
    /// Signals whose edges of one step may arrive one after the other.
    #[serde(default)]
    pub order: Vec<OrderFile>,
    /// Tasks of soft PLCs that may run at other times.
    #[serde(default)]
    #[schemars(with = "Vec<TaskTimingFile>")]
    pub task: Vec<Spanned<TaskTimingFile>>,
    /// Soft PLCs that may be started after the others.
    #[serde(default)]
    #[schemars(with = "Vec<StartFile>")]
    pub start: Vec<Spanned<StartFile>>,
}

/// Signals that may arrive late.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LateFile {
    /// The signals; ranges as `Sensor[1..2]` are allowed.
    #[schemars(with = "Vec<Name>")]
    pub signals: Vec<Spanned<SignalName>>,
    /// By how much at most; each whole number of steps up to it is tried.
    #[serde(deserialize_with = "from_text")]
    #[schemars(with = "Time")]
    pub by: TimeSpan,
}

/// Signals whose edges of one step may arrive one after the other.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OrderFile {
    /// The signals; ranges as `Sensor[1..2]` are allowed.
    #[schemars(with = "Vec<Name>")]
    pub signals: Vec<Spanned<SignalName>>,
}

/// What a task of a soft PLC may do.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TaskTimingFile {
    /// The soft PLC, if there are several.
    #[schemars(with = "Option<Name>")]
    pub client: Option<Spanned<String>>,
    /// The task, if the PLC has several.
    #[schemars(with = "Option<String>")]
    pub task: Option<Spanned<String>>,
    /// Jitter: by how much one of its scans may come late at most, less than its interval.
    #[serde(default, deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub late: Option<TimeSpan>,
    /// By how much all of its scans may come later at most, less than its interval.
    #[serde(default, deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub phase: Option<TimeSpan>,
    /// A scan may take two cycles: what it writes is seen an interval later, and the scan after it is left out.
    #[serde(default)]
    pub two_cycles: bool,
}

/// A soft PLC that may be started after the others.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StartFile {
    /// The soft PLC, if there are several.
    #[schemars(with = "Option<Name>")]
    pub client: Option<Spanned<String>>,
    /// By how much later at most; each whole number of steps up to it is tried.
    #[serde(deserialize_with = "from_text")]
    #[schemars(with = "Time")]
    pub by: TimeSpan,
}
