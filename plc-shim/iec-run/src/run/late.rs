//! Tasks that are late: by once, as on a PLC that was busy, or for good, as on one that was started later.

use onescan_base::TimeSpan;
use thiserror::Error;

use super::SoftPlc;
use super::scheduler::Shift;
use onescan_iec::diagnostic::did_you_mean;

/// Why a task cannot be late.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum LateError {
    #[error("it has no task `{task}`{}", help.as_ref().map(|help| format!(" ({help})")).unwrap_or_default())]
    Unknown {
        task: String,
        /// The one that may have been meant.
        help: Option<String>,
    },
    /// Nothing says when the task would be due.
    #[error("task `{0}` has no interval, so that nothing says when it would be due")]
    NoInterval(String),
    /// Programs run whenever the PLC does.
    #[error("it runs programs without a task in every scan, which are never late")]
    Background,
    /// It would not be due before the end of virtual time.
    #[error("task `{0}` would never be due")]
    Never(String),
}

impl SoftPlc {
    /// Lets a task be due later by `by` than it would be, from the next time on; all tasks without a name.
    ///
    /// # Errors
    /// There is no such task, or nothing says when it is due. Nothing has changed then.
    pub fn postpone(&mut self, task: Option<&str>, by: TimeSpan) -> Result<(), LateError> {
        self.shift(task, Shift::Later, by)
    }

    /// Lets a task that was postponed by `by` be due in time again: at once, if it would have been due by now.
    ///
    /// # Errors
    /// As [`Self::postpone`].
    pub fn catch_up(&mut self, task: Option<&str>, by: TimeSpan) -> Result<(), LateError> {
        self.shift(task, Shift::Earlier, by)
    }

    /// Whether a task could be late; all of them without a name.
    ///
    /// # Errors
    /// There is no such task, or nothing says when it is due.
    pub fn check_late(&self, task: Option<&str>) -> Result<(), LateError> {
        self.late(task).map(drop)
    }

    fn shift(&mut self, task: Option<&str>, shift: Shift, by: TimeSpan) -> Result<(), LateError> {
        let tasks = self.late(task)?;
        let before: Vec<_> = self.scheduler.waiting().collect();
        for index in tasks {
            if !self.scheduler.shift(index, shift, by) {
                self.scheduler.set_waiting(&before);
                return Err(LateError::Never(self.plan().tasks[index].name.clone()));
            }
        }
        Ok(())
    }

    /// The tasks that are meant.
    fn late(&self, task: Option<&str>) -> Result<Vec<usize>, LateError> {
        let tasks = &self.plan().tasks;
        let Some(named) = task else {
            if !self.background.is_empty() {
                return Err(LateError::Background);
            }
            let without = tasks.iter().find(|task| task.interval.is_none());
            return match without {
                Some(task) => Err(LateError::NoInterval(task.name.clone())),
                None => Ok((0..tasks.len()).collect()),
            };
        };
        let found = tasks.iter().position(|task| task.name.eq_ignore_ascii_case(named)).ok_or_else(|| {
            let help = did_you_mean(named, tasks.iter().map(|task| task.name.as_str()));
            LateError::Unknown { task: named.to_owned(), help }
        })?;
        match tasks[found].interval {
            Some(_) => Ok(vec![found]),
            None => Err(LateError::NoInterval(tasks[found].name.clone())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Application;
    use onescan_iec::VirtualTime;
    use onescan_iec::task_plan::{Task, TaskPlan};

    fn plc(background: bool) -> SoftPlc {
        let text = "PROGRAM One VAR n : INT; END_VAR n := n + 1; END_PROGRAM \
                    PROGRAM Two VAR go : BOOL; END_VAR ; END_PROGRAM PROGRAM Three END_PROGRAM";
        let application = Application::from_sources([("main.st", text)]).unwrap();
        let task = |name: &str, interval, single: Option<&str>| Task {
            name: name.to_owned(),
            interval,
            single: single.map(str::to_owned),
            programs: vec![name.to_owned()],
            ..Task::default()
        };
        let mut tasks = vec![task("One", TimeSpan::from_millis(10), None)];
        if !background {
            tasks.push(task("Two", None, Some("Two.go")));
        }
        let mut plan = TaskPlan::new(tasks);
        if background {
            plan.background.push("Three".to_owned());
        }
        SoftPlc::new(&application, &plan).unwrap()
    }

    #[test]
    fn what_cannot_be_late_is_reported() {
        let by = TimeSpan::from_millis(5).unwrap();
        let reported = [(false, Some("on")), (false, Some("two")), (false, None), (true, None)]
            .map(|(background, task)| plc(background).postpone(task, by).unwrap_err().to_string());
        assert!(reported[0].starts_with("it has no task `on`"), "{}", reported[0]);
        let no_interval = "task `Two` has no interval, so that nothing says when it would be due";
        assert_eq!(reported[1..3], [no_interval, no_interval]);
        assert_eq!(reported[3], "it runs programs without a task in every scan, which are never late");
        let never = TimeSpan::from_nanos(u64::MAX).unwrap();
        assert_eq!(plc(true).postpone(Some("one"), never), Err(LateError::Never("One".to_owned())));
    }

    /// What is late is part of the state.
    #[test]
    fn a_late_task_is_saved_as_one() {
        let by = TimeSpan::from_millis(5).unwrap();
        let mut one = plc(true);
        one.postpone(Some("One"), by).unwrap();
        let mut other = plc(true);
        other.restore(&one.save()).unwrap();
        let at = |ms: u64| VirtualTime::from_nanos(ms * 1_000_000);
        assert_eq!((one.next_due(), other.next_due()), (Some(at(15)), Some(at(15))));
        other.scan(at(15)).unwrap();
        other.catch_up(Some("One"), by).unwrap();
        assert_eq!(other.next_due(), Some(at(20)));
    }
}
