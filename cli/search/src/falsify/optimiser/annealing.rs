//! Simulated annealing, by the crate `argmin`: from the best of its opening on, wide jumps at first, shorter ones as it
//! cools, and hot again where nothing better comes for long.
//!
//! H. Szu and R. Hartley, "Fast simulated annealing", Physics Letters A 122 (1987): jumps are distributed after Cauchy, so
//! that some are wide at any temperature, and the temperature falls with the number of the point.

use std::cell::{Cell, RefCell};
use std::f64::consts::PI;

use argmin::core::{CostFunction, Error, Executor};
use argmin::solver::simulatedannealing::{Anneal, SATempFunc, SimulatedAnnealing};
use onescan_server::random::Random;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng;

use super::Optimiser;
use super::opening::Opening;
use crate::falsify::space::Point;

/// The temperature at the beginning: a point that is worse by all that the opening spans is then accepted about once in four
/// times, and jumps span the cube.
const HOT: f64 = 1.0;
/// Hot again after so many points without a better one.
const PATIENCE: u64 = 40;

/// One search, point by point.
pub(super) struct Annealing {
    /// Nothing once it is over.
    opening: Option<Opening>,
    start: Point,
    /// What the start is worth, in units of the span.
    start_worth: f64,
    /// By how much the points of the opening differ: the unit of the temperature.
    span: f64,
    moves: Random,
    acceptance: u64,
    /// What its points were worth, in the order in which it asks for them.
    known: Vec<f64>,
}

impl Annealing {
    pub(super) fn new(dimensions: usize, mut random: Random, opening: Opening) -> Self {
        let (moves, acceptance) = (Random::new(random.bits()), random.bits());
        let start = vec![0.5; dimensions];
        Self { opening: Some(opening), start, start_worth: 0.0, span: 1.0, moves, acceptance, known: Vec::new() }
    }

    /// The next point of the search.
    fn next(&self) -> Option<Point> {
        let course = Course {
            known: &self.known,
            used: Cell::new(0),
            moves: RefCell::new(self.moves),
            asked: RefCell::new(None),
        };
        let generator = Xoshiro256PlusPlus::seed_from_u64(self.acceptance);
        // It refuses no temperature above 0.
        let annealing = SimulatedAnnealing::new_with_rng(HOT, generator).ok()?;
        let annealing = annealing.with_temp_func(SATempFunc::TemperatureFast).with_reannealing_best(PATIENCE);
        let search = Executor::new(&course, annealing).timer(false);
        let begun = search.configure(|state| state.param(self.start.clone()).cost(self.start_worth));
        // It ends with the first point that it does not know, which is what is asked for.
        begun.run().err()?;
        course.asked.into_inner()
    }
}

impl Optimiser for Annealing {
    fn ask(&mut self) -> Vec<Point> {
        if let Some(opening) = &mut self.opening {
            if let Some(points) = opening.ask() {
                return points;
            }
            self.span = opening.span();
            if let Some((best, worth)) = opening.best() {
                (self.start, self.start_worth) = (best.clone(), worth / self.span);
            }
            self.opening = None;
        }
        vec![self.next().unwrap_or_else(|| self.start.clone())]
    }

    fn tell(&mut self, values: &[f64]) {
        match &mut self.opening {
            Some(opening) => opening.tell(values),
            None => self.known.extend(values.iter().map(|value| value / self.span)),
        }
    }
}

/// The search anew, up to the point that is not known yet.
struct Course<'a> {
    known: &'a [f64],
    used: Cell<usize>,
    moves: RefCell<Random>,
    asked: RefCell<Option<Point>>,
}

impl CostFunction for &Course<'_> {
    type Param = Point;
    type Output = f64;

    fn cost(&self, point: &Point) -> Result<f64, Error> {
        let Some(value) = self.known.get(self.used.get()) else {
            self.asked.replace(Some(point.clone()));
            return Err(Error::msg("what comes next is not known yet"));
        };
        self.used.set(self.used.get() + 1);
        Ok(*value)
    }
}

impl Anneal for &Course<'_> {
    type Param = Point;
    type Output = Point;
    type Float = f64;

    fn anneal(&self, point: &Point, temperature: f64) -> Result<Point, Error> {
        let mut moves = self.moves.borrow_mut();
        let jump = |x: &f64| mirrored(x + temperature / 2.0 * libm::tan(PI * (moves.uniform() - 0.5)));
        Ok(point.iter().map(jump).collect())
    }
}

/// Into the cube, as if its sides were mirrors.
fn mirrored(x: f64) -> f64 {
    let folded = x.rem_euclid(2.0);
    if folded > 1.0 { 2.0 - folded } else { folded }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_leaves_the_cube_comes_back_from_its_side() {
        for (x, inside) in [(0.25, 0.25), (1.25, 0.75), (-0.25, 0.25), (2.25, 0.25), (-1.5, 0.5), (1.0, 1.0)] {
            assert_eq!(mirrored(x), inside, "{x}");
        }
    }
}
