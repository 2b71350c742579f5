//! Sets of entries, tried: each run forks from the one before it with which it has most in common.

use std::collections::{BTreeMap, BTreeSet};
use std::num::NonZeroU64;

use onescan_scenario::Scenario;
use onescan_scenario::case::written::{Entry, Written};
use onescan_scenario::expect::TraceEnd;
use onescan_server::time::{TimeSpan, VirtualTime};

use super::target::{self, First, Target};
use onescan_runner::run::SearchError;
use onescan_runner::run::judged::{Judged, Judgement, Moment};

/// Moments that are kept of a run.
const MOMENTS_MAX: usize = 64;
/// Runs of which moments are kept: those that were of use last.
const TRUNKS_MAX: usize = 24;
/// Steps between two looks at whether it is decided.
const LOOK_STRIDE: u64 = 64;

/// What has been tried so far.
pub(super) struct Trials<'a> {
    scenario: &'a Scenario,
    written: Written,
    target: Target,
    /// A trial that has not failed by then holds.
    by: VirtualTime,
    /// Whether nothing comes after that in a run of the case.
    end: TraceEnd,
    /// Boundaries from which others may fork.
    spots: BTreeSet<VirtualTime>,
    known: BTreeMap<String, Option<VirtualTime>>,
    trunks: Vec<Trunk>,
    done: u64,
    runs_max: NonZeroU64,
}

/// The boundaries before these entries begin, or some of them if there are many.
pub(super) fn spots(entries: &[Entry], step: TimeSpan) -> BTreeSet<VirtualTime> {
    let before = |entry: &Entry| {
        let grid = entry.begin().as_nanos().div_ceil(step.as_nanos()).saturating_mul(step.as_nanos());
        VirtualTime::from_nanos(grid).saturating_sub(step)
    };
    let all: BTreeSet<VirtualTime> = entries.iter().map(before).collect();
    let stride = all.len().div_ceil(MOMENTS_MAX).max(1);
    all.into_iter().step_by(stride).collect()
}

/// A run from which others fork.
pub(super) struct Trunk {
    pub(super) scenario: Scenario,
    pub(super) moments: BTreeMap<VirtualTime, Moment>,
}

impl<'a> Trials<'a> {
    pub(super) fn new(
        scenario: &'a Scenario,
        written: Written,
        first: &First,
        (until, trunk): (VirtualTime, Trunk),
        runs_max: NonZeroU64,
    ) -> Self {
        let end = if first.at < until { TraceEnd::Cut } else { TraceEnd::Complete };
        Self {
            scenario,
            written,
            target: first.target.clone(),
            by: first.at,
            end,
            spots: trunk.moments.keys().copied().collect(),
            known: BTreeMap::new(),
            trunks: vec![trunk],
            done: 0,
            runs_max,
        }
    }

    /// Trials so far.
    pub(super) fn done(&self) -> u64 {
        self.done
    }

    /// True if no more are allowed, so that what was not tried is taken to hold.
    pub(super) fn is_spent(&self) -> bool {
        self.done >= self.runs_max.get()
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

    /// Lets runs keep the boundaries before these entries begin.
    pub(super) fn fork_before(&mut self, entries: &[Entry]) {
        self.spots = spots(entries, self.step());
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
        self.done += 1;
        let scenario = self.applied(&text)?;
        let (at, moments) = self.run(&scenario)?;
        self.trunks.push(Trunk { scenario, moments });
        if self.trunks.len() > TRUNKS_MAX {
            self.trunks.remove(0);
        }
        self.known.insert(text, at);
        Ok(at)
    }

    fn run(
        &mut self,
        scenario: &Scenario,
    ) -> Result<(Option<VirtualTime>, BTreeMap<VirtualTime, Moment>), SearchError> {
        let mut judged = target::form(scenario, self.by)?;
        if !self.resume(&mut judged, scenario) {
            judged.begin()?;
        }
        let mut moments = BTreeMap::new();
        let mut steps: u64 = 0;
        loop {
            let t_v = judged.session().t_v();
            if self.spots.contains(&t_v)
                && let Some(moment) = judged.moment()?
            {
                moments.insert(t_v, moment);
            }
            let is_decided =
                || self.target.expectation().is_some_and(|name| judged.violated().any(|known| known == name));
            if steps.is_multiple_of(LOOK_STRIDE) && is_decided() {
                let judgement = Judgement { digest: None, violated: judged.abandon(), failure: None };
                return Ok((self.target.met(&judgement), moments));
            }
            if !judged.step()? {
                let at = self.target.met(&judged.finish(self.end)?);
                return Ok((at, moments));
            }
            steps += 1;
        }
    }

    /// Goes on from the latest moment of a run before it that did the same up to there.
    fn resume(&mut self, judged: &mut Judged<'_>, scenario: &Scenario) -> bool {
        let mut found: Vec<(VirtualTime, usize)> = Vec::new();
        for (index, trunk) in self.trunks.iter().enumerate() {
            let departure = scenario.departs_from(&trunk.scenario);
            if departure.from_start || !departure.conditions.is_empty() {
                continue;
            }
            let latest = trunk.moments.range(..=departure.at.unwrap_or(VirtualTime::MAX)).next_back();
            found.extend(latest.map(|(t_v, _)| (*t_v, index)));
        }
        found.sort_unstable();
        // A run that was set otherwise says so itself.
        let taken = found.into_iter().rev().find(|(t_v, index)| {
            self.trunks[*index].moments.get(t_v).is_some_and(|moment| judged.resume(moment).is_ok())
        });
        if let Some((_, index)) = taken {
            let of_use = self.trunks.remove(index);
            self.trunks.push(of_use);
        }
        taken.is_some()
    }
}
