//! `cases.toml` as it is written. Times are text with a unit, as in `"10ms"`.

use std::collections::BTreeMap;

use onescan_server::signal::SignalName;
use onescan_server::time::{TimeSpan, VirtualTime};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use toml::Spanned;

pub use crate::disturbance_file::{DisturbanceFile, DisturbanceKind, IntervalFile};
use crate::file::ExpectFile;
use crate::form::{CaseName, Matrix, Name, Ordinal, Scalar, Settings, Time, from_optional_text, from_text};

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
    /// Variables of PLCs that are forced or written.
    #[serde(default, rename = "variable")]
    #[schemars(with = "Vec<VariableFile>")]
    pub variables: Vec<Spanned<VariableFile>>,
    /// Tasks of PLCs that run late.
    #[serde(default, rename = "task")]
    #[schemars(with = "Vec<TaskFile>")]
    pub tasks: Vec<Spanned<TaskFile>>,
    /// Expectations of the scenario that this case need not meet.
    #[serde(default)]
    #[schemars(with = "Vec<String>")]
    pub waive: Vec<Spanned<String>>,
    /// What this case must show in addition to what the scenario expects.
    #[serde(default)]
    pub expect: Vec<ExpectFile>,
}

/// A signal takes a value at an instant and keeps it until its next input.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InputFile {
    /// From when on the signal has the value.
    #[serde(deserialize_with = "from_text")]
    #[schemars(with = "Time")]
    pub at: VirtualTime,
    /// The signal's name.
    #[schemars(with = "Name")]
    pub signal: Spanned<SignalName>,
    /// A value of the signal's type: `true`, `3`, `2.5`, `"200ms"`.
    #[schemars(with = "Scalar")]
    pub value: Spanned<toml::Value>,
}

/// A component fails for a time.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
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
    /// From when; from the start if absent. With `when`: from when on the condition counts.
    #[serde(default, deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub from: Option<VirtualTime>,
    /// Until when; never ends if absent. Not together with `when` or `for`.
    #[serde(default, deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub until: Option<VirtualTime>,
    /// A condition on signals, now and in the past: it begins in the step after the condition has come true.
    #[schemars(with = "Option<String>")]
    pub when: Option<Spanned<String>>,
    /// Which time that the condition comes true; the first if absent.
    #[schemars(with = "Option<Ordinal>")]
    pub nth: Option<Spanned<u32>>,
    /// How long it lasts.
    #[serde(default, rename = "for", deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub lasting: Option<TimeSpan>,
}

/// A signal keeps a value for a time, whatever its writer gives.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ForceFile {
    /// The signal's name.
    #[schemars(with = "Name")]
    pub signal: Spanned<SignalName>,
    /// A value of the signal's type: `true`, `3`, `2.5`, `"200ms"`.
    #[schemars(with = "Scalar")]
    pub value: Spanned<toml::Value>,
    /// From when; from the start if absent. With `when`: from when on the condition counts.
    #[serde(default, deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub from: Option<VirtualTime>,
    /// Until when; never ends if absent. Not together with `when` or `for`.
    #[serde(default, deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub until: Option<VirtualTime>,
    /// A condition on signals, now and in the past: it begins in the step after the condition has come true.
    #[schemars(with = "Option<String>")]
    pub when: Option<Spanned<String>>,
    /// Which time that the condition comes true; the first if absent.
    #[schemars(with = "Option<Ordinal>")]
    pub nth: Option<Spanned<u32>>,
    /// How long it lasts.
    #[serde(default, rename = "for", deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub lasting: Option<TimeSpan>,
}

/// A variable of a PLC is forced for a time, or written once.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
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
    /// From when it is forced; from the start if absent. With `when`: from when on the condition counts.
    #[serde(default, deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub from: Option<VirtualTime>,
    /// Until when; never ends if absent. Not together with `when` or `for`.
    #[serde(default, deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub until: Option<VirtualTime>,
    /// A condition on signals, now and in the past: it begins in the step after the condition has come true.
    #[schemars(with = "Option<String>")]
    pub when: Option<Spanned<String>>,
    /// Which time that the condition comes true; the first if absent.
    #[schemars(with = "Option<Ordinal>")]
    pub nth: Option<Spanned<u32>>,
    /// How long it is forced.
    #[serde(default, rename = "for", deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub lasting: Option<TimeSpan>,
}

/// A task of a PLC runs late: as long as this lasts each time, and in time again afterwards.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
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
    /// From when; from the start if absent. With `when`: from when on the condition counts.
    #[serde(default, deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub from: Option<VirtualTime>,
    /// Until when; never ends if absent. Not together with `when` or `for`.
    #[serde(default, deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub until: Option<VirtualTime>,
    /// A condition on signals, now and in the past: it begins in the step after the condition has come true.
    #[schemars(with = "Option<String>")]
    pub when: Option<Spanned<String>>,
    /// Which time that the condition comes true; the first if absent.
    #[schemars(with = "Option<Ordinal>")]
    pub nth: Option<Spanned<u32>>,
    /// How long it lasts.
    #[serde(default, rename = "for", deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub lasting: Option<TimeSpan>,
}

/// One `[[campaign]]`: every fault is tried with every activation.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CampaignFile {
    /// Its name: letters, digits, `-`, `_` and `.`; unique, without regard to case.
    #[schemars(with = "CaseName")]
    pub name: Spanned<String>,
    /// What it is about, in one line.
    pub about: Option<String>,
    /// The case to which the faults come; the scenario as it is if absent.
    #[schemars(with = "Option<String>")]
    pub case: Option<Spanned<String>>,
    /// Virtual time at which a run is complete; that of the case if absent.
    #[serde(default, deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub until: Option<VirtualTime>,
    /// Lists of values by path, or `seed`: all faults and activations for each combination.
    #[serde(default)]
    #[schemars(with = "Matrix")]
    pub matrix: toml::Table,
    /// What fails.
    #[serde(default, rename = "fault")]
    #[schemars(with = "Vec<CampaignFaultFile>")]
    pub faults: Vec<Spanned<CampaignFaultFile>>,
    /// When it fails, and for how long.
    #[serde(default, rename = "activation")]
    #[schemars(with = "Vec<ActivationFile>")]
    pub activations: Vec<Spanned<ActivationFile>>,
    /// The signals in which a fault shows its effect; all if empty. Ranges are allowed.
    #[serde(default)]
    #[schemars(with = "Vec<Name>")]
    pub readouts: Vec<Spanned<SignalName>>,
    /// The control has told of the fault: `eventually` with a window, or `within`, from the activation on.
    #[schemars(with = "Option<String>")]
    pub told: Option<Spanned<String>>,
    /// The machine is safe: a formula, from the activation on.
    #[schemars(with = "Option<String>")]
    pub safe: Option<Spanned<String>>,
    /// Something has come to harm: a formula, from the activation on.
    #[schemars(with = "Option<String>")]
    pub collision: Option<Spanned<String>>,
    /// The verdicts with which the campaign is passed; `told`, `safe`, `no-effect` and `not-activated` if absent.
    pub accept: Option<Vec<CampaignVerdict>>,
}

/// One fault of a campaign: exactly one of `fault`, `force`, `disturbance` and `variable`, without times.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CampaignFaultFile {
    /// Its name: letters, digits, `-`, `_` and `.`.
    #[schemars(with = "CaseName")]
    pub name: Spanned<String>,
    /// By which method it is brought in.
    pub kind: FaultKind,
    /// What it is, in one line.
    pub about: Option<String>,
    /// A component that fails, as in `[[case.fault]]`.
    #[schemars(with = "Option<FaultFile>")]
    pub fault: Option<Spanned<FaultFile>>,
    /// A signal that is held, as in `[[case.force]]`.
    #[schemars(with = "Option<ForceFile>")]
    pub force: Option<Spanned<ForceFile>>,
    /// Signals that do not arrive as they were sent, as in `[[case.disturbance]]`.
    #[schemars(with = "Option<DisturbanceFile>")]
    pub disturbance: Option<Spanned<DisturbanceFile>>,
    /// A variable of a PLC that is forced, as in `[[case.variable]]`.
    #[schemars(with = "Option<VariableFile>")]
    pub variable: Option<Spanned<VariableFile>>,
}

/// Where a fault is brought in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FaultKind {
    /// In the model of the machine.
    Model,
    /// In the software of the control.
    Software,
    /// In its wiring, its inputs and outputs, its links.
    Hardware,
}

impl FaultKind {
    /// As it is written.
    pub fn word(self) -> &'static str {
        match self {
            Self::Model => "model",
            Self::Software => "software",
            Self::Hardware => "hardware",
        }
    }
}

/// When the faults of a campaign come: `at` a time, or `when` a condition comes true.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ActivationFile {
    /// Its name: letters, digits, `-`, `_` and `.`.
    #[schemars(with = "CaseName")]
    pub name: Spanned<String>,
    /// What it is, in one line.
    pub about: Option<String>,
    /// At this time.
    #[serde(default, deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub at: Option<VirtualTime>,
    /// A condition on signals, now and in the past: in the step after it has come true.
    #[schemars(with = "Option<String>")]
    pub when: Option<Spanned<String>>,
    /// Which time that the condition comes true; the first if absent.
    #[schemars(with = "Option<Ordinal>")]
    pub nth: Option<Spanned<u32>>,
    /// From when on the condition counts.
    #[serde(default, deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub from: Option<VirtualTime>,
    /// How long the fault lasts; to the end if absent.
    #[serde(default, rename = "for", deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub lasting: Option<TimeSpan>,
}

/// What came of a fault. Exactly one of these holds; the first in this order counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum CampaignVerdict {
    /// Its run came to no end in the time that it had, or its process was lost.
    Unfinished,
    /// Its activation did not come.
    NotActivated,
    /// A PLC stopped on a fault.
    PlcFault,
    /// The readouts are those of the run without faults.
    NoEffect,
    /// Something came to harm.
    Collision,
    /// The control told of it.
    Told,
    /// The control did not tell of it, but the machine was safe.
    Safe,
    /// None of these.
    Missed,
}

impl CampaignVerdict {
    /// All of them, in the order in which they count.
    pub const ALL: [Self; 8] = [
        Self::Unfinished,
        Self::NotActivated,
        Self::PlcFault,
        Self::NoEffect,
        Self::Collision,
        Self::Told,
        Self::Safe,
        Self::Missed,
    ];

    /// As it is shown.
    pub fn word(self) -> &'static str {
        match self {
            Self::Unfinished => "unfinished",
            Self::NotActivated => "not activated",
            Self::PlcFault => "plc fault",
            Self::NoEffect => "no effect",
            Self::Collision => "collision",
            Self::Told => "told",
            Self::Safe => "safe",
            Self::Missed => "missed",
        }
    }
}
