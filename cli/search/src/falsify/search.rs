//! The search: points that the optimiser asks for, simulated, and their worth.

use std::collections::{BTreeMap, BTreeSet};

use onescan_scenario::Scenario;
use onescan_server::signal::did_you_mean;

use super::config::{FalsifyConfig, Objective};
use super::evaluator::{Branch, Evaluator, Forks, Sample, Wanted};
use super::optimiser;
use super::space::{Point, Space};
use crate::forest::{Budget, Workers};
use onescan_runner::error::Usage;
use onescan_runner::run::SearchError;

/// What came of a search.
pub(super) struct Found {
    /// The finding, or the point that came nearest to one.
    pub(super) best: Sample,
    /// Simulations that it took.
    pub(super) simulations: u64,
    /// Of these, how many did not begin at the start.
    pub(super) forked: u64,
    /// Branches that were taken, and how many there are, if they were looked at.
    pub(super) branches: Option<(usize, usize)>,
}

/// The number of the expectation that is to be broken; nothing for all of them.
///
/// # Errors
/// There is none of this name, or none at all.
pub(super) fn expectation(scenario: &Scenario, wanted: Option<&str>) -> Result<Option<usize>, Usage> {
    let named = &scenario.expectations().named;
    if named.is_empty() {
        let help = "write an `[[expect]]`: what must hold whatever the inputs are (docs/expectations.md)".to_owned();
        return Err(Usage::new("the scenario expects nothing", Some(help)));
    }
    let Some(wanted) = wanted else { return Ok(None) };
    let number = named.iter().position(|(name, _)| name == wanted);
    number.map(Some).ok_or_else(|| {
        let help = did_you_mean(wanted, named.iter().map(|(name, _)| name.as_str()));
        Usage::new(format!("the scenario has no expectation `{wanted}`"), help)
    })
}

/// Looks for a point that breaks what is expected.
///
/// # Errors
/// A session cannot be formed or go on.
pub(super) fn search(config: &FalsifyConfig, space: &Space<'_>, expect: Option<usize>) -> Result<Found, SearchError> {
    let wanted = if config.objective == Objective::Robustness { Wanted::Margins } else { Wanted::Branches };
    let mut workers = Workers::new(config.jobs, || Evaluator::new(space, expect, wanted, Forks::First));
    let mut optimiser =
        optimiser::new(config.optimiser, space.dimensions(), config.seed, |random| space.corners(random));
    let mut atlas = Atlas { objective: config.objective, taken: BTreeMap::new(), all: 0 };
    let (mut budget, mut forked) = (Budget::new(config.runs_max), 0);
    let mut best: Option<Sample> = None;
    loop {
        let mut points = optimiser.ask();
        points.truncate(usize::try_from(budget.left()).unwrap_or(usize::MAX));
        let simulate = |evaluator: &mut Evaluator<'_>, point: &Point| evaluator.simulate(point);
        let samples = workers.run(&points, simulate, Sample::is_finding)?;
        let mut values = Vec::new();
        for sample in samples {
            budget.spend();
            forked += u64::from(sample.forked.is_some());
            values.push(atlas.worth(&sample));
            if sample.is_finding() || best.as_ref().is_none_or(|best| sample.robustness < best.robustness) {
                best = Some(sample);
            }
        }
        match best.take() {
            Some(best) if best.is_finding() || budget.is_spent() => {
                let branches = (wanted == Wanted::Branches).then_some((atlas.taken.len(), atlas.all));
                return Ok(Found { best, simulations: budget.done(), forked, branches });
            }
            going_on => best = going_on,
        }
        optimiser.tell(&values);
    }
}

/// The branches that were taken so far.
struct Atlas {
    objective: Objective,
    /// In how many runs each was.
    taken: BTreeMap<Branch, u32>,
    all: usize,
}

impl Atlas {
    /// What a sample is worth to the optimiser, after those before it; the less the better.
    fn worth(&mut self, sample: &Sample) -> f64 {
        let (branches, all): &(BTreeSet<Branch>, usize) = &sample.branches;
        self.all = self.all.max(*all);
        let (mut rarity, mut new) = (0.0, 0_u32);
        for branch in branches {
            let times = self.taken.entry(branch.clone()).or_default();
            new += u32::from(*times == 0);
            rarity += 1.0 / f64::from(*times + 1);
            *times += 1;
        }
        match self.objective {
            Objective::Coverage => -rarity,
            Objective::Both if sample.robustness > 0.0 => sample.robustness / f64::from(new + 1),
            Objective::Robustness | Objective::Both => sample.robustness,
        }
    }
}
