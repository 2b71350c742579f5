//! CMA-ES, by the crate `cmaes`: from the best of its opening on, and again from anywhere when it has converged.

use std::cell::{Cell, RefCell};

use cmaes::{CMAESOptions, DVector};
use onescan_server::random::Random;

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
    dimensions: usize,
    random: Random,
    /// Nothing once it is over.
    opening: Option<Opening>,
    /// Where this search begins.
    start: Point,
    seed: u64,
    /// What its points were worth, in the order in which it asks for them.
    known: Vec<f64>,
    /// The points that were asked for last, as the search has them: some lie outside of the cube.
    asked: Vec<Point>,
}

impl CmaEs {
    pub(super) fn new(dimensions: usize, mut random: Random, opening: Opening) -> Self {
        let seed = random.bits();
        let start = vec![0.5; dimensions];
        Self { dimensions, random, opening: Some(opening), start, seed, known: Vec::new(), asked: Vec::new() }
    }

    /// The next generation of this search; nothing if it has ended.
    fn generation(&self) -> Option<Vec<Point>> {
        let (used, fresh) = (Cell::new(0), RefCell::new(Vec::new()));
        let worth = |point: &DVector<f64>| {
            if let Some(value) = self.known.get(used.get()) {
                used.set(used.get() + 1);
                return *value;
            }
            fresh.borrow_mut().push(point.iter().copied().collect::<Point>());
            // What comes of it is not looked at: the search is thrown away.
            0.0
        };
        let options = CMAESOptions::new(self.start.clone(), STEP_SIZE).seed(self.seed);
        // It refuses no dimension, no population and no step: there are some of each.
        let mut search = options.build(worth).ok()?;
        loop {
            let has_ended = search.next().is_some();
            if !fresh.borrow().is_empty() {
                break;
            }
            if has_ended {
                return None;
            }
        }
        drop(search);
        Some(fresh.into_inner())
    }
}

impl Optimiser for CmaEs {
    fn ask(&mut self) -> Vec<Point> {
        if let Some(opening) = &mut self.opening {
            if let Some(points) = opening.ask() {
                return points;
            }
            if let Some((best, _)) = opening.best() {
                self.start.clone_from(best);
            }
            self.opening = None;
        }
        self.asked = self.generation().unwrap_or_else(|| {
            self.known.clear();
            self.start = anywhere(self.dimensions, &mut self.random);
            self.seed = self.random.bits();
            self.generation().unwrap_or_else(|| vec![self.start.clone()])
        });
        self.asked.iter().map(|point| point.iter().map(|x| x.clamp(0.0, 1.0)).collect()).collect()
    }

    fn tell(&mut self, values: &[f64]) {
        if let Some(opening) = &mut self.opening {
            opening.tell(values);
            return;
        }
        for (point, value) in self.asked.drain(..).zip(values) {
            let outside: f64 = point.iter().map(|x| x - x.clamp(0.0, 1.0)).map(|far| far * far).sum();
            self.known.push(value + OUTSIDE * value.abs().max(1.0) * outside);
        }
    }
}
