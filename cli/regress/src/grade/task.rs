//! A task: a scenario, its cases and those that only the teacher has, and what each expectation is worth.

use std::path::{Path, PathBuf};

use onescan_base::regular;
use onescan_iec::Input;
use onescan_runner::error::{Unreadable, Usage};
use onescan_scenario::case::{Case, Catalogue};
use onescan_scenario::expectations::{Owner, Worth};
use onescan_scenario::file::ClientFile;
use onescan_scenario::handed_out::is_solution;
use onescan_scenario::{Scenario, ScenarioError};
use onescan_server::signal::{ClientName, did_you_mean};

use super::config::TaskConfig;
use super::error::GradeError;

/// A task.
pub(super) struct Task {
    pub(super) scenario: Scenario,
    /// The soft PLC whose program is handed in.
    pub(super) client: ClientName,
    /// All cases, those of the task first.
    pub(super) cases: Vec<TaskCase>,
    /// What is marked, in the order of the files: the scenario's expectations first.
    pub(super) items: Vec<Item>,
    /// The programs that are solutions.
    pub(super) solutions: Vec<Vec<Input>>,
    /// The cases of the task, then those of each hidden file.
    catalogues: Vec<Catalogue>,
}

/// A case in which programs are judged.
pub(super) struct TaskCase {
    pub(super) name: String,
    /// True for one that only the teacher has.
    pub(super) is_hidden: bool,
    /// What each expectation of the case is among all that is marked, in their order.
    pub(super) judged: Vec<usize>,
    catalogue: usize,
    case: Case,
}

/// An expectation that is marked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Item {
    pub(super) name: String,
    /// The entry of `cases.toml` that it is of; nothing for one of the scenario, which is judged in every case.
    pub(super) case: Option<String>,
    /// True for one that only the teacher has.
    pub(super) is_hidden: bool,
    pub(super) worth: Worth,
    /// The catalogue and the entry that it is of.
    of: Option<(usize, usize)>,
}

impl Item {
    /// Its name among those of all cases.
    pub(super) fn title(&self) -> String {
        self.case.as_ref().map_or_else(|| self.name.clone(), |case| format!("{case}: {}", self.name))
    }
}

impl Task {
    /// Reads a task.
    ///
    /// # Errors
    /// It is wrong, or has nothing that could be marked.
    pub(super) fn open(config: &TaskConfig) -> Result<Self, GradeError> {
        let scenario = Scenario::load(&config.task)?;
        let client = client(&scenario, config.client.as_ref())?;
        let mut catalogues = vec![scenario.catalogue()?];
        for path in files_of(&config.hidden)? {
            let text = regular::read_text(&path).map_err(Unreadable::at(&path))?;
            catalogues.push(Catalogue::parse(path, text)?);
        }
        let solutions = solutions(config, &scenario, &client)?;
        let mut task = Self { scenario, client, cases: Vec::new(), items: Vec::new(), solutions, catalogues };
        task.gather(config)?;
        if task.marks() == 0 {
            let help = "write `marks = 5` at expectations of scenario.toml and cases.toml (docs/grading.md)".to_owned();
            return Err(Usage::new("no expectation of the task has marks", Some(help)).into());
        }
        Ok(task)
    }

    /// The marks of a program that meets everything.
    pub(super) fn marks(&self) -> u32 {
        self.items.iter().map(|item| item.worth.marks).sum()
    }

    /// `scenario`, which is the task with some program, as a case wants it.
    ///
    /// # Errors
    /// The case names what the program does not have.
    pub(super) fn applied(&self, scenario: &Scenario, case: &TaskCase) -> Result<Scenario, ScenarioError> {
        scenario.clone().with_case(&self.catalogues[case.catalogue], &case.case)
    }

    /// Takes in the cases that are chosen, and what they are judged by.
    fn gather(&mut self, config: &TaskConfig) -> Result<(), GradeError> {
        for number in 0..self.catalogues.len() {
            // The default case of a file without cases is the task's own.
            let is_hidden = number > 0;
            for case in self.catalogues[number].cases().to_vec() {
                if (is_hidden && case.entry.is_none()) || !config.selection.has_tags(&case.tags) {
                    continue;
                }
                self.refuse(&case)?;
                self.take(number, case)?;
            }
        }
        if self.cases.is_empty() {
            let help = Some("see `--tag` and `--skip-tag`".to_owned());
            return Err(Usage::new("none of the cases of the task is chosen", help).into());
        }
        Ok(())
    }

    /// Refuses a case that cannot be one of a task.
    fn refuse(&self, case: &Case) -> Result<(), Usage> {
        if !case.code.is_empty() {
            let help = Some("leave `[[case.code]]` out of a task: what is handed in is the program".to_owned());
            return Err(Usage::new(format!("case `{}` has a program of its own", case.name), help));
        }
        if self.cases.iter().any(|known| known.name.eq_ignore_ascii_case(&case.name)) {
            let help = Some("give the hidden one another name".to_owned());
            return Err(Usage::new(format!("two cases are called `{}`", case.name), help));
        }
        Ok(())
    }

    fn take(&mut self, catalogue: usize, case: Case) -> Result<(), GradeError> {
        let applied = self.scenario.clone().with_case(&self.catalogues[catalogue], &case)?;
        // The values of a matrix stand behind the name of their entry.
        let entry = case.name.split_once(',').map_or(case.name.as_str(), |(entry, _)| entry).to_owned();
        let mut judged = Vec::new();
        for (name, _) in &applied.expectations().named {
            let worth = applied.expectations().worth.get(name).cloned();
            let worth = worth.ok_or_else(|| without_worth(name, &case.name))?;
            let of = case.entry.filter(|_| worth.owner == Owner::Case).map(|entry| (catalogue, entry));
            let is_hidden = of.is_some() && catalogue > 0;
            let item = Item { name: name.clone(), case: of.map(|_| entry.clone()), is_hidden, worth, of };
            let known = self.items.iter().position(|known| known.of == item.of && known.name == item.name);
            judged.push(known.unwrap_or_else(|| {
                self.items.push(item);
                self.items.len() - 1
            }));
        }
        self.cases.push(TaskCase { name: case.name.clone(), is_hidden: catalogue > 0, judged, catalogue, case });
        Ok(())
    }
}

/// Each expectation that is read has its worth, be it of no marks; one without would be graded by a guess.
fn without_worth(name: &str, case: &str) -> Usage {
    let help = "this is a fault of onescan, which reads marks with each expectation: please report it".to_owned();
    Usage::new(format!("nothing says what the expectation `{name}` of case `{case}` is worth"), Some(help))
}

/// The soft PLC whose program is handed in.
fn client(scenario: &Scenario, wanted: Option<&ClientName>) -> Result<ClientName, Usage> {
    for (name, client) in &scenario.file().clients {
        if let ClientFile::External { .. } | ClientFile::OpcUa { .. } | ClientFile::Gateway { .. } = client.get_ref() {
            let help =
                "a task has plants, operators and soft PLCs only, so that every machine gives equal marks".to_owned();
            return Err(Usage::new(format!("client `{name}` of the task is not in this program"), Some(help)));
        }
    }
    let names: Vec<&ClientName> = scenario.plcs().map(|plc| plc.name).collect();
    match (wanted, &names[..]) {
        (Some(wanted), _) if names.contains(&wanted) => Ok(wanted.clone()),
        (Some(wanted), _) => {
            let help = did_you_mean(wanted.as_str(), names.iter().map(|name| name.as_str()));
            Err(Usage::new(format!("the task has no soft PLC `{wanted}`"), help))
        }
        (None, [only]) => Ok((*only).clone()),
        (None, []) => Err(Usage::new("the task has no soft PLC whose program could be handed in", None)),
        (None, several) => {
            let names: Vec<&str> = several.iter().map(|name| name.as_str()).collect();
            let help = Some(format!("say whose program is handed in: `--client {}`", names[0]));
            Err(Usage::new(format!("the task has {} soft PLCs: {}", names.len(), names.join(", ")), help))
        }
    }
}

/// The files among `paths`, and those with cases in the folders among them, by name.
fn files_of(paths: &[PathBuf]) -> Result<Vec<PathBuf>, GradeError> {
    let mut files = Vec::new();
    for path in paths {
        if !path.is_dir() {
            files.push(path.clone());
            continue;
        }
        let found = files_in(path, |name| Path::new(name).extension().is_some_and(|ending| ending == "toml"))?;
        if found.is_empty() {
            let help = Some("hidden cases are files `*.toml` in the form of cases.toml".to_owned());
            return Err(Usage::new(format!("there are no cases in {}", path.display()), help).into());
        }
        files.extend(found);
    }
    Ok(files)
}

/// The programs of the scenarios with solutions that are named, or stand beside the task.
fn solutions(config: &TaskConfig, task: &Scenario, client: &ClientName) -> Result<Vec<Vec<Input>>, GradeError> {
    let folder = if task.folder() == Path::new("") { Path::new(".") } else { task.folder() };
    let paths = match &config.solutions[..] {
        [] => files_in(folder, is_solution)?,
        named => named.to_vec(),
    };
    paths.iter().map(|path| Ok(Scenario::load(path)?.program(client)?)).collect()
}

/// The files of a folder whose names are wanted, in the order of names.
fn files_in(folder: &Path, is_wanted: impl Fn(&str) -> bool) -> Result<Vec<PathBuf>, Unreadable> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(Unreadable::at(folder))? {
        let path = entry.map_err(Unreadable::at(folder))?.path();
        let is_it = path.file_name().is_some_and(|name| is_wanted(&name.to_string_lossy()));
        if is_it && path.is_file() {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}
