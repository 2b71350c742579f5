//! `cases.toml` as it is written: what snapshots contain, cases, campaigns.

use std::collections::BTreeMap;

use onescan_server::signal::SignalName;
use onescan_server::time::TimeSpan;
use schemars::JsonSchema;
use serde::Deserialize;
use toml::Spanned;

use super::campaign_file::CampaignFile;
use super::file::CaseFile;
use crate::form::{Name, Time, from_optional_text};

/// The only version of the format so far.
pub const VERSION: u32 = 1;

/// `cases.toml`: what is tried on a scenario.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CasesFile {
    /// Version of the format: 1.
    pub version: u32,
    /// What snapshots of trajectories contain.
    #[serde(default)]
    pub snapshot: SnapshotFile,
    /// The cases; one called `default` if there are none.
    #[serde(default, rename = "case")]
    #[schemars(with = "Vec<CaseFile>")]
    pub cases: Vec<Spanned<CaseFile>>,
    /// Faults tried one by one, each at each of several instants.
    #[serde(default, rename = "campaign")]
    pub campaigns: Vec<CampaignFile>,
}

/// Which signals a snapshot contains, and how far a run may be from it.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct SnapshotFile {
    /// The signals; those of the plot if empty, all if there is no plot.
    #[schemars(with = "Vec<Name>")]
    pub signals: Vec<Spanned<SignalName>>,
    /// How far apart samples of REAL and LREAL are; a hundredth of the run if absent.
    #[serde(deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub sample: Option<TimeSpan>,
    /// By how much a number may differ from its snapshot, in its own unit; not at all if absent.
    #[schemars(with = "BTreeMap<String, f64>")]
    pub tolerance: BTreeMap<SignalName, Spanned<f64>>,
}
