//! `[report]` of `scenario.toml`, as it is written.

use onescan_server::signal::SignalName;
use onescan_server::time::TimeSpan;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use toml::Spanned;

use crate::form::{Name, Time, from_optional_text};

/// `[report]`: what is counted and timed in every run, for a report of a shift.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ReportFile {
    /// Width of the windows in which throughput is given over time, as in `"10min"`; one that suits the run if absent.
    #[serde(default, deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub window: Option<TimeSpan>,
    /// Virtual time that one piece takes when nothing is in the way (ISO 22400-2: planned run time per item). With it,
    /// `[report.down_time]` and a good count, the report has performance and OEE.
    #[serde(default, deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub ideal_cycle: Option<TimeSpan>,
    /// What is counted.
    #[serde(default)]
    pub count: Vec<CountFile>,
    /// Which times are taken.
    #[serde(default)]
    pub cycle: Vec<CycleFile>,
    /// When the machine is down, and why.
    #[schemars(with = "Option<DownTimeFile>")]
    pub down_time: Option<Spanned<DownTimeFile>>,
    /// What is listed, with each occurrence.
    #[serde(default)]
    pub alarm: Vec<AlarmFile>,
    /// Of which signals the lowest, mean and highest values are kept, window by window.
    #[serde(default)]
    pub history: Vec<HistoryFile>,
    /// For how long which signals have which values.
    #[serde(default)]
    pub histogram: Vec<HistogramFile>,
}

/// Something that is counted: `when` or `counter`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CountFile {
    /// Its name in the report; unique among counts.
    #[schemars(with = "String")]
    pub name: Spanned<String>,
    /// A formula of the present; one is counted each time it becomes true.
    #[schemars(with = "Option<String>")]
    pub when: Option<Spanned<String>>,
    /// A signal of a whole number that counts by itself; its growth is counted.
    #[schemars(with = "Option<Name>")]
    pub counter: Option<Spanned<SignalName>>,
    /// Whether what it counts is good or rejected; the report then has their ratio.
    pub quality: Option<Quality>,
}

/// What becomes of a piece (ISO 22400-2: good quantity, scrap quantity).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Quality {
    /// It is as it should be.
    Good,
    /// It is not.
    Reject,
}

/// Times that are taken, over and over.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CycleFile {
    /// Its name in the report; unique among cycles.
    #[schemars(with = "String")]
    pub name: Spanned<String>,
    /// A formula of the present; a cycle begins when it becomes true.
    #[schemars(with = "String")]
    pub from: Spanned<String>,
    /// A formula of the present; the cycle ends when it becomes true. If absent, it ends when the next one begins.
    #[schemars(with = "Option<String>")]
    pub to: Option<Spanned<String>>,
}

/// When the machine is down.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DownTimeFile {
    /// A formula of the present; the machine is down while it holds. If absent, it is down while a cause holds.
    #[schemars(with = "Option<String>")]
    pub when: Option<Spanned<String>>,
    /// Why; where several hold, the first of them counts.
    #[serde(default)]
    pub cause: Vec<CauseFile>,
}

/// A cause of down time.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CauseFile {
    /// Its name in the report; unique among causes.
    #[schemars(with = "String")]
    pub name: Spanned<String>,
    /// A formula of the present; it is the cause while this holds.
    #[schemars(with = "String")]
    pub when: Spanned<String>,
    /// True for what is meant to be, as a set-up or a break: it is not a failure, and availability leaves it out.
    #[serde(default)]
    pub planned: bool,
}

/// Something that is listed each time it comes.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AlarmFile {
    /// Its text in the report; unique among alarms.
    #[schemars(with = "String")]
    pub name: Spanned<String>,
    /// A formula of the present; the alarm is active while it holds.
    #[schemars(with = "String")]
    pub when: Spanned<String>,
    /// How urgent it is.
    #[serde(default)]
    pub priority: Priority,
    /// How long the formula holds before the alarm comes, as in `"5s"`; it comes at once if absent.
    #[serde(default, deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub on_delay: Option<TimeSpan>,
    /// How long the formula no longer holds before the alarm goes; it goes at once if absent.
    #[serde(default, deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub off_delay: Option<TimeSpan>,
}

/// The lowest, mean and highest values of signals in equal windows of virtual time.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HistoryFile {
    /// Its name in the report; unique among histories.
    #[schemars(with = "String")]
    pub name: Spanned<String>,
    /// Signals that are numbers; a range as in `"Zone[1..8]"` stands for all of its names.
    #[schemars(with = "Vec<String>")]
    pub signals: Vec<Spanned<String>>,
    /// The unit of the report, which theirs are carried to; each keeps its own if absent.
    #[schemars(with = "Option<String>")]
    pub unit: Option<Spanned<String>>,
    /// Width of the windows, as in `"24h"`; one that suits the run if absent.
    #[serde(default, deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub every: Option<TimeSpan>,
}

/// For how long signals have which values.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HistogramFile {
    /// Its name in the report; unique among histograms.
    #[schemars(with = "String")]
    pub name: Spanned<String>,
    /// Signals that are numbers; a range as in `"Zone[1..8]"` stands for all of its names.
    #[schemars(with = "Vec<String>")]
    pub signals: Vec<Spanned<String>>,
    /// The unit of the edges and of the report, which theirs are carried to; each keeps its own if absent.
    #[schemars(with = "Option<String>")]
    pub unit: Option<Spanned<String>>,
    /// Where the first bin begins.
    #[schemars(with = "f64")]
    pub from: Spanned<f64>,
    /// Where the last bin ends.
    #[schemars(with = "f64")]
    pub to: Spanned<f64>,
    /// How many bins there are, 1 to 1000.
    #[serde(default = "bins")]
    #[schemars(with = "u32")]
    pub bins: Spanned<u32>,
}

/// As many bins as a picture shows well.
fn bins() -> Spanned<u32> {
    Spanned::new(0..0, 24)
}

/// How urgent an alarm is (ISA-18.2): how soon somebody has to do something.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Priority {
    /// Something will have to be done.
    Low,
    /// Something has to be done soon.
    #[default]
    Medium,
    /// Something has to be done at once.
    High,
    /// People or the machine are in danger.
    Critical,
}
