//! Tasks and the programs they run (2nd ed. 2.7.2).

use std::collections::BTreeSet;

use thiserror::Error;

use crate::application::Application;
use crate::diagnostic::did_you_mean;

/// A periodic task. It is due at one interval after the start, then after each interval.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Task {
    /// Its name.
    pub name: String,
    /// Time between two executions, in nanoseconds.
    pub interval_ns: u64,
    /// Its rank among tasks that are due together; 0 comes first.
    pub priority: u32,
    /// The programs it runs, in their order.
    pub programs: Vec<String>,
}

/// What a PLC runs, and when.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TaskPlan {
    /// The tasks.
    pub tasks: Vec<Task>,
    /// How many units of WebAssembly fuel, about one for each instruction, a task may use in one
    /// execution before it counts as an endless loop.
    pub fuel_per_task: u64,
}

impl TaskPlan {
    /// Enough for half a second of instructions on a common machine.
    pub const DEFAULT_FUEL: u64 = 50_000_000;

    /// A plan with the default budget of instructions.
    pub fn new(tasks: Vec<Task>) -> Self {
        Self { tasks, fuel_per_task: Self::DEFAULT_FUEL }
    }

    /// One task that runs all programs of the application in their order.
    pub fn single(application: &Application, interval_ns: u64) -> Self {
        let programs = application.programs().map(|program| program.name).collect();
        Self::new(vec![Task { name: "main".to_owned(), interval_ns, priority: 0, programs }])
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
    /// A task would be due all the time.
    #[error("task `{0}` has an interval of 0")]
    ZeroInterval(String),
    /// A program that the application lacks.
    #[error("task `{task}` runs program `{program}`, which is not declared{}", suffix(.help.as_ref()))]
    UnknownProgram {
        /// The task.
        task: String,
        /// The program's name as given.
        program: String,
        /// The nearest name.
        help: Option<String>,
    },
    /// A program has one instance, which belongs to one task.
    #[error("program `{program}` runs in two tasks, `{task}` is the second")]
    ProgramTwice {
        /// The program.
        program: String,
        /// The second task.
        task: String,
    },
    /// The module was refused, most often because a unit is too large.
    #[error("the program cannot be made to run: {0}")]
    Module(String),
}

fn suffix(help: Option<&String>) -> String {
    help.map(|help| format!(" ({help})")).unwrap_or_default()
}

/// The programs of each task by position.
pub(super) fn resolve(plan: &TaskPlan, application: &Application) -> Result<Vec<Vec<usize>>, RunError> {
    if plan.tasks.is_empty() {
        return Err(RunError::NoTasks);
    }
    let mut names = BTreeSet::new();
    let mut running = BTreeSet::new();
    let mut resolved = Vec::new();
    for task in &plan.tasks {
        if !names.insert(task.name.to_ascii_uppercase()) {
            return Err(RunError::DuplicateTask(task.name.clone()));
        }
        if task.interval_ns == 0 {
            return Err(RunError::ZeroInterval(task.name.clone()));
        }
        let mut programs = Vec::new();
        for name in &task.programs {
            let index = program(application, task, name)?;
            if !running.insert(index) {
                let (program, task) = (name.clone(), task.name.clone());
                return Err(RunError::ProgramTwice { program, task });
            }
            programs.push(index);
        }
        resolved.push(programs);
    }
    Ok(resolved)
}

fn program(application: &Application, task: &Task, name: &str) -> Result<usize, RunError> {
    application.program_index(name).ok_or_else(|| {
        let known: Vec<String> = application.programs().map(|program| program.name).collect();
        RunError::UnknownProgram {
            task: task.name.clone(),
            program: name.to_owned(),
            help: did_you_mean(name, known.iter().map(String::as_str)),
        }
    })
}
