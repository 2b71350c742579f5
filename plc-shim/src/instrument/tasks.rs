//! The task table: which programs run in which task, and the number of each.

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
        let names: Vec<&str> = programs.iter().map(|program| program.name.text.as_str()).collect();
        let resolved = crate::run::resolve(tasks, &names)?;
        let mut order: Vec<(&Task, Vec<usize>)> = tasks.iter().zip(resolved).collect();
        order.sort_by_key(|(task, _)| task.priority);
        let mut table = Self { rows: Vec::new(), programs: Vec::new() };
        for (task, indices) in order {
            let first = table.programs.len() + 1;
            table.programs.extend(indices.iter().filter_map(|index| programs.get(*index).copied()));
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
