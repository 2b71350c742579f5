//! Which ways are gone: none with a deviation, then all with one, then all with two, up to the bound.

use std::collections::BTreeMap;

use onescan_scenario::Scenario;
use onescan_scenario::timing::TimingTolerance;
use onescan_server::time::VirtualTime;

use super::config::ExploreConfig;
use super::deviation::Deviation;
use super::known::{Known, Mark};
use super::path::{Fork, Path, SearchContext, Wanted};
use super::place;
use crate::forest::Budget;
use onescan_runner::run::SearchError;
use onescan_runner::run::expectation::ExpectationReport;

/// What came of an exploration.
pub(super) struct Found {
    /// When each run was complete.
    pub(super) until: VirtualTime,
    /// Ways that do not do what is expected, the fewest deviations first.
    pub(super) findings: Vec<Finding>,
    /// Different ways that were gone, or are known to hold.
    pub(super) schedules: u64,
    /// Those of them that came to a state from which all was known to hold.
    pub(super) joined: u64,
    /// Runs that took, each from its fork.
    pub(super) runs: Budget,
    /// What may happen later in the run without deviations, by the number of what allows it.
    pub(super) places: BTreeMap<usize, u64>,
    /// So many deviations at a time were tried, all of them; none if not even the run without could be judged.
    pub(super) exhausted: Option<u32>,
    /// Random schedules beyond that.
    pub(super) sampled: u64,
}

/// A way that does not do what is expected.
pub(super) struct Finding {
    pub(super) deviations: Vec<Deviation>,
    pub(super) violated: Vec<ExpectationReport>,
    pub(super) failure: Option<String>,
    pub(super) digest: Option<String>,
    /// How many deviations it was drawn with, if it was not found by going through all.
    pub(super) drawn: Option<usize>,
}

impl Finding {
    /// The finding of a way with these deviations, if it does not do what is expected.
    pub(super) fn of(path: Path, deviations: &[Deviation]) -> Option<Self> {
        let fails = !path.violated.is_empty() || path.failure.is_some();
        fails.then(|| Self {
            deviations: deviations.to_vec(),
            violated: path.violated,
            failure: path.failure,
            digest: path.digest.map(|digest| digest.to_string()),
            drawn: None,
        })
    }
}

/// What is left of the search.
enum Going {
    On {
        /// Schedules that were gone or are known to hold.
        schedules: u64,
        /// None of them is a finding.
        hold: bool,
    },
    Enough,
}

/// What was tried from a fork: when it is, how many schedules, and whether all hold.
type Tried = (VirtualTime, u64, bool);

pub(super) struct Search<'a> {
    pub(super) config: &'a ExploreConfig,
    pub(super) context: SearchContext<'a>,
    pub(super) found: Found,
    known: Known,
}

/// Tries all timings up to the bound, or to the first finding, and then random ones if that is asked for.
///
/// # Errors
/// The session cannot be formed, saved or taken up.
pub(super) fn search(
    config: &ExploreConfig,
    scenario: &Scenario,
    tolerances: &[TimingTolerance],
    until: VirtualTime,
) -> Result<Found, SearchError> {
    let found = Found {
        until,
        findings: Vec::new(),
        schedules: 0,
        joined: 0,
        runs: Budget::counted(config.runs_max, config.how_far.clone()),
        places: BTreeMap::new(),
        exhausted: None,
        sampled: 0,
    };
    let context = SearchContext::new(scenario, until, tolerances);
    let mut search = Search { config, context, found, known: Known::default() };
    // Each level goes the ways of those below it again: to keep their forks instead would take memory for the whole tree.
    for level in 0..=config.bound {
        if let Going::Enough = search.below(None, &mut Vec::new(), level)? {
            return Ok(search.found);
        }
        search.found.exhausted = Some(level);
    }
    search.sample()?;
    Ok(search.found)
}

impl Search<'_> {
    /// Goes all ways with `more` deviations beyond these.
    fn below(&mut self, from: Option<&Fork>, deviations: &mut Vec<Deviation>, more: u32) -> Result<Going, SearchError> {
        if self.found.runs.is_spent() {
            return Ok(Going::Enough);
        }
        self.found.runs.spend();
        let known = (!self.config.no_merge).then_some((more, &self.known));
        let path = self.context.go(from, deviations, Wanted { forks: more > 0, known })?;
        if deviations.is_empty() && more > 0 {
            self.found.places.clear();
            path.forks.iter().for_each(|fork| *self.found.places.entry(fork.tolerance).or_default() += 1);
        }
        let joined = path.joined.unwrap_or(0);
        self.found.schedules += joined;
        self.found.joined += joined;
        if more == 0 {
            return Ok(self.judged(path, deviations));
        }
        let mut tried: Vec<Tried> = Vec::new();
        let step = self.context.scenario.plan().step();
        let forks: Vec<&Fork> = path.forks.iter().filter(|fork| is_next(fork, deviations)).collect();
        // The smallest lateness of all edges first: that is what a finding is to show.
        let sizes = |fork: &Fork| place::sizes(&self.context.tolerances[fork.tolerance], step);
        let mut all: Vec<(u64, &Fork)> =
            forks.iter().flat_map(|fork| sizes(fork).map(move |size| (size, *fork))).collect();
        all.sort_by_key(|(size, _)| *size);
        for (late_steps, fork) in all {
            let what = (fork.tolerance, fork.what.clone());
            let Some(deviation) = Deviation::new(what, fork.edge, late_steps, step) else { continue };
            deviations.push(deviation);
            let going = self.below(Some(fork), deviations, more - 1)?;
            deviations.pop();
            match going {
                Going::On { schedules, hold } => tried.push((fork.edge, schedules, hold)),
                Going::Enough => return Ok(Going::Enough),
            }
        }
        self.note(&path.marks, &tried, joined);
        let schedules = tried.iter().map(|(_, schedules, _)| schedules).sum::<u64>() + joined;
        Ok(Going::On { schedules, hold: tried.iter().all(|(.., hold)| *hold) })
    }

    /// Notes how many schedules follow each boundary of a way, where all of them hold.
    fn note(&mut self, marks: &[Mark], tried: &[Tried], joined: u64) {
        for Mark { joined: at, key } in marks {
            let after = || tried.iter().filter(|(edge, ..)| edge > at);
            if after().all(|(.., hold)| *hold) {
                let schedules = after().map(|(_, schedules, _)| schedules).sum::<u64>() + joined;
                self.known.add(key.clone(), schedules);
            }
        }
    }

    fn judged(&mut self, path: Path, deviations: &[Deviation]) -> Going {
        if let Some(schedules) = path.joined {
            self.note(&path.marks, &[], schedules);
            return Going::On { schedules, hold: true };
        }
        self.found.schedules += 1;
        let marks = path.marks.clone();
        let Some(finding) = Finding::of(path, deviations) else {
            self.note(&marks, &[], 1);
            return Going::On { schedules: 1, hold: true };
        };
        self.found.findings.push(finding);
        // Beyond a run that fails without any deviation there is nothing to learn.
        let goes_on = self.config.all && !deviations.is_empty();
        if goes_on { Going::On { schedules: 1, hold: false } } else { Going::Enough }
    }
}

/// True if it comes after all that is late already, so that no two are tried in both orders, and is not what arrives, or
/// is held or moved, by one of them.
pub(super) fn is_next(fork: &Fork, deviations: &[Deviation]) -> bool {
    let is_after = deviations.last().is_none_or(|last| (fork.edge, fork.tolerance) > (last.edge, last.tolerance));
    let arrives = deviations.iter().any(|one| one.what.meets(&fork.what) && fork.edge <= one.arrives);
    is_after && !arrives
}
