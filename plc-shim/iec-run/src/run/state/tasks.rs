//! The task plan as a part of a state's layout: the saved scheduler stands for tasks by their positions.

use onescan_base::{ElementaryType, TimeSpan};
use thiserror::Error;

use crate::application::identity::bytes::{Reader, Writer};
use crate::application::text::format;
use onescan_iec::task_plan::{Task, TaskPlan};

/// In what the task plan of a saved state differs from that of the PLC.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum PlanDifference {
    /// The plan has a task that the state does not have.
    #[error("the saved state has no task `{task}`")]
    Missing { task: String },
    /// The state has a task that the plan does not have.
    #[error("the saved state has a task `{task}`, which the plan does not have")]
    Unknown { task: String },
    /// A task's interval, priority, trigger or programs are others.
    #[error("in the saved state, task `{task}` has {saved}, not {wanted}")]
    Task {
        task: String,
        /// What it has in the state, as in "an interval of 20ms".
        saved: String,
        /// What it has in the plan.
        wanted: String,
    },
    /// The tasks are the same in another order, which decides between tasks of one priority.
    #[error("the saved state has its tasks in another order")]
    Order,
    /// Other programs run without a task, or in another order.
    #[error("in the saved state, {saved} without a task, not {wanted}")]
    Background {
        /// What runs in the state.
        saved: String,
        /// What runs in the plan.
        wanted: String,
    },
    /// The budget of instructions is another.
    #[error("in the saved state, a task has a budget of {saved} instructions, not {wanted}")]
    Budget {
        /// That of the state.
        saved: u64,
        /// That of the plan.
        wanted: u64,
    },
}

/// A plan with all names in capitals: equal for plans that mean the same, as names are compared without case.
pub(super) fn folded(plan: &TaskPlan) -> TaskPlan {
    let fold = |names: &[String]| names.iter().map(|name| name.to_ascii_uppercase()).collect();
    let task = |task: &Task| Task {
        name: task.name.to_ascii_uppercase(),
        interval: task.interval,
        single: task.single.as_ref().map(|path| path.to_ascii_uppercase()),
        priority: task.priority,
        programs: fold(&task.programs),
    };
    let (tasks, background) = (plan.tasks.iter().map(task).collect(), fold(&plan.background));
    TaskPlan { tasks, background, fuel_per_task: plan.fuel_per_task }
}

/// The plan as bytes.
pub(super) fn encode(plan: &TaskPlan) -> Vec<u8> {
    let TaskPlan { tasks, background, fuel_per_task } = plan;
    let mut writer = Writer::default();
    writer.number(*fuel_per_task);
    writer.count(tasks.len());
    for Task { name, interval, single, priority, programs } in tasks {
        writer.text(name);
        // A span is never 0, so 0 stands for a task without an interval.
        writer.number(interval.map_or(0, TimeSpan::as_nanos));
        writer.small_number(*priority);
        writer.flag(single.is_some());
        writer.text(single.as_deref().unwrap_or(""));
        writer.texts(programs.iter().map(String::as_str));
    }
    writer.texts(background.iter().map(String::as_str));
    writer.finish()
}

/// Nothing unless the bytes are a plan.
pub(super) fn decode(bytes: &[u8]) -> Option<TaskPlan> {
    let mut reader = Reader::new(bytes);
    let fuel_per_task = reader.number()?;
    let tasks = reader.list(|reader| {
        let (name, interval, priority) =
            (reader.text()?, TimeSpan::from_nanos(reader.number()?), reader.small_number()?);
        let (has_trigger, trigger) = (reader.flag()?, reader.text()?);
        let single = has_trigger.then_some(trigger);
        Some(Task { name, interval, single, priority, programs: reader.texts()? })
    })?;
    let background = reader.texts()?;
    reader.is_at_end().then_some(TaskPlan { tasks, background, fuel_per_task })
}

/// The first difference of a state's plan to the PLC's; nothing if they are equal.
pub(super) fn difference(plan: &TaskPlan, saved: &TaskPlan) -> Option<PlanDifference> {
    for task in &plan.tasks {
        let Some(before) = saved.tasks.iter().find(|other| other.name.eq_ignore_ascii_case(&task.name)) else {
            return Some(PlanDifference::Missing { task: task.name.clone() });
        };
        if let Some(found) = task_difference(task, before) {
            return Some(found);
        }
    }
    let is_unknown = |task: &&Task| !plan.tasks.iter().any(|other| other.name.eq_ignore_ascii_case(&task.name));
    if let Some(task) = saved.tasks.iter().find(is_unknown) {
        return Some(PlanDifference::Unknown { task: task.name.clone() });
    }
    let same_order = plan.tasks.iter().zip(&saved.tasks).all(|(one, other)| one.name.eq_ignore_ascii_case(&other.name));
    if !same_order {
        return Some(PlanDifference::Order);
    }
    if !same_names(&plan.background, &saved.background) {
        let (saved, wanted) = (programs(&saved.background), programs(&plan.background));
        return Some(PlanDifference::Background { saved, wanted });
    }
    let (saved, wanted) = (saved.fuel_per_task, plan.fuel_per_task);
    (saved != wanted).then_some(PlanDifference::Budget { saved, wanted })
}

fn task_difference(task: &Task, before: &Task) -> Option<PlanDifference> {
    let differs = |saved: String, wanted: String| {
        let task = task.name.clone();
        Some(PlanDifference::Task { task, saved, wanted })
    };
    let trigger = |task: &Task| task.single.as_ref().map(|path| path.to_ascii_uppercase());
    if task.interval != before.interval {
        let shown = |interval: TimeSpan| format!("an interval of {}", duration(interval));
        return match (before.interval, task.interval) {
            (Some(saved), Some(wanted)) => differs(shown(saved), duration(wanted)),
            (saved, wanted) => {
                let [saved, wanted] = [saved, wanted].map(|each| each.map_or("no interval".to_owned(), shown));
                differs(saved, wanted)
            }
        };
    }
    if task.priority != before.priority {
        return differs(format!("a priority of {}", before.priority), task.priority.to_string());
    }
    if trigger(task) != trigger(before) {
        let shown =
            |task: &Task| task.single.as_ref().map_or("no trigger".to_owned(), |path| format!("the trigger `{path}`"));
        return differs(shown(before), shown(task));
    }
    if !same_names(&task.programs, &before.programs) {
        return differs(programs(&before.programs), programs(&task.programs));
    }
    None
}

fn same_names(one: &[String], other: &[String]) -> bool {
    one.len() == other.len() && one.iter().zip(other).all(|(one, other)| one.eq_ignore_ascii_case(other))
}

fn programs(names: &[String]) -> String {
    match names {
        [] => "no program".to_owned(),
        [one] => format!("the program `{one}`"),
        _ => format!("the programs `{}`", names.join("`, `")),
    }
}

/// `20ms`
fn duration(span: TimeSpan) -> String {
    let text = format(ElementaryType::Time, span.as_nanos().cast_signed());
    let text = text.text();
    text.trim_start_matches("T#").to_owned()
}
