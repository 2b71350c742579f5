//! The tasks that an application's own configuration declares (2nd ed. 2.7).

use crate::application::Application;
use onescan_iec::task_plan::{Task, TaskPlan};

impl Application {
    /// The tasks of its own configuration; nothing if it has none.
    ///
    /// The tasks of all resources share one scheduler, in the order of their declaration.
    pub fn configured_tasks(&self) -> Option<TaskPlan> {
        let configuration = self.configuration()?;
        let names = |entries: &[usize]| -> Vec<String> {
            entries.iter().filter_map(|entry| self.entry_name(*entry)).map(str::to_owned).collect()
        };
        let mut plan = TaskPlan::new(Vec::new());
        for resource in &configuration.resources {
            plan.tasks.extend(resource.tasks.iter().map(|task| Task {
                name: task.name.clone(),
                interval: task.interval,
                single: task.single.clone(),
                priority: task.priority,
                programs: names(&task.entries),
            }));
            plan.background.extend(names(&resource.background));
        }
        Some(plan)
    }
}
