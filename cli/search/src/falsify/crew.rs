//! Several benches at work at a time. What comes of it does not depend on how many there are.

use std::num::NonZeroUsize;

use super::space::Point;
use super::trial::{Bench, Sample};
use onescan_runner::run::SearchError;

/// Benches, one a thread.
pub(super) struct Crew<'a> {
    benches: Vec<Bench<'a>>,
}

impl<'a> Crew<'a> {
    pub(super) fn new(jobs: NonZeroUsize, bench: impl Fn() -> Bench<'a>) -> Self {
        Self { benches: (0..jobs.get()).map(|_| bench()).collect() }
    }

    /// Simulates points in their order up to the first that is a finding.
    ///
    /// # Errors
    /// A session cannot be formed or go on.
    pub(super) fn simulate(&mut self, points: &[Point]) -> Result<Vec<Sample>, SearchError> {
        let mut samples = Vec::new();
        for some in points.chunks(self.benches.len()) {
            for sample in self.at_once(some) {
                let sample = sample?;
                let is_finding = sample.is_finding();
                samples.push(sample);
                // What was simulated beyond it counts for nothing: with one bench it would not have been.
                if is_finding {
                    return Ok(samples);
                }
            }
        }
        Ok(samples)
    }

    fn at_once(&mut self, points: &[Point]) -> Vec<Result<Sample, SearchError>> {
        if let ([point], [bench, ..]) = (points, &mut self.benches[..]) {
            return vec![bench.simulate(point)];
        }
        std::thread::scope(|scope| {
            let work = self.benches.iter_mut().zip(points);
            let threads: Vec<_> = work.map(|(bench, point)| scope.spawn(move || bench.simulate(point))).collect();
            let ended = threads.into_iter().map(std::thread::ScopedJoinHandle::join);
            ended.map(|ended| ended.unwrap_or_else(|panic| std::panic::resume_unwind(panic))).collect()
        })
    }
}
