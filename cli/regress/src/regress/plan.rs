//! Units of work: each is one process.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use onescan_base::foreign::one_line;
use onescan_scenario::Scenario;
use onescan_scenario::case::Catalogue;
use onescan_scenario::file::ClientFile;
use onescan_scenario::permission::granted;

use super::config::TestConfig;
use super::discover::Found;
use super::error::TestError;
use crate::snapshot::store::{Place, reviewed};
use crate::snapshot::take::Choice;
use onescan_base::notice::NOTICE;
use onescan_runner::error::Usage;

/// What one process does.
#[derive(Clone, Debug, PartialEq)]
pub enum Unit {
    /// One case of a scenario.
    Case(CaseUnit),
    /// A scenario that cannot be read, with why.
    Unreadable { scenario: PathBuf, error: String },
    /// All test programs of these sources.
    Sources(Vec<PathBuf>),
}

/// One case of a scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct CaseUnit {
    /// The scenario's folder and the case.
    pub place: Place,
    /// What to choose it by.
    pub tags: Vec<String>,
    /// What its snapshot holds, and how exactly.
    pub choice: Choice,
    /// True for a case of `cases.toml`, false for the scenario as it is.
    pub is_named: bool,
}

impl Unit {
    /// What it is called in reports: the scenario's folder, or the sources.
    pub fn suite(&self) -> String {
        match self {
            Self::Case(CaseUnit { place: Place { scenario, .. }, .. }) | Self::Unreadable { scenario, .. } => {
                suite_of(scenario)
            }
            Self::Sources(paths) => {
                let [first, ..] = &paths[..] else { return String::new() };
                let common = first.parent().filter(|_| paths.len() > 1);
                common.map_or_else(|| shown(first), shown)
            }
        }
    }
}

/// A scenario in reports: its folder as it was typed, or its own name where that is `.`; one of several in a folder with its
/// name behind that.
pub fn suite_of(scenario: &Path) -> String {
    let typed = shown(scenario);
    if let Some(named) = typed.strip_suffix(".toml") {
        return named.to_owned();
    }
    let own = || std::path::absolute(scenario).ok()?.file_name().map(|name| name.to_string_lossy().into_owned());
    if typed == "." { own().unwrap_or(typed) } else { typed }
}

/// A folder as it was typed, without a `./` before it.
pub fn shown(path: &Path) -> String {
    let stripped = path.strip_prefix(".").unwrap_or(path);
    let text = stripped.to_string_lossy().replace('\\', "/");
    if text.is_empty() { ".".to_owned() } else { text }
}

/// The units that `config` asks for.
///
/// # Errors
/// Nothing is asked for that is there.
pub fn units(config: &TestConfig) -> Result<Vec<Unit>, TestError> {
    let found = Found::behind(&config.paths)?;
    let mut units = Vec::new();
    let mut left_out = 0;
    for scenario in &found.scenarios {
        match cases(scenario) {
            Ok(cases) => {
                let all = cases.len();
                let chosen: Vec<_> = cases.into_iter().filter(|case| is_chosen(config, case)).collect();
                left_out += all - chosen.len();
                units.extend(chosen.into_iter().map(Unit::Case));
            }
            Err(error) => {
                let error = format!("{:?}", miette::Report::new(error));
                units.push(Unit::Unreadable { scenario: scenario.clone(), error });
            }
        }
    }
    // The names of test programs are known once they are compiled.
    if !found.sources.is_empty() {
        units.push(Unit::Sources(found.sources));
    }
    match (units.is_empty(), left_out) {
        (false, _) => Ok(units),
        (true, 0) => {
            let help = "a scenario is a folder with a `scenario.toml`, and a program for a task is marked with `onescan grade`; \
                        test programs are in PLC sources";
            Err(Usage::new("there is nothing to test here", Some(help.to_owned())).into())
        }
        (true, _) => Err(none_chosen(&format!("none of {left_out} cases")).into()),
    }
}

/// Says which programs scenarios will start, as `run` does; each once, however many cases there are.
pub fn warn_of_programs(units: &[Unit]) {
    if granted().no_commands {
        return;
    }
    let scenarios = units.iter().filter_map(|unit| match unit {
        Unit::Case(unit) => Some(&unit.place.scenario),
        Unit::Sources(_) | Unit::Unreadable { .. } => None,
    });
    for folder in scenarios.collect::<BTreeSet<_>>() {
        // One that cannot be read is reported by its tests.
        let Ok(scenario) = Scenario::load(folder) else { continue };
        for (name, client) in &scenario.file().clients {
            if let ClientFile::External { command } | ClientFile::OpcUa { command, .. } = client.get_ref()
                && !command.is_empty()
            {
                let (words, folder) = (command.join(" "), shown(folder));
                let program = one_line(&words);
                tracing::info!(target: NOTICE, "tests of {folder} start a program for client `{name}`: {program}");
            }
        }
    }
}

fn cases(folder: &Path) -> Result<Vec<CaseUnit>, TestError> {
    let scenario = Scenario::load(folder)?;
    let catalogue = Catalogue::load(folder)?;
    let mut units = Vec::new();
    for case in catalogue.cases() {
        // What is wrong with a case is reported before anything runs.
        let choice = Choice::of(&scenario.clone().with_case(&catalogue, case)?, &catalogue)?;
        let place = Place { scenario: folder.to_owned(), case: case.name.clone() };
        units.push(CaseUnit { place, tags: case.tags.clone(), choice, is_named: case.entry.is_some() });
    }
    Ok(units)
}

fn is_chosen(config: &TestConfig, case: &CaseUnit) -> bool {
    config.selection.has_name(&suite_of(&case.place.scenario), &case.place.case)
        && config.selection.has_tags(&case.tags)
}

/// The error of a selection that leaves nothing.
pub(super) fn none_chosen(of: &str) -> Usage {
    let help = "see `--filter`, `--tag` and `--skip-tag`".to_owned();
    Usage::new(format!("{of} is chosen"), Some(help))
}

/// Reviewed snapshots of the scenarios tested that belong to no case any more.
///
/// # Errors
/// A folder cannot be read.
pub fn orphans(config: &TestConfig, units: &[Unit]) -> Result<Vec<PathBuf>, TestError> {
    // What was left out is not known here.
    if !config.selection.is_all() {
        return Ok(Vec::new());
    }
    let places: Vec<&Place> =
        units.iter().filter_map(|unit| if let Unit::Case(unit) = unit { Some(&unit.place) } else { None }).collect();
    let mut scenarios: Vec<&Path> = places.iter().map(|place| place.scenario.as_path()).collect();
    scenarios.dedup();
    let mut orphans = Vec::new();
    for scenario in scenarios {
        let unclaimed = reviewed(scenario)?.into_iter().filter(|place| !places.contains(&place));
        orphans.extend(unclaimed.map(|place| place.reviewed()));
    }
    Ok(orphans)
}
