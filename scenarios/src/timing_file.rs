//! `[timing]` of `scenario.toml`, as it is written.

use onescan_server::signal::SignalName;
use onescan_server::time::TimeSpan;
use schemars::JsonSchema;
use serde::Deserialize;
use toml::Spanned;

use crate::form::{Name, Time, from_text};

/// `[timing]`: what the real links may do to signals. `onescan explore` tries it; other runs take no notice of it.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TimingFile {
    /// Signals whose edges may arrive late.
    #[serde(default)]
    pub late: Vec<LateFile>,
}

/// Signals whose edges may arrive late, each by itself.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LateFile {
    /// The signals, of type BOOL; ranges as `Sensor[1..2]` are allowed.
    #[schemars(with = "Vec<Name>")]
    pub signals: Vec<Spanned<SignalName>>,
    /// By how much at most; each whole number of steps up to it is tried.
    #[serde(deserialize_with = "from_text")]
    #[schemars(with = "Time")]
    pub by: TimeSpan,
}
