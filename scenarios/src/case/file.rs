//! `cases.toml` as it is written. Times are text with a unit, as in `"10ms"`.

use std::collections::BTreeMap;

use onescan_server::signal::SignalName;
use onescan_server::time::{TimeSpan, VirtualTime};
use serde::Deserialize;
use toml::Spanned;

use crate::file::{ExpectFile, from_optional_text, from_text};

/// The only version of the format so far.
pub const VERSION: u32 = 1;

/// The whole file.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CasesFile {
    /// Version of the format.
    pub version: u32,
    /// What snapshots of trajectories hold.
    #[serde(default)]
    pub snapshot: SnapshotFile,
    /// The cases.
    #[serde(default, rename = "case")]
    pub cases: Vec<Spanned<CaseFile>>,
}

/// What snapshots hold.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SnapshotFile {
    /// The signals; those of the plot if empty, all if there is no plot.
    pub signals: Vec<Spanned<SignalName>>,
    /// How far apart samples of REAL and LREAL are; a hundredth of the run if absent.
    #[serde(deserialize_with = "from_optional_text")]
    pub sample: Option<TimeSpan>,
    /// By how much a number may differ from its snapshot, in its own unit; not at all if absent.
    pub tolerance: BTreeMap<SignalName, Spanned<f64>>,
}

/// One `[[case]]`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CaseFile {
    /// Its name: letters, digits, `-`, `_` and `.`.
    pub name: Spanned<String>,
    /// What it is about, in one line.
    pub about: Option<String>,
    /// Words to choose it by.
    #[serde(default)]
    pub tags: Vec<String>,
    /// What chance begins with.
    pub seed: Option<u64>,
    /// When its run is complete.
    #[serde(default, deserialize_with = "from_optional_text")]
    pub until: Option<VirtualTime>,
    /// Values by path.
    #[serde(default)]
    pub set: toml::Table,
    /// Lists of values by path: a case for each combination.
    #[serde(default)]
    pub matrix: toml::Table,
    /// What the operator does.
    #[serde(default, rename = "input")]
    pub inputs: Vec<Spanned<InputFile>>,
    /// Components that fail.
    #[serde(default, rename = "fault")]
    pub faults: Vec<Spanned<FaultFile>>,
    /// Signals that are held.
    #[serde(default, rename = "force")]
    pub forces: Vec<Spanned<ForceFile>>,
    /// Signals that do not arrive as they were sent.
    #[serde(default, rename = "disturbance")]
    pub disturbances: Vec<Spanned<DisturbanceFile>>,
    /// Variables of PLCs.
    #[serde(default, rename = "variable")]
    pub variables: Vec<Spanned<VariableFile>>,
    /// Expectations of the scenario that this case need not meet.
    #[serde(default)]
    pub waive: Vec<Spanned<String>>,
    /// What this case must show beside what the scenario expects.
    #[serde(default)]
    pub expect: Vec<ExpectFile>,
}

/// A signal takes a value at an instant and keeps it until its next input.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InputFile {
    /// When.
    #[serde(deserialize_with = "from_text")]
    pub at: VirtualTime,
    /// The signal.
    pub signal: Spanned<SignalName>,
    /// The value.
    pub value: Spanned<toml::Value>,
}

/// A component fails for a time.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FaultFile {
    /// The plant, where there is more than one.
    pub client: Option<Spanned<String>>,
    /// The component.
    pub component: Spanned<String>,
    /// How it fails.
    pub mode: Spanned<String>,
    /// From when; from the start if absent. With `when`: from when on the condition counts.
    #[serde(default, deserialize_with = "from_optional_text")]
    pub from: Option<VirtualTime>,
    /// Until when; for ever if absent.
    #[serde(default, deserialize_with = "from_optional_text")]
    pub until: Option<VirtualTime>,
    /// A condition on signals: it begins in the step after this has come true.
    pub when: Option<Spanned<String>>,
    /// How long it lasts.
    #[serde(default, rename = "for", deserialize_with = "from_optional_text")]
    pub lasting: Option<TimeSpan>,
}

/// A signal keeps a value for a time, whatever its writer gives.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ForceFile {
    /// The signal.
    pub signal: Spanned<SignalName>,
    /// The value.
    pub value: Spanned<toml::Value>,
    /// From when; from the start if absent. With `when`: from when on the condition counts.
    #[serde(default, deserialize_with = "from_optional_text")]
    pub from: Option<VirtualTime>,
    /// Until when; for ever if absent.
    #[serde(default, deserialize_with = "from_optional_text")]
    pub until: Option<VirtualTime>,
    /// A condition on signals: it begins in the step after this has come true.
    pub when: Option<Spanned<String>>,
    /// How long it lasts.
    #[serde(default, rename = "for", deserialize_with = "from_optional_text")]
    pub lasting: Option<TimeSpan>,
}

/// A fault on the way of a signal from its writer to its readers.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DisturbanceFile {
    /// The signal.
    pub signal: Spanned<SignalName>,
    /// The fault.
    pub kind: DisturbanceKind,
    /// By how much: a number for `offset`, a time as in `"20ms"` for `late`.
    pub by: Option<Spanned<toml::Value>>,
    /// From when; from the start if absent. With `when`: from when on the condition counts.
    #[serde(default, deserialize_with = "from_optional_text")]
    pub from: Option<VirtualTime>,
    /// Until when; for ever if absent.
    #[serde(default, deserialize_with = "from_optional_text")]
    pub until: Option<VirtualTime>,
    /// A condition on signals: it begins in the step after this has come true.
    pub when: Option<Spanned<String>>,
    /// How long it lasts.
    #[serde(default, rename = "for", deserialize_with = "from_optional_text")]
    pub lasting: Option<TimeSpan>,
}

/// What can be wrong with a signal on its way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DisturbanceKind {
    /// It keeps the value that it has.
    Stuck,
    /// A BOOL arrives negated.
    Inverted,
    /// A number arrives shifted.
    Offset,
    /// Values arrive late.
    Late,
}

/// A variable of a PLC is forced for a time, or written once.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VariableFile {
    /// The PLC, where there is more than one.
    pub client: Option<Spanned<String>>,
    /// The variable's path: `Main.limit`.
    pub variable: Spanned<String>,
    /// The value: a number, a truth value, or a literal of IEC 61131-3 as text.
    pub value: Spanned<toml::Value>,
    /// When it is written, once; the program may write it again.
    #[serde(default, deserialize_with = "from_optional_text")]
    pub at: Option<VirtualTime>,
    /// From when it is forced; from the start if absent. With `when`: from when on the condition counts.
    #[serde(default, deserialize_with = "from_optional_text")]
    pub from: Option<VirtualTime>,
    /// Until when; for ever if absent.
    #[serde(default, deserialize_with = "from_optional_text")]
    pub until: Option<VirtualTime>,
    /// A condition on signals: it begins in the step after this has come true.
    pub when: Option<Spanned<String>>,
    /// How long it is forced.
    #[serde(default, rename = "for", deserialize_with = "from_optional_text")]
    pub lasting: Option<TimeSpan>,
}
