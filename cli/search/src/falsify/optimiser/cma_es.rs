//! CMA-ES: from the best of its opening on, and again from anywhere when it has converged.

use onescan_server::random::Random;

use super::distribution::Distribution;
use super::opening::Opening;
use super::{Optimiser, anywhere};
use crate::falsify::space::Point;

/// Standard deviation in each direction at the beginning, of a cube whose sides are 1.
const STEP_SIZE: f64 = 0.3;
/// What a point outside of the cube is worth less than the one at its border, by the square of its distance: enough to lead
/// back, too little to matter else.
const OUTSIDE: f64 = 1e-3;

/// A search that begins again when it ends.
pub(super) struct CmaEs {
    random: Random,
    /// Nothing once it is over.
    opening: Option<Opening>,
    search: Distribution,
    /// The points that were asked for last, as the search has them: some lie outside of the cube.
    asked: Vec<Point>,
}

impl CmaEs {
    pub(super) fn new(dimensions: usize, mut random: Random, opening: Opening) -> Self {
        let search = Distribution::new(vec![0.5; dimensions], STEP_SIZE, Random::new(random.bits()));
        Self { random, opening: Some(opening), search, asked: Vec::new() }
    }
}

impl Optimiser for CmaEs {
    fn ask(&mut self) -> Vec<Point> {
        if let Some(opening) = &mut self.opening {
            if let Some(points) = opening.ask() {
                return points;
            }
            if let Some((best, _)) = opening.best() {
                self.search.mean.clone_from(best);
            }
            self.opening = None;
        }
        if self.search.is_over {
            let start = anywhere(self.search.mean.len(), &mut self.random);
            self.search = Distribution::new(start, STEP_SIZE, Random::new(self.random.bits()));
        }
        self.asked = self.search.generation();
        self.asked.iter().map(|point| point.iter().map(|x| x.clamp(0.0, 1.0)).collect()).collect()
    }

    fn tell(&mut self, values: &[f64]) {
        if let Some(opening) = &mut self.opening {
            opening.tell(values);
            return;
        }
        let worth = |(point, value): (Point, &f64)| {
            let outside: f64 = point.iter().map(|x| x - x.clamp(0.0, 1.0)).map(|far| far * far).sum();
            value + OUTSIDE * value.abs().max(1.0) * outside
        };
        let worths: Vec<f64> = self.asked.drain(..).zip(values).map(worth).collect();
        self.search.learn(&worths);
    }
}
