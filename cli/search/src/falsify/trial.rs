//! Points, simulated: each run forks from the one before it with which it has most in common.

use std::collections::{BTreeMap, BTreeSet};

use onescan_iec_run::coverage::Counted;
use onescan_scenario::Scenario;
use onescan_scenario::expect::{Margin, Outcome, Verdict};
use onescan_server::digest::Digest;
use onescan_server::time::VirtualTime;

use super::space::{Point, Space, form};
use onescan_runner::run::SearchError;
use onescan_runner::run::judged::{Judged, Moment};

/// Moments that are kept of a run.
const MOMENTS_MAX: usize = 64;
/// Runs of which moments are kept: those that were of use last.
const TRUNKS_MAX: usize = 8;
/// What an infinite margin is to who looks for a small one.
pub(super) const FAR: f64 = 1e12;

/// What a simulation is asked for beside its margins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wanted {
    Margins,
    /// Also the branches that its PLCs took. What was taken before a fork is not known, so that it begins at the start.
    Branches,
}

/// Where later runs may fork.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Forks {
    /// Where inputs first change: all runs have that in common.
    First,
    /// Wherever they do: runs change one thing after the other.
    Everywhere,
}

/// An outcome of a decision: file, line, column, number.
pub(super) type Branch = (String, u32, u32, u32);

/// What came of a point.
#[derive(Clone, Debug)]
pub(super) struct Sample {
    pub(super) point: Point,
    /// The least margin by which what is to be broken holds; negative if it does not.
    pub(super) robustness: f64,
    /// Expectations that do not hold.
    pub(super) violated: Vec<String>,
    /// How a client failed, if one did.
    pub(super) failure: Option<String>,
    pub(super) digest: Option<Digest>,
    /// From where on it was run; nothing for the start.
    pub(super) forked: Option<VirtualTime>,
    /// Branches that were taken, and how many there are.
    pub(super) branches: (BTreeSet<Branch>, usize),
}

impl Sample {
    /// True if what is to be broken is.
    pub(super) fn is_finding(&self) -> bool {
        !self.violated.is_empty() || self.failure.is_some()
    }
}

/// A run from which others fork.
struct Trunk {
    scenario: Scenario,
    moments: BTreeMap<VirtualTime, Moment>,
}

/// Where points are simulated, one after the other.
pub(super) struct Bench<'a> {
    space: &'a Space<'a>,
    /// The expectation that is to be broken; all of them if absent.
    expect: Option<usize>,
    wanted: Wanted,
    spots: BTreeSet<VirtualTime>,
    trunks: Vec<Trunk>,
}

impl<'a> Bench<'a> {
    pub(super) fn new(space: &'a Space<'a>, expect: Option<usize>, wanted: Wanted, forks: Forks) -> Self {
        let step = space.step();
        let before: BTreeSet<VirtualTime> = space.instants().into_iter().map(|at| at.saturating_sub(step)).collect();
        let stride = before.len().div_ceil(MOMENTS_MAX).max(1);
        let spots = match (wanted, forks) {
            (Wanted::Branches, _) => BTreeSet::new(),
            (Wanted::Margins, Forks::First) => before.into_iter().take(1).collect(),
            (Wanted::Margins, Forks::Everywhere) => before.into_iter().step_by(stride).collect(),
        };
        Self { space, expect, wanted, spots, trunks: Vec::new() }
    }

    /// Simulates a point.
    ///
    /// # Errors
    /// The session cannot be formed or go on.
    pub(super) fn simulate(&mut self, point: &[f64]) -> Result<Sample, SearchError> {
        let mut scenario = self.space.applied(&self.space.text(None, point))?;
        if self.wanted == Wanted::Branches {
            scenario.cover();
        }
        let mut judged = form(&scenario, self.space.until)?;
        let forked = self.resume(&mut judged, &scenario);
        if forked.is_none() {
            judged.begin()?;
        }
        let mut moments = BTreeMap::new();
        loop {
            let t_v = judged.session().t_v();
            if self.spots.contains(&t_v)
                && forked != Some(t_v)
                && let Some(moment) = judged.moment()?
            {
                moments.insert(t_v, moment);
            }
            if !judged.step()? {
                break;
            }
        }
        let measured = judged.measure()?;
        let names = &scenario.expectations().named;
        let looked_at = |number: usize| self.expect.is_none_or(|wanted| wanted == number);
        let outcomes = measured.outcomes.iter().enumerate().filter(|(number, _)| looked_at(*number));
        let robustness = outcomes.clone().map(|(_, outcome)| robustness(outcome)).fold(FAR, f64::min);
        let is_violated = |outcome: &Outcome| matches!(outcome.verdict, Verdict::Violated { .. });
        let violated = outcomes.filter(|(_, outcome)| is_violated(outcome));
        let violated = violated.filter_map(|(number, _)| names.get(number).map(|(name, _)| name.clone())).collect();
        let sample = Sample {
            point: point.to_vec(),
            robustness,
            violated,
            failure: measured.failure.map(|failure| failure.to_string()),
            digest: measured.digest,
            forked,
            branches: branches(&scenario),
        };
        if !moments.is_empty() {
            self.trunks.push(Trunk { scenario, moments });
            if self.trunks.len() > TRUNKS_MAX {
                self.trunks.remove(0);
            }
        }
        Ok(sample)
    }

    /// Goes on from the latest moment of a run before it that did the same up to there.
    fn resume(&mut self, judged: &mut Judged<'_>, scenario: &Scenario) -> Option<VirtualTime> {
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
        let (t_v, index) = found.into_iter().rev().find(|(t_v, index)| {
            self.trunks[*index].moments.get(t_v).is_some_and(|moment| judged.resume(moment).is_ok())
        })?;
        let of_use = self.trunks.remove(index);
        self.trunks.push(of_use);
        Some(t_v)
    }
}

/// The margin of an expectation as a number that can be compared: what was seen of it where it is open, and one that is
/// finite where BOOLs decide.
fn robustness(outcome: &Outcome) -> f64 {
    let Margin { least, greatest } = outcome.margin;
    let margin = if greatest.is_finite() { greatest } else { least };
    match outcome.verdict {
        Verdict::Violated { .. } if !margin.is_finite() => -FAR,
        Verdict::Violated { .. } => margin.min(0.0),
        _ if margin.is_finite() => margin + 0.0,
        _ => FAR,
    }
}

/// The branches that a run has taken whose clients are gone, and how many there are.
fn branches(scenario: &Scenario) -> (BTreeSet<Branch>, usize) {
    let Some(sink) = scenario.coverage() else { return (BTreeSet::new(), 0) };
    // A client that panicked has given nothing; the rest still counts.
    let coverage = sink.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    let taken = coverage.rows().into_iter().filter(|row| row.count > 0).filter_map(|row| match row.of {
        Counted::Outcome { column, outcome } => Some((row.file, row.line, column, outcome)),
        Counted::Unit(_) | Counted::Line => None,
    });
    (taken.collect(), coverage.branches().0)
}
