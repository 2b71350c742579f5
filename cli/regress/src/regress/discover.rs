//! Which scenarios and sources are meant by what was typed.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use onescan_base::notice::NOTICE;
use onescan_base::regular;
use onescan_iec::input::kind::FileKind;
use onescan_scenario::case::OWN_ENDING;
use onescan_scenario::handed_out::is_solution;
use onescan_scenario::load::FILE_NAME;

use super::error::TestError;
use onescan_runner::error::{Unreadable, Usage};

/// Scenarios and sources, each once, in the order in which they were named; what a folder holds by name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Found {
    /// Folders of scenarios; files, for those of other names.
    pub scenarios: Vec<PathBuf>,
    /// PLC sources, which are one program together.
    pub sources: Vec<PathBuf>,
    /// Folders of tasks that were found in a folder: their programs are yet to be written, and their solutions are scenarios.
    pub tasks: Vec<PathBuf>,
}

impl Found {
    /// What is behind `paths`. A folder stands for the scenarios in it and below it, with those of other names that have cases
    /// of their own; if there are none, for the PLC sources there.
    ///
    /// # Errors
    /// A path that is not there or is of no kind that is tested.
    pub fn behind(paths: &[PathBuf]) -> Result<Self, TestError> {
        let mut found = Self::default();
        for path in paths {
            found.path(path)?;
        }
        let mut seen = BTreeSet::new();
        let mut once = |path: &PathBuf| seen.insert(path.canonicalize().unwrap_or_else(|_| path.clone()));
        found.scenarios.retain(&mut once);
        found.sources.retain(&mut once);
        if let [first, others @ ..] = &found.tasks[..] {
            let more = if others.is_empty() { String::new() } else { format!(" and {} more", others.len()) };
            tracing::info!(
                target: NOTICE,
                "{}{more}: a task's program is yet to be written; its solutions are tested, `onescan grade` marks others",
                first.display()
            );
        }
        Ok(found)
    }

    fn path(&mut self, path: &Path) -> Result<(), TestError> {
        let meta = std::fs::metadata(path).map_err(Unreadable::at(path))?;
        if meta.is_dir() {
            let before = self.scenarios.len();
            gather(path, self)?;
            if self.scenarios.len() == before && self.tasks.is_empty() {
                self.sources.push(path.to_owned());
            }
        } else if path.file_name().is_some_and(|name| name == FILE_NAME) {
            let folder = path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
            self.scenarios.push(folder.to_owned());
        } else if path.extension().is_some_and(|ending| ending == "toml") {
            self.scenarios.push(path.to_owned());
        } else if FileKind::of(path).is_some() {
            self.sources.push(path.to_owned());
        } else {
            let help = format!("name a scenario's folder, its `{FILE_NAME}`, or PLC sources as in `plc/*.st`");
            return Err(Usage::new(format!("{} is nothing that can be tested", path.display()), Some(help)).into());
        }
        Ok(())
    }
}

/// Folders that are passed over: what a build leaves behind, and what scenarios are made from.
const PASSED_OVER: [&str; 3] = ["target", "node_modules", "templates"];

/// All scenarios in a folder and below it, without hidden folders.
fn gather(folder: &Path, found: &mut Found) -> Result<(), TestError> {
    if folder.join(FILE_NAME).is_file() {
        if is_task(folder) {
            found.tasks.push(folder.to_owned());
            found.scenarios.extend(solutions(folder)?);
        } else {
            found.scenarios.push(folder.to_owned());
            found.scenarios.extend(with_own_cases(folder)?);
        }
        return Ok(());
    }
    let failed = Unreadable::at(folder);
    let mut inner = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(&failed)? {
        let path = entry.map_err(&failed)?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        // A link may lead in a circle.
        if path.is_dir() && !path.is_symlink() && !name.starts_with('.') && !PASSED_OVER.contains(&name.as_ref()) {
            inner.push(path);
        }
    }
    inner.sort();
    inner.iter().try_for_each(|folder| gather(folder, found))
}

/// True for a scenario whose expectations have marks: a task, which `onescan grade` judges.
fn is_task(folder: &Path) -> bool {
    let has_marks = |file: &str| {
        // What cannot be read is reported as a scenario.
        let text = regular::read_text(&folder.join(file)).ok();
        text.is_some_and(|text| text.lines().any(|line| is_key(line, "marks")))
    };
    has_marks(FILE_NAME) || has_marks("cases.toml")
}

fn is_key(line: &str, key: &str) -> bool {
    line.trim_start().strip_prefix(key).is_some_and(|rest| rest.trim_start().starts_with('='))
}

/// The scenarios of a task's folder with its solutions, by name.
fn solutions(folder: &Path) -> Result<Vec<PathBuf>, TestError> {
    let failed = Unreadable::at(folder);
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(&failed)? {
        let name = entry.map_err(&failed)?.file_name();
        found.extend(is_solution(&name.to_string_lossy()).then(|| folder.join(name)));
    }
    found.sort();
    Ok(found)
}

/// The scenarios of other names in a folder that have cases of their own, by name.
fn with_own_cases(folder: &Path) -> Result<Vec<PathBuf>, TestError> {
    let failed = Unreadable::at(folder);
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(&failed)? {
        let name = entry.map_err(&failed)?.file_name();
        let scenario = name.to_string_lossy().strip_suffix(OWN_ENDING).map(|name| folder.join(format!("{name}.toml")));
        found.extend(scenario.filter(|scenario| scenario.is_file()));
    }
    found.sort();
    Ok(found)
}
