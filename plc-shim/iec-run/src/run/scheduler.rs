//! Which task is due when (2nd ed. 2.7.2, non-preemptive).
//!
//! A task waits for its interval, for a rising edge of its SINGLE input, or for either. Inputs are
//! looked at when a scan begins and after each task; an edge starts a task at most once per scan, a
//! later one waits for the next scan.

use onescan_base::{TimeSpan, VirtualTime};

use onescan_iec::task_plan::{Task, TaskPlan};

/// A task while it waits, as it is saved.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Waiting {
    /// When it is due by its interval; nothing if it has none, or if that is past the end of time.
    pub(super) due: Option<VirtualTime>,
    /// Since when an edge of its SINGLE input waits.
    pub(super) edge: Option<VirtualTime>,
    /// What its SINGLE input was when it was last looked at.
    pub(super) level: bool,
}

#[derive(Debug, Clone)]
struct Entry {
    interval: Option<TimeSpan>,
    priority: u32,
    /// Offset of the BOOL that triggers it.
    single: Option<usize>,
    waiting: Waiting,
    /// An edge has started it in this scan.
    has_run: bool,
}

impl Entry {
    fn restart(&mut self, now: VirtualTime) {
        let due = self.interval.and_then(|interval| now.checked_add(interval));
        self.waiting = Waiting { due, edge: None, level: false };
        self.has_run = false;
    }

    /// Since when it waits; nothing if it does not.
    fn waits_since(&self, now: VirtualTime) -> Option<VirtualTime> {
        let edge = self.waiting.edge.filter(|_| !self.has_run);
        let reasons = self.waiting.due.into_iter().chain(edge);
        reasons.min().filter(|since| *since <= now)
    }

    /// The first time after `now` at which it is due by its interval.
    fn advance(&mut self, now: VirtualTime) {
        if let (Some(due), Some(interval)) = (self.waiting.due, self.interval) {
            self.waiting.due = due.next_after(now, interval);
        }
    }
}

/// Which way the times of a task are moved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shift {
    Later,
    Earlier,
}

/// The tasks by their position in the plan.
#[derive(Debug, Clone)]
pub(super) struct Scheduler {
    tasks: Vec<Entry>,
}

impl Scheduler {
    /// `singles` gives the offset of each task's SINGLE input.
    pub(super) fn new(plan: &TaskPlan, singles: &[Option<usize>]) -> Self {
        debug_assert_eq!(plan.tasks.len(), singles.len(), "every task has its trigger, or none");
        let entry = |(task, single): (&Task, &Option<usize>)| Entry {
            interval: task.interval,
            priority: task.priority,
            single: *single,
            waiting: Waiting::default(),
            has_run: false,
        };
        let mut scheduler = Self { tasks: plan.tasks.iter().zip(singles).map(entry).collect() };
        scheduler.restart_at(VirtualTime::ZERO);
        scheduler
    }

    /// After a start at `now`, every task is due one interval later.
    pub(super) fn restart_at(&mut self, now: VirtualTime) {
        self.tasks.iter_mut().for_each(|task| task.restart(now));
    }

    /// Begins a scan: edges may start tasks again.
    pub(super) fn begin_scan(&mut self) {
        self.tasks.iter_mut().for_each(|task| task.has_run = false);
    }

    /// Looks at the SINGLE inputs. While one is TRUE, its task's interval is suspended
    /// (2nd ed. 2.7.2).
    pub(super) fn look(&mut self, now: VirtualTime, memory: &[u8]) {
        for task in &mut self.tasks {
            let Some(offset) = task.single else { continue };
            debug_assert!(offset < memory.len(), "a trigger is a variable of the application");
            let level = memory.get(offset).is_some_and(|byte| *byte != 0);
            if level && !task.waiting.level {
                // An edge that waits already keeps its place in the order.
                task.waiting.edge = Some(task.waiting.edge.map_or(now, |edge| edge.min(now)));
            }
            task.waiting.level = level;
            if level {
                task.advance(now);
            }
        }
    }

    /// Takes the next task that waits at `now`: by priority, then the one that waits longest,
    /// then the one declared first. A task that missed intervals runs once for all of them.
    pub(super) fn take_due(&mut self, now: VirtualTime) -> Option<usize> {
        let waiting = self.tasks.iter().enumerate();
        let waiting = waiting.filter_map(|(index, task)| Some((task.priority, task.waits_since(now)?, index)));
        let (_, _, index) = waiting.min()?;
        let task = self.tasks.get_mut(index)?;
        task.advance(now);
        debug_assert!(
            task.interval.is_none() || task.waiting.due.is_none_or(|due| due > now),
            "a task that runs now is due later than now"
        );
        if task.waiting.edge.is_some() && !task.has_run {
            task.waiting.edge = None;
            task.has_run = true;
        }
        Some(index)
    }

    /// Lets a task be due so much later, or earlier. False if it has no interval, or would never be due again.
    pub(super) fn shift(&mut self, index: usize, shift: Shift, by: TimeSpan) -> bool {
        let Some(task) = self.tasks.get_mut(index) else { return false };
        let Some(due) = task.waiting.due else { return false };
        let shifted = match shift {
            Shift::Later => due.checked_add(by),
            Shift::Earlier => Some(due.saturating_sub(by)),
        };
        task.waiting.due = shifted.or(Some(due));
        shifted.is_some()
    }

    /// When the first task is due by its interval; nothing if none has one.
    pub(super) fn next_due(&self) -> Option<VirtualTime> {
        self.tasks.iter().filter_map(|task| task.waiting.due).min()
    }

    /// The greatest span that divides all intervals; nothing if there are none.
    pub(super) fn period(&self) -> Option<TimeSpan> {
        self.tasks.iter().filter_map(|task| task.interval).reduce(TimeSpan::common_divisor)
    }

    /// How each task waits.
    pub(super) fn waiting(&self) -> impl ExactSizeIterator<Item = Waiting> {
        self.tasks.iter().map(|task| task.waiting)
    }

    pub(super) fn set_waiting(&mut self, waiting: &[Waiting]) {
        debug_assert_eq!(waiting.len(), self.tasks.len(), "a state says of every task how it waits");
        for (task, waiting) in self.tasks.iter_mut().zip(waiting) {
            task.waiting = *waiting;
            task.has_run = false;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scheduler(tasks: &[(u64, u32)], singles: &[Option<usize>]) -> Scheduler {
        let task = |(index, (interval_ns, priority)): (usize, &(u64, u32))| Task {
            name: index.to_string(),
            interval: TimeSpan::from_nanos(*interval_ns),
            single: None,
            priority: *priority,
            programs: Vec::new(),
        };
        Scheduler::new(&TaskPlan::new(tasks.iter().enumerate().map(task).collect()), singles)
    }

    fn due(scheduler: &mut Scheduler, now: u64, memory: &[u8]) -> Vec<usize> {
        let now = VirtualTime::from_nanos(now);
        scheduler.begin_scan();
        std::iter::from_fn(|| {
            scheduler.look(now, memory);
            scheduler.take_due(now)
        })
        .collect()
    }

    #[test]
    fn iec2_2_7_2_priority_then_waiting_then_declaration() {
        let mut tasks = scheduler(&[(10, 2), (20, 1), (10, 2), (15, 2)], &[None; 4]);
        assert_eq!(tasks.period(), TimeSpan::from_nanos(5));
        assert!(due(&mut tasks, 9, &[]).is_empty());
        assert_eq!(due(&mut tasks, 10, &[]), [0, 2]);
        assert_eq!(tasks.next_due(), Some(VirtualTime::from_nanos(15)));
        assert_eq!(due(&mut tasks, 20, &[]), [1, 3, 0, 2]);
    }

    #[test]
    fn missed_intervals_run_once() {
        let mut tasks = scheduler(&[(10, 0)], &[None]);
        assert_eq!(due(&mut tasks, 35, &[]), [0]);
        assert_eq!(tasks.next_due(), Some(VirtualTime::from_nanos(40)));
    }

    #[test]
    fn a_task_is_late_once_or_for_good() {
        let by = TimeSpan::from_nanos(3).unwrap();
        let mut tasks = scheduler(&[(10, 0)], &[None]);
        assert!(tasks.shift(0, Shift::Later, by) && !tasks.shift(1, Shift::Later, by));
        assert!(due(&mut tasks, 10, &[]).is_empty());
        // Caught up with before it has run, it is due at once, and then as if it had never been late.
        assert!(tasks.shift(0, Shift::Earlier, by));
        assert_eq!(due(&mut tasks, 13, &[]), [0]);
        assert_eq!(tasks.next_due(), Some(VirtualTime::from_nanos(20)));
        assert!(tasks.shift(0, Shift::Later, by));
        assert_eq!(due(&mut tasks, 23, &[]), [0]);
        assert_eq!(tasks.next_due(), Some(VirtualTime::from_nanos(33)), "for good");
    }

    #[test]
    fn iec2_2_7_2_rising_edges_start_a_task_once() {
        let mut tasks = scheduler(&[(0, 1), (10, 0)], &[Some(0), None]);
        assert!(due(&mut tasks, 5, &[0]).is_empty());
        assert_eq!(due(&mut tasks, 6, &[1]), [0]);
        assert!(due(&mut tasks, 7, &[1]).is_empty());
        assert_eq!(due(&mut tasks, 10, &[0]), [1]);
        assert_eq!(due(&mut tasks, 20, &[1]), [1, 0]);
        assert_eq!(tasks.period(), TimeSpan::from_nanos(10));
    }

    #[test]
    fn iec2_2_7_2_an_interval_is_suspended_while_single_is_true() {
        let mut tasks = scheduler(&[(10, 0)], &[Some(0)]);
        assert_eq!(due(&mut tasks, 10, &[0]), [0]);
        assert_eq!(due(&mut tasks, 20, &[1]), [0], "the edge, not the interval");
        assert!(due(&mut tasks, 30, &[1]).is_empty());
        assert!(due(&mut tasks, 35, &[0]).is_empty());
        assert_eq!(due(&mut tasks, 40, &[0]), [0]);
    }

    #[test]
    fn an_edge_in_the_scan_of_its_task_waits_for_the_next() {
        let mut tasks = scheduler(&[(0, 0)], &[Some(0)]);
        let now = VirtualTime::from_nanos(1);
        tasks.begin_scan();
        tasks.look(now, &[1]);
        assert_eq!(tasks.take_due(now), Some(0));
        tasks.look(now, &[0]);
        tasks.look(now, &[1]);
        assert_eq!(tasks.take_due(now), None);
        assert_eq!(due(&mut tasks, 2, &[1]), [0]);
        assert!(due(&mut tasks, 3, &[1]).is_empty());
    }
}
