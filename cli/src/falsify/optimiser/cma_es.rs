//! CMA-ES, by the crate `cmaes`: from the best of its opening on, and again from anywhere when it has converged.
//!
//! Where several points are worth the same, and none less, nothing leads anywhere: then points are drawn evenly until one
//! is worth less than all others, as chance is all that finds what there is.

use std::cell::{Cell, RefCell};
use std::cmp::Ordering;

use cmaes::{CMAESOptions, DVector};
use onescan_server::random::Random;

use super::{Optimiser, anywhere, best_of};
use crate::falsify::space::Point;

/// Standard deviation in each direction at the beginning, of a cube whose sides are 1.
const STEP_SIZE: f64 = 0.3;
/// What a point outside of the cube is worth less than the one at its border, by the square of its distance: enough to lead
/// back, too little to matter else.
const OUTSIDE: f64 = 1e-3;

/// So many points are drawn at a time where nothing leads anywhere.
const DRAWN: usize = 8;

/// A search that begins again when it ends.
pub(super) struct CmaEs {
    dimensions: usize,
    random: Random,
    opening: Vec<Point>,
    /// Where this search begins.
    start: Point,
    seed: u64,
    /// What its points were worth, in the order in which it asks for them.
    known: Vec<f64>,
    /// The points that were asked for last, as the search has them: some lie outside of the cube.
    asked: Vec<Point>,
    /// What of the points before the search was worth least, and how many were worth that; nothing once the search is led.
    least: Option<(f64, usize)>,
}

impl CmaEs {
    pub(super) fn new(dimensions: usize, mut random: Random, opening: Vec<Point>) -> Self {
        let seed = random.bits();
        let start = vec![0.5; dimensions];
        let least = Some((f64::INFINITY, 0));
        Self { dimensions, random, opening, start, seed, known: Vec::new(), asked: Vec::new(), least }
    }

    /// Takes what points before the search are worth: it begins at the one that is worth less than all others, if one is.
    fn look(&mut self, points: Vec<Point>, values: &[f64]) {
        let Some((mut least, mut count)) = self.least else { return };
        for value in values {
            match value.total_cmp(&least) {
                Ordering::Less => (least, count) = (*value, 1),
                Ordering::Equal => count += 1,
                Ordering::Greater => {}
            }
        }
        if let Some((point, value)) = best_of(points, values)
            && value <= least
        {
            self.start = point;
        }
        self.least = (count > 1).then_some((least, count));
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
        if !self.opening.is_empty() {
            return self.opening.clone();
        }
        if self.least.is_some() {
            self.asked = (0..DRAWN).map(|_| anywhere(self.dimensions, &mut self.random)).collect();
            return self.asked.clone();
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
        if self.least.is_some() {
            let opening = std::mem::take(&mut self.opening);
            let points = if opening.is_empty() { std::mem::take(&mut self.asked) } else { opening };
            self.look(points, values);
            return;
        }
        for (point, value) in self.asked.drain(..).zip(values) {
            let outside: f64 = point.iter().map(|x| x - x.clamp(0.0, 1.0)).map(|far| far * far).sum();
            self.known.push(value + OUTSIDE * value.abs().max(1.0) * outside);
        }
    }
}
