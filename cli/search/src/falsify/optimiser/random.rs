//! Each point by itself, evenly: what an optimiser has to be better than.

use onescan_server::random::Random;

use super::{Optimiser, anywhere};
use crate::falsify::space::Point;

/// So many points at a time, whatever the number of threads.
const BATCH: usize = 16;

/// Points of a stream of random numbers.
pub(super) struct Evenly {
    dimensions: usize,
    random: Random,
}

impl Evenly {
    pub(super) fn new(dimensions: usize, random: Random) -> Self {
        Self { dimensions, random }
    }
}

impl Optimiser for Evenly {
    fn ask(&mut self) -> Vec<Point> {
        (0..BATCH).map(|_| anywhere(self.dimensions, &mut self.random)).collect()
    }

    fn tell(&mut self, _: &[f64]) {}
}
