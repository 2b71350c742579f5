//! Points, simulated: each run forks from the one before it with which it has most in common.

use std::collections::BTreeSet;
use std::convert::Infallible;

use onescan_iec_run::coverage::Counted;
use onescan_scenario::Scenario;
use onescan_scenario::expect::{Margin, Outcome, Verdict};
use onescan_server::digest::Digest;
use onescan_server::time::VirtualTime;

use super::space::{Point, Space};
use crate::forest::{BaseRun, Forest, ForkPoints, SearchKind, TrialRun, form};
use onescan_runner::run::SearchError;

/// Runs of which checkpoints are kept.
const BASE_RUNS_MAX: usize = 8;
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

/// Where points are simulated, one after the other.
pub(super) struct Evaluator<'a> {
    space: &'a Space<'a>,
    /// The expectation that is to be broken; all of them if absent.
    expect: Option<usize>,
    wanted: Wanted,
    forest: Forest,
}

impl<'a> Evaluator<'a> {
    pub(super) fn new(space: &'a Space<'a>, expect: Option<usize>, wanted: Wanted, forks: Forks) -> Self {
        let step = space.step();
        let before: BTreeSet<VirtualTime> = space.instants().into_iter().map(|at| at.saturating_sub(step)).collect();
        let fork_points = match (wanted, forks) {
            (Wanted::Branches, _) => ForkPoints::default(),
            (Wanted::Margins, Forks::First) => ForkPoints::first_of(before),
            (Wanted::Margins, Forks::Everywhere) => ForkPoints::among(before),
        };
        Self { space, expect, wanted, forest: Forest::new(fork_points, BASE_RUNS_MAX) }
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
        let mut judged = form(SearchKind::Falsify, &scenario, self.space.until, [])?;
        let TrialRun { forked, checkpoints, .. } = self.forest.run(&mut judged, &scenario, |_| None::<Infallible>)?;
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
        self.forest.keep(BaseRun { scenario, checkpoints });
        Ok(sample)
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
