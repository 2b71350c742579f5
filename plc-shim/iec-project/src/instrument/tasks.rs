//! The task table: which programs run in which task, and the number of each.

use std::collections::BTreeSet;

use onescan_base::TimeSpan;
use onescan_base::duration::IecDuration;

use super::single::{self, Single};
use super::template::{self, Number};
use onescan_iec::diagnostic::did_you_mean;
use onescan_iec::syntax::ast::Pou;
use onescan_iec::task_plan::Task;
use onescan_iec_run::run::RunError;

/// What is due at every grant has this interval.
pub(super) const ALWAYS: TimeSpan = TimeSpan::nanos::<1>();
/// Interval of the scheduler where no task has one.
const DEFAULT: TimeSpan = TimeSpan::millis::<10>();

/// Tasks in the order in which they come when all are due, and their programs, numbered from 1 in the
/// same order.
#[derive(Debug)]
pub(super) struct TaskTable<'a> {
    pub(super) rows: Vec<Row>,
    pub(super) programs: Vec<Entry<'a>>,
    /// The interval of the scheduler's task: the shortest of all, of tasks without programs too.
    pub(super) shortest: TimeSpan,
    line: Line,
}

/// How the type of the line of programs is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum Line {
    /// By the name of its own that `iec/shim/line.st` declares.
    #[default]
    Named,
    InPlace,
}

/// A program that a task runs.
#[derive(Debug, Clone)]
pub(super) struct Entry<'a> {
    /// Its name, or that of its instance in the configuration.
    pub(super) name: String,
    pub(super) pou: &'a Pou,
}

#[derive(Debug, PartialEq, Eq)]
pub(super) struct Row {
    pub(super) interval: Option<TimeSpan>,
    pub(super) priority: u32,
    /// What starts it at its edges.
    pub(super) single: Option<Single>,
    /// Number of its first program.
    pub(super) first: usize,
    /// How many programs it has.
    pub(super) count: usize,
}

impl Default for TaskTable<'_> {
    /// No tasks: files without programs are written as they are.
    fn default() -> Self {
        Self { rows: Vec::new(), programs: Vec::new(), shortest: DEFAULT, line: Line::default() }
    }
}

impl<'a> TaskTable<'a> {
    /// Puts the tasks in order.
    ///
    /// # Errors
    /// What would be wrong with the tasks in a soft PLC is wrong here.
    pub(super) fn new(tasks: &[Task], entries: &[Entry<'a>], line: Line) -> Result<Self, RunError> {
        check(tasks)?;
        let mut order: Vec<&Task> = tasks.iter().collect();
        order.sort_by_key(|task| task.priority);
        let shortest = shortest(tasks);
        let mut table = Self { shortest, line, ..Self::default() };
        for task in order {
            let first = table.programs.len() + 1;
            for name in &task.programs {
                let entry = find(name, task, entries)?;
                if table.programs.iter().any(|other| other.name == entry.name) {
                    return Err(RunError::ProgramTwice { program: name.clone(), task: task.name.clone() });
                }
                table.programs.push(entry);
            }
            let count = table.programs.len() + 1 - first;
            // One that runs nothing would have no last program.
            if count > 0 {
                let single = task.single.as_deref().map(Single::of);
                let (interval, priority) = (task.interval, task.priority);
                table.rows.push(Row { interval, priority, single, first, count });
            }
        }
        if table.rows.is_empty() { Err(RunError::NoTasks) } else { Ok(table) }
    }

    /// The programs that run, each once, and how each knows its number.
    pub(super) fn numbered(&self) -> impl Iterator<Item = (&'a Pou, Number)> {
        self.programs.iter().enumerate().filter_map(|(index, entry)| {
            let mut same = self.programs.iter().enumerate().filter(|(_, other)| std::ptr::eq(other.pou, entry.pou));
            let (first, _) = same.next()?;
            let number = if same.next().is_some() { Number::OfInstance } else { Number::Fixed(index + 1) };
            (first == index).then_some((entry.pou, number))
        })
    }

    /// The number of an instance that must receive it.
    pub(super) fn number_of_instance(&self, name: &str) -> Option<usize> {
        let at = self.programs.iter().position(|entry| entry.name == name)?;
        let pou = self.programs.get(at)?.pou;
        let same = self.programs.iter().filter(|other| std::ptr::eq(other.pou, pou)).count();
        (same > 1).then_some(at + 1)
    }

    /// The type of the line of programs.
    pub(super) fn line_type(&self) -> String {
        match self.line {
            Line::Named => "SDSP_LINE".to_owned(),
            Line::InPlace => format!("ARRAY [0..{}] OF INT", self.programs.len()),
        }
    }

    /// The declaration of that type, if it has one.
    pub(super) fn line_declaration(&self) -> Option<&'static str> {
        (self.line == Line::Named).then_some(template::LINE)
    }

    /// True if tasks have SINGLE.
    pub(super) fn has_singles(&self) -> bool {
        self.rows.iter().any(|row| row.single.is_some())
    }

    /// True if events start them.
    pub(super) fn has_events(&self) -> bool {
        self.rows.iter().any(|row| matches!(row.single, Some(Single::Input(_))))
    }

    /// A template with its lines for tasks with SINGLE.
    pub(super) fn with_singles(&self, template: &str) -> String {
        let rows = self.rows.iter().enumerate();
        let singles: Vec<_> = rows.filter_map(|(at, row)| Some((at + 1, row.single.as_ref()?))).collect();
        single::fill(template, &singles)
    }

    /// Number of the row that stands for programs without a task; 0 if there are none.
    fn background(&self) -> usize {
        self.rows.iter().position(|row| row.interval == Some(ALWAYS)).map_or(0, |at| at + 1)
    }

    /// What the scheduler's names stand for.
    pub(super) fn names(&self) -> Vec<(&'static str, String)> {
        let list = |value: &dyn Fn(&Row) -> u64| {
            let values: Vec<String> = self.rows.iter().map(|row| value(row).to_string()).collect();
            values.join(", ")
        };
        vec![
            ("SDSP_PROGRAMS", self.programs.len().to_string()),
            ("SDSP_LINE", self.line_type()),
            ("SDSP_TASKS", self.rows.len().to_string()),
            ("SDSP_INTERVALS", list(&|row| row.interval.map_or(0, TimeSpan::as_nanos))),
            ("SDSP_PRIORITIES", list(&|row| u64::from(row.priority))),
            ("SDSP_FIRSTS", list(&|row| row.first as u64)),
            ("SDSP_REARS", list(&|row| (row.first + row.count) as u64 - 1)),
            ("SDSP_BACKGROUND", self.background().to_string()),
        ]
    }
}

/// The interval of the scheduler's task: the shortest of the others' own.
pub(super) fn shortest(tasks: &[Task]) -> TimeSpan {
    let intervals = tasks.iter().filter_map(|task| task.interval);
    intervals.filter(|interval| *interval > ALWAYS).min().unwrap_or(DEFAULT)
}

/// An interval as a literal of the standard, in milliseconds.
pub(super) fn literal(interval: TimeSpan) -> String {
    // A longer interval than a TIME can be is never due in any PLC.
    let ns = i64::try_from(interval.as_nanos()).unwrap_or(i64::MAX);
    format!("T#{}", IecDuration::from_nanos(ns).in_millis())
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
        if task.interval.is_none() && task.single.is_none() {
            return Err(RunError::NeverDue(task.name.clone()));
        }
    }
    Ok(())
}

fn find<'a>(name: &str, task: &Task, entries: &[Entry<'a>]) -> Result<Entry<'a>, RunError> {
    let found = entries.iter().find(|entry| entry.name.eq_ignore_ascii_case(name));
    found.cloned().ok_or_else(|| RunError::UnknownProgram {
        task: task.name.clone(),
        program: name.to_owned(),
        help: did_you_mean(name, entries.iter().map(|entry| entry.name.as_str())),
    })
}
