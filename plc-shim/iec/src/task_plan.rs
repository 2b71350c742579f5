//! Tasks and the programs they run (2nd ed. 2.7.2), as data.

use onescan_base::TimeSpan;

/// A task. A periodic one is due at one interval after the start, then after each interval.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Task {
    pub name: String,
    /// Time between two executions; nothing if it is not periodic.
    pub interval: Option<TimeSpan>,
    /// Path of a BOOL whose rising edges start it. While that is TRUE, the interval is suspended.
    pub single: Option<String>,
    /// Its rank among tasks that are due together; 0 comes first.
    pub priority: u32,
    /// The programs it runs, in their order: names of programs, or of their instances in the
    /// application's configuration.
    pub programs: Vec<String>,
}

/// What a PLC runs, and when.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TaskPlan {
    pub tasks: Vec<Task>,
    /// Programs without a task: each scan runs them at its end, in their order (2nd ed. 2.7.2).
    pub background: Vec<String>,
    /// How many instructions of WebAssembly, about, a task may use in one execution before it
    /// counts as an endless loop; what is small and has no loops of unknown length is not counted.
    pub fuel_per_task: u64,
}

impl TaskPlan {
    /// Enough for half a second of instructions on a common machine.
    pub const DEFAULT_FUEL: u64 = 50_000_000;

    /// A plan with the default budget of instructions.
    pub fn new(tasks: Vec<Task>) -> Self {
        Self { tasks, background: Vec::new(), fuel_per_task: Self::DEFAULT_FUEL }
    }
}
