//! Where something may happen later: what changes in a step, and which tasks are due in it.

use onescan_scenario::Scenario;
use onescan_scenario::timing::{TimedTask, TimingTolerance};
use onescan_server::session::Session;
use onescan_server::signal::{SignalName, SignalType};
use onescan_server::time::{TimeSpan, VirtualTime};

use super::deviation::{Deviation, What};
use onescan_runner::run::chosen::Chosen;

/// The signals that may be late, as they were in the step before.
pub(super) struct Watched {
    names: Vec<SignalName>,
    chosen: Chosen,
    last: Vec<Vec<u8>>,
    /// Whether each changed in the last step.
    changed: Vec<bool>,
}

impl Watched {
    /// The signals of these tolerances.
    pub(super) fn new(tolerances: &[TimingTolerance]) -> Self {
        let mut names: Vec<SignalName> = Vec::new();
        for tolerance in tolerances {
            match tolerance {
                TimingTolerance::Late { signals, .. } => names.extend(signals.iter().cloned()),
                TimingTolerance::Behind { signal, others } => {
                    names.push(signal.clone());
                    names.extend(others.iter().cloned());
                }
                TimingTolerance::Jitter { .. }
                | TimingTolerance::Phase { .. }
                | TimingTolerance::TwoCycles { .. }
                | TimingTolerance::Start { .. } => {}
            }
        }
        names.sort();
        names.dedup();
        Self { chosen: Chosen::new(&names), names, last: Vec::new(), changed: Vec::new() }
    }

    /// Looks at a session that begins, or goes on from somewhere.
    pub(super) fn begin(&mut self, session: &Session) {
        self.chosen.find(session);
        self.last = self.chosen.bytes(session).map(<[u8]>::to_vec).collect();
        self.changed = vec![false; self.last.len()];
    }

    /// Looks at it after a step.
    pub(super) fn look(&mut self, session: &Session) {
        for ((bytes, last), changed) in self.chosen.bytes(session).zip(&mut self.last).zip(&mut self.changed) {
            *changed = *last != bytes;
            if *changed {
                last.clear();
                last.extend_from_slice(bytes);
            }
        }
    }

    fn find(&self, signal: &SignalName) -> Option<usize> {
        self.names.binary_search(signal).ok()
    }

    fn has_changed(&self, signal: &SignalName) -> bool {
        self.find(signal).and_then(|index| self.changed.get(index)).is_some_and(|changed| *changed)
    }

    fn is_set(&self, signal: &SignalName) -> bool {
        let bytes = self.find(signal).and_then(|index| self.last.get(index));
        bytes.is_some_and(|bytes| bytes.iter().any(|byte| *byte != 0))
    }
}

/// What may happen later in the set-up.
pub(super) fn at_start(tolerance: &TimingTolerance) -> Option<What> {
    match tolerance {
        TimingTolerance::Phase { task: TimedTask { client, name, .. }, .. } => {
            Some(What::Phase { client: client.clone(), task: name.clone() })
        }
        TimingTolerance::Start { client, .. } => Some(What::Start { client: client.clone() }),
        TimingTolerance::Late { .. }
        | TimingTolerance::Behind { .. }
        | TimingTolerance::Jitter { .. }
        | TimingTolerance::TwoCycles { .. } => None,
    }
}

/// What may happen later of what happened in the step that ended at `t_v`, on the way with these deviations.
pub(super) fn in_step(
    scenario: &Scenario,
    tolerance: &TimingTolerance,
    watched: &Watched,
    (t_v, deviations): (VirtualTime, &[Deviation]),
) -> Option<What> {
    match tolerance {
        TimingTolerance::Late { signals, together: true, .. } => {
            signals.iter().any(|signal| watched.has_changed(signal)).then(|| What::Frame { signals: signals.clone() })
        }
        TimingTolerance::Late { signals, together: false, .. } => {
            let signal = signals.first().filter(|signal| watched.has_changed(signal))?.clone();
            let declared = scenario.file().signals.get(&signal)?;
            Some(if declared.get_ref().ty == SignalType::BOOL {
                What::Edge { rises: watched.is_set(&signal), signal }
            } else {
                What::Change { signal }
            })
        }
        TimingTolerance::Behind { signal, others } => {
            let others: Vec<SignalName> = others.iter().filter(|other| watched.has_changed(other)).cloned().collect();
            (watched.has_changed(signal) && !others.is_empty()).then(|| What::Behind { signal: signal.clone(), others })
        }
        TimingTolerance::Jitter { task, .. } => {
            let what = What::Scan { client: task.client.clone(), task: task.name.clone() };
            is_due(scenario, task, t_v, deviations).then_some(what)
        }
        TimingTolerance::TwoCycles { task } => is_due(scenario, task, t_v, deviations).then(|| {
            let written = scenario.file().signals.iter();
            let outputs = written.filter(|(_, signal)| signal.get_ref().writer == task.client);
            What::TwoCycles {
                client: task.client.clone(),
                task: task.name.clone(),
                outputs: outputs.map(|(name, _)| name.clone()).collect(),
            }
        }),
        TimingTolerance::Phase { .. } | TimingTolerance::Start { .. } => None,
    }
}

/// By how many steps it may be late.
pub(super) fn sizes(tolerance: &TimingTolerance, step: TimeSpan) -> std::ops::RangeInclusive<u64> {
    match tolerance {
        TimingTolerance::Late { steps, .. }
        | TimingTolerance::Jitter { steps, .. }
        | TimingTolerance::Phase { steps, .. }
        | TimingTolerance::Start { steps, .. } => 1..=*steps,
        TimingTolerance::Behind { .. } => 1..=1,
        TimingTolerance::TwoCycles { task } => {
            let interval = task.interval.as_nanos() / step.as_nanos().max(1);
            interval..=interval
        }
    }
}

/// Whether a task is due in the step that ends at `t_v`, by its interval and what has moved it for good.
fn is_due(scenario: &Scenario, task: &TimedTask, t_v: VirtualTime, deviations: &[Deviation]) -> bool {
    let step_ns = scenario.plan().step().as_nanos();
    let moves = |deviation: &&Deviation| match &deviation.what {
        What::Phase { client, task: name } => *client == task.client && *name == task.name,
        What::Start { client } => *client == task.client,
        _ => false,
    };
    let late_ns: u64 = deviations.iter().filter(moves).map(|one| one.late_steps.saturating_mul(step_ns)).sum();
    let since_start_ns = t_v.as_nanos().saturating_sub(late_ns);
    since_start_ns > 0 && since_start_ns.is_multiple_of(task.interval.as_nanos())
}
