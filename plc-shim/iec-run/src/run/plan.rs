//! Tasks and the programs they run (2nd ed. 2.7.2).

use std::collections::BTreeSet;

use onescan_base::TimeSpan;
use onescan_iec::task_plan::{Task, TaskPlan};
use thiserror::Error;

use crate::application::Application;
use onescan_iec::diagnostic::did_you_mean;
use onescan_iec::ir::ElementaryType;

impl Application {
    /// A plan with one task that runs all programs in their order, those left out that a program calls.
    pub fn single_task(&self, interval: TimeSpan) -> TaskPlan {
        let programs = self.programs().filter(|program| !program.is_called);
        let programs = programs.map(|program| program.name).collect();
        TaskPlan::new(vec![Task { name: "main".to_owned(), interval: Some(interval), programs, ..Task::default() }])
    }
}

impl Application {
    /// Whether a PLC can run `plan`, without setting it up.
    ///
    /// # Errors
    /// Tasks, programs and triggers that are not there.
    pub fn check_plan(&self, plan: &TaskPlan) -> Result<(), RunError> {
        resolve(plan, self).map(|_| ())
    }
}

/// Why a PLC cannot be set up.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum RunError {
    /// There is nothing to run.
    #[error("the plan has no tasks")]
    NoTasks,
    /// Two tasks share a name.
    #[error("there are two tasks `{0}`")]
    DuplicateTask(String),
    /// Nothing makes a task due.
    #[error("task `{0}` has neither an interval nor a trigger")]
    NeverDue(String),
    /// A program that the application lacks.
    #[error("task `{task}` runs program `{program}`, which is not declared{}", suffix(.help.as_ref()))]
    UnknownProgram {
        task: String,
        /// The program's name as given.
        program: String,
        help: Option<String>,
    },
    /// A program that a start calls.
    #[error("task `{task}` runs `{program}`, which every start runs once; take it out of the task")]
    RunsAtStart { task: String, program: String },
    /// A program has one instance, which belongs to one task.
    #[error("program `{program}` runs in two tasks, `{task}` is the second")]
    ProgramTwice { program: String, task: String },
    /// A task's trigger is not a variable.
    #[error("task `{task}` is triggered by `{path}`: {reason}")]
    Trigger {
        task: String,
        /// The path as given.
        path: String,
        /// What is wrong with it.
        reason: String,
    },
    /// The module was refused, most often because a unit is too large.
    #[error("the program cannot be made to run: {0}")]
    Module(String),
    /// The system does not give the memory.
    #[error("there is no memory for the program: {0}")]
    Memory(String),
}

fn suffix(help: Option<&String>) -> String {
    help.map(|help| format!(" ({help})")).unwrap_or_default()
}

/// Name under which [`TaskPlan::background`] appears in errors.
const BACKGROUND: &str = "background";

/// A plan whose names have been looked up.
pub(super) struct Resolved {
    /// What each task runs.
    pub(super) tasks: Vec<Vec<usize>>,
    /// Offset of each task's trigger.
    pub(super) singles: Vec<Option<usize>>,
    /// What runs at each scan's end.
    pub(super) background: Vec<usize>,
}

pub(super) fn resolve(plan: &TaskPlan, application: &Application) -> Result<Resolved, RunError> {
    if plan.tasks.is_empty() && plan.background.is_empty() {
        return Err(RunError::NoTasks);
    }
    let mut names = BTreeSet::new();
    let mut running = BTreeSet::new();
    let mut resolved = Resolved { tasks: Vec::new(), singles: Vec::new(), background: Vec::new() };
    for task in &plan.tasks {
        if !names.insert(task.name.to_ascii_uppercase()) {
            return Err(RunError::DuplicateTask(task.name.clone()));
        }
        if task.interval.is_none() && task.single.is_none() {
            return Err(RunError::NeverDue(task.name.clone()));
        }
        resolved.tasks.push(entries(application, &task.name, &task.programs, &mut running)?);
        resolved.singles.push(trigger(application, task)?);
    }
    debug_assert_eq!(resolved.tasks.len(), plan.tasks.len(), "what tasks run is found by their positions in the plan");
    debug_assert_eq!(resolved.singles.len(), plan.tasks.len(), "triggers are found by the positions of their tasks");
    resolved.background = entries(application, BACKGROUND, &plan.background, &mut running)?;
    Ok(resolved)
}

fn entries(
    application: &Application,
    task: &str,
    names: &[String],
    running: &mut BTreeSet<usize>,
) -> Result<Vec<usize>, RunError> {
    let mut found = Vec::new();
    for name in names {
        let index = entry(application, task, name)?;
        if application.runs_at_start(index) {
            return Err(RunError::RunsAtStart { task: task.to_owned(), program: name.clone() });
        }
        if !running.insert(index) {
            return Err(RunError::ProgramTwice { program: name.clone(), task: task.to_owned() });
        }
        found.push(index);
    }
    Ok(found)
}

fn entry(application: &Application, task: &str, name: &str) -> Result<usize, RunError> {
    application.entry_index(name).ok_or_else(|| RunError::UnknownProgram {
        task: task.to_owned(),
        program: name.to_owned(),
        help: did_you_mean(name, application.entry_names()),
    })
}

fn trigger(application: &Application, task: &Task) -> Result<Option<usize>, RunError> {
    let Some(path) = &task.single else { return Ok(None) };
    let wrong = |reason| RunError::Trigger { task: task.name.clone(), path: path.clone(), reason };
    let variable = application.variable(path).map_err(|error| wrong(error.to_string()))?;
    if variable.ty != Some(ElementaryType::Bool) {
        return Err(wrong(format!("it is {}, not BOOL", variable.type_name)));
    }
    Ok(Some(variable.offset as usize))
}
