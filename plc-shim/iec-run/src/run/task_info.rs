//! What TwinCAT's programs read about their task (`iec/vendor/tc3_system_info.st`): filled in before it runs.

use onescan_base::VirtualTime;

use crate::application::{Application, Variable};
use onescan_iec::task_plan::TaskPlan;

const LIST: &str = "TwinCAT_SystemInfoVarList";

/// Where it is kept; nothing unless a program asks for it.
pub(super) struct TaskInfo {
    /// The number of the task that runs, from 1.
    current: Variable,
    /// Those that have an entry.
    tasks: Vec<Entry>,
    /// What a start takes away and the plan gives: variables with their bytes.
    fixed: Vec<(Variable, Vec<u8>)>,
}

struct Entry {
    cycle_count: Variable,
    first_cycle: Variable,
    time: Variable,
}

impl TaskInfo {
    pub(super) fn find(application: &Application, plan: &TaskPlan) -> Option<Self> {
        let variable = |path: String| application.variable(&format!("{LIST}.{path}")).ok();
        let current = variable("OnescanTask".to_owned())?;
        let (mut tasks, mut fixed) = (Vec::new(), Vec::new());
        let mut fix = |path: String, value: String| {
            let found = variable(path)?;
            fixed.push((found.clone(), application.value_bytes(&found, &value).ok()?));
            Some(())
        };
        // A task whose name is too long, or whose numbers are, goes without.
        let _ = fix("_AppInfo.TaskCnt".to_owned(), plan.tasks.len().to_string());
        for (index, task) in plan.tasks.iter().enumerate() {
            let member = |name: &str| format!("_TaskInfo[{}].{name}", index + 1);
            let Some(cycle_count) = variable(member("CycleCount")) else { break };
            let (first_cycle, time) = (variable(member("FirstCycle"))?, variable(member("DcTaskTime"))?);
            tasks.push(Entry { cycle_count, first_cycle, time });
            let hundreds = task.interval.map_or(0, |interval| interval.as_nanos() / 100);
            let _ = fix(member("CycleTime"), hundreds.to_string());
            let _ = fix(member("Priority"), task.priority.to_string());
            let _ = fix(member("TaskName"), format!("'{}'", task.name));
        }
        Some(Self { current, tasks, fixed })
    }

    /// `task` is about to run; nothing for a program without one.
    pub(super) fn enter(&self, task: Option<usize>, now: VirtualTime, memory: &mut [u8]) {
        let number = task.and_then(|task| u32::try_from(task + 1).ok()).unwrap_or(0);
        self.current.store(&number.to_le_bytes(), memory);
        let Some(entry) = task.and_then(|task| self.tasks.get(task)) else { return };
        for (variable, bytes) in &self.fixed {
            variable.store(bytes, memory);
        }
        let count = read(&entry.cycle_count, memory).wrapping_add(1);
        entry.cycle_count.store(&count.to_le_bytes(), memory);
        entry.first_cycle.store(&[u8::from(count == 1)], memory);
        entry.time.store(&now.as_nanos().to_le_bytes(), memory);
    }
}

fn read(variable: &Variable, memory: &[u8]) -> u32 {
    let bytes = memory.get(variable.offset as usize..).and_then(|rest| rest.first_chunk());
    bytes.map_or(0, |bytes| u32::from_le_bytes(*bytes))
}
