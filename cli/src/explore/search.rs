//! Which ways are gone: none with a deviation, then all with one, then all with two, up to the bound.

use onescan_scenario::Scenario;
use onescan_server::time::VirtualTime;

use super::ExploreError;
use super::config::ExploreConfig;
use super::deviation::Deviation;
use super::path::{Fork, Ground, Path};
use crate::run::expectation::ExpectationReport;

/// What came of an exploration.
pub(super) struct Found {
    /// When each run was complete.
    pub(super) until: VirtualTime,
    /// Ways that do not do what is expected, the fewest deviations first.
    pub(super) findings: Vec<Finding>,
    /// Different ways that were gone.
    pub(super) schedules: u64,
    /// Runs that took, each from its fork.
    pub(super) runs: u64,
    /// Edges of the run without deviations.
    pub(super) edges: usize,
    /// So many deviations at a time were tried, all of them; none if not even the run without could be judged.
    pub(super) exhausted: Option<u32>,
}

/// A way that does not do what is expected.
pub(super) struct Finding {
    pub(super) deviations: Vec<Deviation>,
    pub(super) violated: Vec<ExpectationReport>,
    pub(super) failure: Option<String>,
    pub(super) digest: Option<String>,
}

/// What is left of the search.
enum Going {
    On,
    Enough,
}

struct Search<'a> {
    config: &'a ExploreConfig,
    ground: Ground<'a>,
    found: Found,
}

/// Tries all timings up to the bound, or to the first finding.
///
/// # Errors
/// The session cannot be formed, saved or taken up.
pub(super) fn search(config: &ExploreConfig, scenario: &Scenario, until: VirtualTime) -> Result<Found, ExploreError> {
    let found = Found { until, findings: Vec::new(), schedules: 0, runs: 0, edges: 0, exhausted: None };
    let mut search = Search { config, ground: Ground::new(scenario, until), found };
    // Each level goes the ways of those below it again: to keep their forks instead would take memory for the whole tree.
    for level in 0..=config.bound {
        if let Going::Enough = search.below(None, &mut Vec::new(), level)? {
            break;
        }
        search.found.exhausted = Some(level);
    }
    Ok(search.found)
}

impl Search<'_> {
    /// Goes all ways with `more` deviations beyond these.
    fn below(
        &mut self,
        from: Option<&Fork>,
        deviations: &mut Vec<Deviation>,
        more: u32,
    ) -> Result<Going, ExploreError> {
        if self.found.runs >= self.config.runs_max.get() {
            return Ok(Going::Enough);
        }
        self.found.runs += 1;
        let path = self.ground.go(from, deviations, more > 0)?;
        if deviations.is_empty() && more > 0 {
            self.found.edges = path.forks.len();
        }
        if more == 0 {
            return Ok(self.judged(path, deviations));
        }
        let step = self.ground.scenario.plan().step();
        let forks: Vec<&Fork> = path.forks.iter().filter(|fork| self.is_next(fork, deviations)).collect();
        // The smallest lateness of all edges first: that is what a finding is to show.
        let latest = self.ground.scenario.late().iter().map(|late| late.steps).max().unwrap_or(0);
        for late_steps in 1..=latest {
            for fork in &forks {
                let late = &self.ground.scenario.late()[fork.signal];
                if late_steps > late.steps {
                    continue;
                }
                let signal = late.signal.clone();
                let Some(deviation) = Deviation::new(signal, fork.rises, fork.edge, late_steps, step) else { continue };
                deviations.push(deviation);
                let going = self.below(Some(fork), deviations, more - 1)?;
                deviations.pop();
                if let Going::Enough = going {
                    return Ok(Going::Enough);
                }
            }
        }
        Ok(Going::On)
    }

    /// True if the edge comes after all that are late already, so that no two are tried in both orders, and is not one of
    /// them that arrives.
    fn is_next(&self, fork: &Fork, deviations: &[Deviation]) -> bool {
        let late = self.ground.scenario.late();
        let number = |deviation: &Deviation| late.iter().position(|late| late.signal == deviation.signal);
        let is_after = deviations
            .last()
            .is_none_or(|last| fork.edge > last.edge || fork.edge == last.edge && Some(fork.signal) > number(last));
        let arrives = deviations.iter().any(|one| number(one) == Some(fork.signal) && fork.edge <= one.arrives);
        is_after && !arrives
    }

    fn judged(&mut self, path: Path, deviations: &[Deviation]) -> Going {
        self.found.schedules += 1;
        if path.violated.is_empty() && path.failure.is_none() {
            return Going::On;
        }
        self.found.findings.push(Finding {
            deviations: deviations.to_vec(),
            violated: path.violated,
            failure: path.failure,
            digest: path.digest.map(|digest| digest.to_string()),
        });
        // Beyond a run that fails without any deviation there is nothing to learn.
        if self.config.all && !deviations.is_empty() { Going::On } else { Going::Enough }
    }
}
