//! The tasks that an application's own configuration declares (2nd ed. 2.7).

use super::plan::{Task, TaskPlan};
use crate::application::Application;

impl TaskPlan {
    /// The tasks of the application's configuration; nothing if it has none.
    ///
    /// The tasks of all resources share one scheduler, in the order of their declaration.
    pub fn configured(application: &Application) -> Option<Self> {
        let configuration = application.configuration()?;
        let names = |entries: &[usize]| -> Vec<String> {
            entries.iter().filter_map(|entry| application.entry_name(*entry)).map(str::to_owned).collect()
        };
        let mut plan = Self::new(Vec::new());
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
