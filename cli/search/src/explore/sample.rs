//! Random schedules with more deviations than all of which could be tried.

use std::ops::RangeInclusive;

use onescan_server::random::{Random, seed_for};

use super::deviation::Deviation;
use super::path::{Fork, Path, Wanted};
use super::place;
use super::search::{Finding, Search, is_next};
use onescan_runner::run::SearchError;

/// How often a schedule is drawn again in which too little could happen later.
const DRAWS_MAX: u32 = 8;

const TO_THE_END: Wanted<'static> = Wanted { forks: false, known: None };

impl Search<'_> {
    /// How many deviations a random schedule has.
    pub(super) fn sizes(&self) -> RangeInclusive<u32> {
        self.config.bound.saturating_add(1)..=self.config.most.max(self.config.bound.saturating_add(1))
    }

    /// Tries as many random schedules as are asked for, or up to the first finding.
    ///
    /// # Errors
    /// The session cannot be formed, saved or taken up.
    pub(super) fn sample(&mut self) -> Result<(), SearchError> {
        if self.config.samples == 0 {
            return Ok(());
        }
        let base_run = self.context.go(None, &[], Wanted { forks: true, known: None })?;
        for number in 0..self.config.samples {
            // Each has numbers of its own, so that more of them does not change those before.
            let mut random = Random::new(seed_for(self.config.seed, "schedule", &number.to_string()));
            let Some((from, deviations)) = self.drawn(&base_run, &mut random)? else { continue };
            self.found.sampled += 1;
            self.found.runs.spend();
            let path = self.context.go(Some(&from), &deviations, TO_THE_END)?;
            let Some(finding) = Finding::of(path, &deviations) else { continue };
            let finding = self.fewest(finding)?;
            let is_new = self.found.findings.iter().all(|known| known.deviations != finding.deviations);
            self.found.findings.extend(is_new.then_some(finding));
            if !self.config.all {
                return Ok(());
            }
        }
        Ok(())
    }

    /// A random schedule with more deviations than the bound; nothing if too little may happen later.
    fn drawn(&mut self, base_run: &Path, random: &mut Random) -> Result<Option<(Fork, Vec<Deviation>)>, SearchError> {
        let sizes = self.sizes();
        for _ in 0..DRAWS_MAX {
            let span = u64::from(sizes.end() - sizes.start()) + 1;
            let wanted = u64::from(*sizes.start()) + random.bits() % span;
            let mut deviations: Vec<Deviation> = Vec::new();
            let mut last: Option<Fork> = None;
            for left in (1..=wanted).rev() {
                let own = match &last {
                    None => None,
                    Some(fork) => {
                        self.found.runs.spend();
                        Some(self.context.go(Some(fork), &deviations, Wanted { forks: true, known: None })?)
                    }
                };
                let forks = &own.as_ref().unwrap_or(base_run).forks;
                let next: Vec<&Fork> = forks.iter().filter(|fork| is_next(fork, &deviations)).collect();
                if next.is_empty() {
                    break;
                }
                // The first of as many places as are still wanted, so that they lie all over the run.
                let place = (0..left).map(|_| random.bits() % next.len() as u64).min().unwrap_or(0);
                let Some(fork) = usize::try_from(place).ok().and_then(|place| next.get(place)) else { break };
                let step = self.context.scenario.plan().step();
                let late = place::sizes(&self.context.tolerances[fork.tolerance], step);
                let late_steps = late.start() + random.bits() % (late.end() - late.start() + 1);
                let what = (fork.tolerance, fork.what.clone());
                let Some(deviation) = Deviation::new(what, fork.edge, late_steps, step) else { break };
                deviations.push(deviation);
                last = Some((*fork).clone());
            }
            if let Some(from) = last
                && deviations.len() as u64 >= u64::from(*sizes.start())
            {
                return Ok(Some((from, deviations)));
            }
        }
        Ok(None)
    }

    /// The same with as few deviations as still fail, and then each as little late as can be. Each is left out by itself.
    fn fewest(&mut self, mut finding: Finding) -> Result<Finding, SearchError> {
        let drawn = finding.deviations.len();
        let mut number = drawn;
        while number > 0 {
            number -= 1;
            let mut without = finding.deviations.clone();
            without.remove(number);
            if let Some(smaller) = self.fails(&without)? {
                finding = smaller;
                // What was needed with it may not be without it.
                number = finding.deviations.len();
            }
        }
        for number in 0..finding.deviations.len() {
            let tolerance = &self.context.tolerances[finding.deviations[number].tolerance];
            let sizes = place::sizes(tolerance, self.context.scenario.plan().step());
            let late = finding.deviations[number].late_steps;
            for late_steps in sizes.take_while(|steps| *steps < late) {
                let mut less = finding.deviations.clone();
                let Some(smaller) = less[number].with_steps(late_steps) else { continue };
                less[number] = smaller;
                if let Some(smaller) = self.fails(&less)? {
                    finding = smaller;
                    break;
                }
            }
        }
        Ok(Finding { drawn: Some(drawn), ..finding })
    }

    fn fails(&mut self, deviations: &[Deviation]) -> Result<Option<Finding>, SearchError> {
        self.found.runs.spend();
        Ok(Finding::of(self.context.go(None, deviations, TO_THE_END)?, deviations))
    }
}
