//! Cases: one scenario, tried in many ways. They stand in `cases.toml` beside `scenario.toml`.
//!
//! | module | subject |
//! |---|---|
//! | [`file`] | `[[case]]` as it is written |
//! | [`campaign_file`] | `[[campaign]]` as it is written |
//! | [`cases_file`] | `cases.toml` as it is written |
//! | [`catalogue`] | the file read; all cases, those of matrices one by one |
//! | [`matrix`] | every combination of values |
//! | [`campaign`] | every fault with every activation, as cases |
//! | [`value`] | TOML values as those of signals and variables |
//! | [`written`] | a case in pieces, and as text again |
//!
//! How a case is put on its scenario is in `apply`, beside this room.
//!
//! A scenario without the file, and one whose file names no case, has one case, called
//! [`DEFAULT`]: the scenario as it is.

pub mod campaign;
pub mod campaign_file;
pub mod cases_file;
pub mod catalogue;
pub mod file;
pub mod matrix;
pub mod value;
pub mod written;

use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};

use onescan_iec::source::LineColumn;
use onescan_server::signal::ClientName;
use onescan_server::time::VirtualTime;
use onescan_server::timeline::Scheduled;
use toml::Spanned;

use crate::base;
use crate::error::ScenarioError;
use crate::file::FILE_NAME as SCENARIO_NAME;

pub use campaign::{Campaign, Injection};
pub use campaign_file::{CampaignVerdict, FaultKind};
pub use catalogue::Catalogue;
pub use file::CodeFile;

/// The one case of a scenario that names none.
pub const DEFAULT: &str = "default";
/// The file beside `scenario.toml`.
pub const FILE_NAME: &str = "cases.toml";
/// What the file with the cases of another scenario of the folder ends with.
pub const OWN_ENDING: &str = ".cases.toml";

/// The file with the cases of the scenario in `path`, a folder or a file: `cases.toml` beside it. A scenario in a file of another
/// name than usual has its own, as `serial.toml` those of `serial.cases.toml`, if that file is there; else it has those of its
/// nearest base that has some.
///
/// # Errors
/// A base cannot be read.
pub fn beside(path: &Path) -> Result<PathBuf, ScenarioError> {
    let file = if path.is_dir() { path.join(SCENARIO_NAME) } else { path.to_owned() };
    if let Some(own) = own_cases(&file).find(|own| own.is_file()) {
        return Ok(own);
    }
    let mut chain = vec![file];
    // There may be cases without a scenario.
    if chain[0].is_file() {
        chain.extend(base::bases(&chain[0])?);
    }
    let usual = |file: &PathBuf| file.with_file_name(FILE_NAME);
    let found =
        chain.iter().flat_map(|file| own_cases(file)).chain(chain.iter().map(usual)).find(|cases| cases.is_file());
    Ok(found.unwrap_or_else(|| usual(&chain[0])))
}

/// The files with cases that are those of the scenario in `file` alone.
fn own_cases(file: &Path) -> impl Iterator<Item = PathBuf> {
    let name = file.file_stem().map(|name| file.with_file_name(format!("{}{OWN_ENDING}", name.to_string_lossy())));
    let usual = file.file_name().is_some_and(|name| name == SCENARIO_NAME).then(|| file.with_file_name(FILE_NAME));
    name.into_iter().chain(usual)
}

/// A value that a case sets, by the path of what it sets.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// The client, then what the client calls it: `plant.actuator_1.speed_m_s`, `plc.Shear.Strokes`.
    pub path: String,
    pub value: toml::Value,
    /// Where it stands in `cases.toml`.
    pub place: Range<usize>,
}

/// One case, its matrix resolved.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Case {
    /// Its name, which is also that of its snapshot's file.
    pub name: String,
    /// What it is about.
    pub about: Option<String>,
    /// Words to choose it by.
    pub tags: Vec<String>,
    /// What chance begins with, if not what the scenario says.
    pub seed: Option<u64>,
    /// When its run is complete, if not when the scenario says.
    pub until: Option<VirtualTime>,
    /// Parameters of plants and initial values of PLCs.
    pub settings: Vec<Setting>,
    /// What is another in the programs of PLCs than in the scenario's.
    pub code: Vec<Spanned<CodeFile>>,
    /// The entry of `cases.toml` it comes from; nothing for the default case.
    pub entry: Option<usize>,
    /// What is a campaign's of it, if it is one of a campaign.
    pub injection: Option<Injection>,
}

/// What a case does to a scenario once it is bound to its signals.
#[derive(Clone, Debug, Default)]
pub struct Applied {
    pub case: Case,
    /// What it does while the session runs.
    pub timeline: Vec<Scheduled>,
    /// The part of that which a campaign brings in.
    pub injected: Vec<Scheduled>,
    /// Failures of components, which can be checked only when their plants are read.
    pub failures: Vec<FailureAt>,
    /// Parameters that change, which can be checked only when their plants are read.
    pub parameters: Vec<ParameterAt>,
    /// Variables that it writes or forces, which can be checked only when their PLCs are made.
    pub variables: Vec<VariableAt>,
    /// Tasks that run late, which can be checked only when their PLCs are made.
    pub tasks: Vec<TaskAt>,
    /// Other programs in its PLCs; the texts in them can be checked only when the sources are read.
    pub code: Vec<CodeAt>,
    /// `cases.toml`, for errors that are found when clients are made.
    pub source: (String, String),
}

/// A component's failure in a case.
#[derive(Clone, Debug, PartialEq)]
pub struct FailureAt {
    pub client: ClientName,
    pub component: String,
    pub mode: String,
    /// Where it stands in `cases.toml`.
    pub place: Range<usize>,
}

/// A parameter's value in a case.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterAt {
    pub client: ClientName,
    pub component: String,
    pub parameter: String,
    /// Its value, as text.
    pub value: String,
    /// Where it stands in `cases.toml`.
    pub place: Range<usize>,
}

/// A variable's value in a case.
#[derive(Clone, Debug, PartialEq)]
pub struct VariableAt {
    pub client: ClientName,
    pub variable: String,
    /// Its value, as a literal.
    pub value: String,
    /// Where it stands in `cases.toml`.
    pub place: Range<usize>,
}

/// Another program in a PLC.
#[derive(Clone, Debug, PartialEq)]
pub struct CodeAt {
    pub client: ClientName,
    /// Its source, as the scenario names it.
    pub source: String,
    /// What is another in it.
    pub change: CodeChange,
    /// Where it stands in `cases.toml`.
    pub place: Range<usize>,
}

/// What is another in a source.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum CodeChange {
    /// All of it: this file comes in its place.
    File(String),
    Text {
        /// Where it begins, as the author of the source sees it.
        at: LineColumn,
        was: String,
        /// What comes in its place.
        is: String,
    },
}

impl fmt::Display for CodeChange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(by) => f.write_str(by),
            Self::Text { at: LineColumn { line, column }, was, is } => write!(f, "{line}:{column} {was:?} is {is:?}"),
        }
    }
}

/// A task that runs late in a case.
#[derive(Clone, Debug, PartialEq)]
pub struct TaskAt {
    pub client: ClientName,
    /// The task's name; all tasks if absent.
    pub task: Option<String>,
    /// Where it stands in `cases.toml`.
    pub place: Range<usize>,
}
