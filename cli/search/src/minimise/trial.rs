//! Sets of entries, tried: each run forks from the one before it with which it has most in common.

use std::collections::BTreeMap;
use std::num::NonZeroU64;

use onescan_scenario::Scenario;
use onescan_scenario::case::written::{Entry, Written};
use onescan_scenario::expect::TraceEnd;
use onescan_server::time::{TimeSpan, VirtualTime};

use super::target::{First, Target};
use crate::forest::{BaseRun, Budget, Forest, ForkPoints, SearchKind, TrialRun, form};
use onescan_runner::run::SearchError;
use onescan_runner::run::judged::{Judged, Judgement};

/// Runs of which checkpoints are kept.
const BASE_RUNS_MAX: usize = 24;

/// What has been tried so far.
pub(super) struct Trials<'a> {
    scenario: &'a Scenario,
    written: Written,
    target: Target,
    /// A trial that has not failed by then holds.
    by: VirtualTime,
    /// Whether nothing comes after that in a run of the case.
    end: TraceEnd,
    known: BTreeMap<String, Option<VirtualTime>>,
    forest: Forest,
    budget: Budget,
}

/// A forest of runs that others fork from before one of these entries begins.
pub(super) fn forest(entries: &[Entry], step: TimeSpan) -> Forest {
    Forest::new(before(entries, step), BASE_RUNS_MAX)
}

/// The boundaries before these entries begin, or some of them if there are many.
fn before(entries: &[Entry], step: TimeSpan) -> ForkPoints {
    let before = |entry: &Entry| {
        let grid = entry.begin().as_nanos().div_ceil(step.as_nanos()).saturating_mul(step.as_nanos());
        VirtualTime::from_nanos(grid).saturating_sub(step)
    };
    ForkPoints::among(entries.iter().map(before).collect())
}

impl<'a> Trials<'a> {
    pub(super) fn new(
        scenario: &'a Scenario,
        written: Written,
        first: &First,
        (until, forest): (VirtualTime, Forest),
        runs_max: NonZeroU64,
    ) -> Self {
        let end = if first.at < until { TraceEnd::Cut } else { TraceEnd::Complete };
        Self {
            scenario,
            written,
            target: first.target.clone(),
            by: first.at,
            end,
            known: BTreeMap::new(),
            forest,
            budget: Budget::new(runs_max),
        }
    }

    /// Trials so far.
    pub(super) fn done(&self) -> u64 {
        self.budget.done()
    }

    /// True if no more are allowed, so that what was not tried is taken to hold.
    pub(super) fn is_spent(&self) -> bool {
        self.budget.is_spent()
    }

    /// The time until which a trial is to fail.
    pub(super) fn by(&self) -> VirtualTime {
        self.by
    }

    /// From now on a trial that has not failed by then holds: another one that is as good has.
    pub(super) fn fail_by(&mut self, at: VirtualTime) {
        if at < self.by {
            (self.by, self.end) = (at, TraceEnd::Cut);
        }
    }

    /// The length of a step.
    pub(super) fn step(&self) -> TimeSpan {
        self.scenario.plan().step()
    }

    /// The entries as a case.
    pub(super) fn text(
        &self,
        name: &str,
        entries: &[Entry],
        until: Option<VirtualTime>,
        about: Option<&str>,
    ) -> String {
        let mut written = self.written.clone();
        written.until = until;
        written.about = about.map(str::to_owned).or(written.about);
        written.to_toml(name, entries)
    }

    /// The scenario with a case alone.
    pub(super) fn applied(&self, text: &str) -> Result<Scenario, SearchError> {
        Ok(self.scenario.with_last_of(text)?)
    }

    /// Lets runs keep checkpoints before these entries begin.
    pub(super) fn fork_before(&mut self, entries: &[Entry]) {
        self.forest.fork_at(before(entries, self.step()));
    }

    /// When a run with these entries alone fails, if it does.
    ///
    /// # Errors
    /// The session cannot be formed or go on.
    pub(super) fn fails(&mut self, entries: &[Entry]) -> Result<Option<VirtualTime>, SearchError> {
        let text = self.text("trial", entries, Some(self.by), None);
        if let Some(known) = self.known.get(&text) {
            return Ok(*known);
        }
        if self.is_spent() {
            return Ok(None);
        }
        self.budget.spend();
        let scenario = self.applied(&text)?;
        let mut judged = form(SearchKind::Minimise, &scenario, self.by, [])?;
        let expectation = self.target.expectation();
        let is_met = |judged: &Judged<'_>| judged.violated().any(|known| expectation == Some(known)).then_some(());
        let TrialRun { decided, checkpoints, .. } = self.forest.run(&mut judged, &scenario, is_met)?;
        let at = self.target.met(&match decided {
            Some(()) => Judgement { digest: None, violated: judged.abandon(), failure: None },
            None => judged.finish(self.end)?,
        });
        self.forest.keep(BaseRun { scenario, checkpoints });
        self.known.insert(text, at);
        Ok(at)
    }
}
