//! Which task is due when (2nd ed. 2.7.2, non-preemptive).

use super::VirtualTime;
use super::plan::TaskPlan;

#[derive(Debug, Clone)]
struct Entry {
    interval_ns: u64,
    priority: u32,
    due_ns: u64,
}

/// The tasks by their position in the plan.
#[derive(Debug, Clone)]
pub(super) struct Scheduler {
    tasks: Vec<Entry>,
}

impl Scheduler {
    pub(super) fn new(plan: &TaskPlan) -> Self {
        let entry = |task: &super::Task| Entry {
            interval_ns: task.interval_ns,
            priority: task.priority,
            due_ns: task.interval_ns,
        };
        Self { tasks: plan.tasks.iter().map(entry).collect() }
    }

    /// Every task is due one interval after the start.
    pub(super) fn reset(&mut self) {
        for task in &mut self.tasks {
            task.due_ns = task.interval_ns;
        }
    }

    /// After a start at `now`, every task is due one interval later.
    pub(super) fn restart_at(&mut self, now: VirtualTime) {
        for task in &mut self.tasks {
            task.due_ns = now.as_ns().saturating_add(task.interval_ns);
        }
    }

    /// Takes the next task that is due at `now`: by priority, then the one that waits longest,
    /// then the one declared first. A task that missed intervals runs once for all of them.
    pub(super) fn take_due(&mut self, now: VirtualTime) -> Option<usize> {
        let now = now.as_ns();
        let due = self.tasks.iter().enumerate().filter(|(_, task)| task.due_ns <= now);
        let next = due.min_by_key(|(index, task)| (task.priority, task.due_ns, *index));
        let (index, _) = next?;
        let task = self.tasks.get_mut(index)?;
        let missed = (now - task.due_ns) / task.interval_ns;
        let ahead = task.interval_ns.saturating_mul(missed + 1);
        task.due_ns = task.due_ns.saturating_add(ahead);
        Some(index)
    }

    /// When the first task is due.
    pub(super) fn next_due(&self) -> VirtualTime {
        VirtualTime::from_ns(self.tasks.iter().map(|task| task.due_ns).min().unwrap_or(u64::MAX))
    }

    /// Greatest common divisor of the intervals.
    pub(super) fn period_ns(&self) -> u64 {
        let divisor = |mut a: u64, mut b: u64| {
            while b != 0 {
                (a, b) = (b, a % b);
            }
            a
        };
        self.tasks.iter().fold(0, |period, task| divisor(period, task.interval_ns))
    }

    /// When each task is due.
    pub(super) fn due_times(&self) -> impl ExactSizeIterator<Item = u64> {
        self.tasks.iter().map(|task| task.due_ns)
    }

    pub(super) fn set_due_times(&mut self, times: &[u64]) {
        for (task, due_ns) in self.tasks.iter_mut().zip(times) {
            task.due_ns = *due_ns;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::Task;

    fn scheduler(tasks: &[(u64, u32)]) -> Scheduler {
        let task = |(index, (interval_ns, priority)): (usize, &(u64, u32))| Task {
            name: index.to_string(),
            interval_ns: *interval_ns,
            priority: *priority,
            programs: Vec::new(),
        };
        Scheduler::new(&TaskPlan::new(tasks.iter().enumerate().map(task).collect()))
    }

    fn due(scheduler: &mut Scheduler, now: u64) -> Vec<usize> {
        std::iter::from_fn(|| scheduler.take_due(VirtualTime::from_ns(now))).collect()
    }

    #[test]
    fn priority_then_waiting_then_declaration() {
        let mut tasks = scheduler(&[(10, 2), (20, 1), (10, 2), (15, 2)]);
        assert_eq!(tasks.period_ns(), 5);
        assert!(due(&mut tasks, 9).is_empty());
        assert_eq!(due(&mut tasks, 10), [0, 2]);
        assert_eq!(tasks.next_due(), VirtualTime::from_ns(15));
        assert_eq!(due(&mut tasks, 20), [1, 3, 0, 2]);
    }

    #[test]
    fn missed_intervals_run_once() {
        let mut tasks = scheduler(&[(10, 0)]);
        assert_eq!(due(&mut tasks, 35), [0]);
        assert_eq!(tasks.next_due(), VirtualTime::from_ns(40));
    }
}
