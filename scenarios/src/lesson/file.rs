//! `lessons.toml`, and each file of the folder `lessons`, as it is written. Times are text with a unit, as in `"10ms"`, and count from the start of a lesson.

use std::path::PathBuf;

use onescan_server::signal::SignalName;
use onescan_server::time::{TimeSpan, VirtualTime};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use toml::Spanned;

use crate::case::file::{DisturbanceFile, FaultFile, ForceFile, InputFile};
use crate::file::ExpectFile;
use crate::form::{CaseName, Name, Time, from_optional_text, from_text};

/// The only version of the format so far.
pub const VERSION: u32 = 1;

/// `lessons.toml`: what operators are trained in.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LessonsFile {
    /// Version of the format: 1.
    pub version: u32,
    /// Prepared states: the initial conditions of lessons.
    #[serde(default, rename = "start")]
    #[schemars(with = "Vec<StartFile>")]
    pub starts: Vec<Spanned<StartFile>>,
    /// The lessons.
    #[serde(default, rename = "lesson")]
    #[schemars(with = "Vec<LessonFile>")]
    pub lessons: Vec<Spanned<LessonFile>>,
}

/// One `[[start]]`: the state of the session at a time of a run without anybody at the panels.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StartFile {
    /// Its name; unique.
    #[schemars(with = "String")]
    pub name: Spanned<String>,
    /// What it is, in one line.
    pub about: Option<String>,
    /// When, in virtual time of that run.
    #[serde(deserialize_with = "from_text")]
    #[schemars(with = "Time")]
    pub at: VirtualTime,
    /// The case of `cases.toml` that is run; the scenario as it is if absent.
    #[schemars(with = "Option<String>")]
    pub case: Option<Spanned<String>>,
}

/// One `[[lesson]]`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LessonFile {
    /// Its name: letters, digits, `-`, `_` and `.`; unique.
    #[schemars(with = "CaseName")]
    pub name: Spanned<String>,
    /// What the trainee reads.
    pub about: Option<String>,
    /// The `[[start]]` with which it begins.
    #[schemars(with = "String")]
    pub start: Spanned<String>,
    /// The `[[view]]` of the scenario from which its pages see the machine at first.
    #[schemars(with = "Option<String>")]
    pub view: Option<Spanned<String>>,
    /// How long it lasts at most.
    #[serde(deserialize_with = "from_text")]
    #[schemars(with = "Time")]
    pub lasts: TimeSpan,
    /// It is over as soon as this holds: a formula on one image.
    #[schemars(with = "Option<String>")]
    pub done: Option<Spanned<String>>,
    /// What goes wrong, and what is to be done about it.
    #[serde(default, rename = "malfunction")]
    #[schemars(with = "Vec<MalfunctionFile>")]
    pub malfunctions: Vec<Spanned<MalfunctionFile>>,
    /// An operator's inputs that come by themselves.
    #[serde(default, rename = "input")]
    #[schemars(with = "Vec<InputFile>")]
    pub inputs: Vec<Spanned<InputFile>>,
    /// Expectations of the scenario that do not count here.
    #[serde(default)]
    #[schemars(with = "Vec<String>")]
    pub waive: Vec<Spanned<String>>,
    /// What counts in addition. Formulas begin at the start of the lesson.
    #[serde(default)]
    pub expect: Vec<ExpectFile>,
    /// What the trainee must not do, or not often.
    #[serde(default, rename = "mistake")]
    #[schemars(with = "Vec<MistakeFile>")]
    pub mistakes: Vec<Spanned<MistakeFile>>,
    /// What it costs.
    #[serde(default, rename = "cost")]
    #[schemars(with = "Vec<CostFile>")]
    pub costs: Vec<Spanned<CostFile>>,
    /// What an expert did: a recording, or a file of its events, within the scenario's folder.
    #[schemars(with = "Option<PathBuf>")]
    pub expert: Option<Spanned<PathBuf>>,
}

/// Something that the trainee must not do, as an acknowledgement without an alarm.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MistakeFile {
    /// Its name; unique in its lesson.
    #[schemars(with = "String")]
    pub name: Spanned<String>,
    /// A formula on one image; a mistake is made each time it becomes true.
    #[schemars(with = "String")]
    pub when: Spanned<String>,
    /// It is none if this formula holds then, or held in the image before.
    #[schemars(with = "Option<String>")]
    pub unless: Option<Spanned<String>>,
    /// How many are forgiven.
    #[serde(default)]
    pub at_most: u32,
}

/// Something that goes wrong: `fault`, `disturbance` or `force`, as in a case.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MalfunctionFile {
    /// Its name; unique in its lesson.
    #[schemars(with = "String")]
    pub name: Spanned<String>,
    /// A component that fails.
    #[schemars(with = "Option<FaultFile>")]
    pub fault: Option<Spanned<FaultFile>>,
    /// A signal that does not arrive as it was sent.
    #[schemars(with = "Option<DisturbanceFile>")]
    pub disturbance: Option<Spanned<DisturbanceFile>>,
    /// A signal that is held.
    #[schemars(with = "Option<ForceFile>")]
    pub force: Option<Spanned<ForceFile>>,
    /// It does not come by itself: the trainer begins the `fault` or the `disturbance`.
    #[serde(default)]
    pub by_trainer: bool,
    /// The trainee knows what it is as soon as this holds, as an acknowledgement.
    #[schemars(with = "Option<String>")]
    pub identify: Option<Spanned<String>>,
    /// The trainee also knows as soon as this panel is opened, which is a page.
    #[schemars(with = "Option<String>")]
    pub identify_page: Option<Spanned<String>>,
    /// How long that may take.
    #[serde(default, deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub identify_within: Option<TimeSpan>,
    /// The trainee has done what is to be done as soon as this holds.
    #[schemars(with = "Option<String>")]
    pub act: Option<Spanned<String>>,
    /// How long that may take.
    #[serde(default, deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub act_within: Option<TimeSpan>,
}

/// What a lesson costs: a number made of signals.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CostFile {
    /// Its name; unique in its lesson.
    #[schemars(with = "String")]
    pub name: Spanned<String>,
    /// The signals; several are added. Ranges are allowed.
    #[schemars(with = "Vec<Name>")]
    pub signals: Vec<Spanned<SignalName>>,
    /// What of them counts.
    pub of: CostKind,
}

/// What counts of a signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum CostKind {
    /// By how much it has grown, all in all; what it falls in between does not count.
    Rise,
    /// By how much it has fallen, all in all.
    Fall,
    /// Its greatest value.
    Greatest,
    /// Its integral over time, in its unit times seconds.
    Integral,
}
