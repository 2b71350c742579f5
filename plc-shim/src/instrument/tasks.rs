//! The task table: which programs run in which task, and the number of each.

use std::collections::BTreeSet;

use crate::diagnostic::did_you_mean;
use crate::run::{RunError, Task};
use crate::syntax::ast::Pou;

/// Tasks in the order in which they come when all are due, and their programs, numbered from 1 in the
/// same order.
#[derive(Debug, Default)]
pub(super) struct TaskTable<'a> {
    pub(super) rows: Vec<Row>,
    pub(super) programs: Vec<&'a Pou>,
}

/// One task.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Row {
    pub(super) interval_ns: u64,
    pub(super) priority: u32,
    /// Number of its first program.
    pub(super) first: usize,
    /// How many programs it has.
    pub(super) count: usize,
}

impl<'a> TaskTable<'a> {
    /// Puts the tasks in order.
    ///
    /// # Errors
    /// What would be wrong with the tasks in a soft PLC is wrong here.
    pub(super) fn new(tasks: &[Task], programs: &[&'a Pou]) -> Result<Self, RunError> {
        check(tasks)?;
        let mut order: Vec<&Task> = tasks.iter().collect();
        order.sort_by_key(|task| task.priority);
        let mut table = Self::default();
        for task in order {
            let first = table.programs.len() + 1;
            for name in &task.programs {
                let program = find(name, task, programs)?;
                if table.programs.iter().any(|other| other.name.key() == program.name.key()) {
                    return Err(RunError::ProgramTwice { program: name.clone(), task: task.name.clone() });
                }
                table.programs.push(program);
            }
            let count = table.programs.len() + 1 - first;
            let Task { interval_ns, priority, .. } = *task;
            table.rows.push(Row { interval_ns, priority, first, count });
        }
        Ok(table)
    }

    /// What the scheduler's names stand for.
    pub(super) fn names(&self) -> Vec<(&'static str, String)> {
        let list = |value: &dyn Fn(&Row) -> u64| {
            let values: Vec<String> = self.rows.iter().map(|row| value(row).to_string()).collect();
            values.join(", ")
        };
        vec![
            ("SDSP_PROGRAMS", self.programs.len().to_string()),
            ("SDSP_TASKS", self.rows.len().to_string()),
            ("SDSP_INTERVALS", list(&|row| row.interval_ns)),
            ("SDSP_PRIORITIES", list(&|row| u64::from(row.priority))),
            ("SDSP_FIRSTS", list(&|row| row.first as u64)),
            ("SDSP_COUNTS", list(&|row| row.count as u64)),
        ]
    }
}

fn check(tasks: &[Task]) -> Result<(), RunError> {
    if tasks.is_empty() {
        return Err(RunError::NoTasks);
    }
    let mut names = BTreeSet::new();
    for task in tasks {
        if !names.insert(task.name.to_ascii_uppercase()) {
            return Err(RunError::DuplicateTask(task.name.clone()));
        }
        if task.interval_ns == 0 {
            return Err(RunError::ZeroInterval(task.name.clone()));
        }
    }
    Ok(())
}

fn find<'a>(name: &str, task: &Task, programs: &[&'a Pou]) -> Result<&'a Pou, RunError> {
    let found = programs.iter().find(|program| program.name.text.eq_ignore_ascii_case(name));
    found.copied().ok_or_else(|| RunError::UnknownProgram {
        task: task.name.clone(),
        program: name.to_owned(),
        help: did_you_mean(name, programs.iter().map(|program| program.name.text.as_str())),
    })
}
