//! Runs that others fork from: each trial forks from the one with which it has most in common.

use onescan_scenario::Scenario;
use onescan_server::time::VirtualTime;

use super::fork_points::{Checkpoints, ForkPoints};
use super::session::{now_and_then, run_until};
use onescan_runner::run::SearchError;
use onescan_runner::run::judged::Judged;

/// A run that others fork from.
pub(crate) struct BaseRun {
    pub(crate) scenario: Scenario,
    pub(crate) checkpoints: Checkpoints,
}

/// The base runs of a search.
pub(crate) struct Forest {
    fork_points: ForkPoints,
    /// The one that a trial forked from last comes last.
    base_runs: Vec<BaseRun>,
    base_runs_max: usize,
}

/// A trial that is over or decided.
pub(crate) struct TrialRun<T> {
    /// Where it forked; nothing if it began at the start.
    pub(crate) forked: Option<VirtualTime>,
    /// What was decided before its end.
    pub(crate) decided: Option<T>,
    pub(crate) checkpoints: Checkpoints,
}

impl Forest {
    /// A forest that keeps the checkpoints of so many runs.
    pub(crate) fn new(fork_points: ForkPoints, base_runs_max: usize) -> Self {
        Self { fork_points, base_runs: Vec::new(), base_runs_max }
    }

    /// From now on runs keep checkpoints at these boundaries.
    pub(crate) fn fork_at(&mut self, fork_points: ForkPoints) {
        self.fork_points = fork_points;
    }

    /// Takes a session of `scenario`, which is about to begin, to its end or to where it is `decided`.
    ///
    /// # Errors
    /// The session cannot go on, or a client cannot save its state.
    pub(crate) fn run<T>(
        &mut self,
        judged: &mut Judged<'_>,
        scenario: &Scenario,
        decided: impl Fn(&Judged<'_>) -> Option<T>,
    ) -> Result<TrialRun<T>, SearchError> {
        let forked = self.fork(judged, scenario);
        if forked.is_none() {
            judged.begin()?;
        }
        let mut checkpoints = Checkpoints::new();
        let mut decided = now_and_then(decided);
        let decided = run_until(judged, |judged| -> Result<_, SearchError> {
            // Where it forked the base run has the checkpoint: a second one would only take memory.
            if forked != Some(judged.session().t_v()) {
                self.fork_points.keep(judged, &mut checkpoints)?;
            }
            Ok(decided(judged))
        })?;
        Ok(TrialRun { forked, decided, checkpoints })
    }

    /// Lets later trials fork from a run. The base run that no trial has forked from for longest makes room for it.
    pub(crate) fn keep(&mut self, base_run: BaseRun) {
        if base_run.checkpoints.is_empty() {
            return;
        }
        self.base_runs.push(base_run);
        if self.base_runs.len() > self.base_runs_max {
            self.base_runs.remove(0);
        }
    }

    /// Resumes from the latest checkpoint of a base run that did the same up to there. Nothing if there is none.
    fn fork(&mut self, judged: &mut Judged<'_>, scenario: &Scenario) -> Option<VirtualTime> {
        let mut found: Vec<(VirtualTime, usize)> = Vec::new();
        for (index, base_run) in self.base_runs.iter().enumerate() {
            let departure = scenario.departs_from(&base_run.scenario);
            if departure.from_start || !departure.conditions.is_empty() {
                continue;
            }
            let latest = base_run.checkpoints.range(..=departure.at.unwrap_or(VirtualTime::MAX)).next_back();
            found.extend(latest.map(|(t_v, _)| (*t_v, index)));
        }
        found.sort_unstable();
        // A session that is set up otherwise refuses the checkpoint, and the next one is tried.
        let (t_v, index) = found.into_iter().rev().find(|(t_v, index)| {
            self.base_runs[*index].checkpoints.get(t_v).is_some_and(|checkpoint| judged.resume(checkpoint).is_ok())
        })?;
        let forked_from = self.base_runs.remove(index);
        self.base_runs.push(forked_from);
        Some(t_v)
    }
}
