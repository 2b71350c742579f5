//! Simulated annealing: from the best of its opening on, wide jumps at first, shorter ones as it
//! cools, and hot again where nothing better comes for long.
//!
//! H. Szu and R. Hartley, "Fast simulated annealing", Physics Letters A 122 (1987): jumps are distributed after Cauchy, so
//! that some are wide at any temperature, and the temperature falls with the number of the point.

use std::f64::consts::PI;

use onescan_server::random::Random;

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
    moves: Random,
    acceptance: Random,
    /// Where it is, and what that is worth in units of the span.
    place: Point,
    worth: f64,
    /// The least worth so far, and how many points were no better since.
    least: f64,
    stalled: u64,
    /// By how much the points of the opening differ: the unit of the temperature.
    span: f64,
    /// Points since it was hot.
    cooled: u64,
    /// The point that was asked for last.
    asked: Point,
}

impl Annealing {
    pub(super) fn new(dimensions: usize, mut random: Random, opening: Opening) -> Self {
        Self {
            opening: Some(opening),
            moves: Random::new(random.bits()),
            acceptance: Random::new(random.bits()),
            place: vec![0.5; dimensions],
            worth: 0.0,
            least: 0.0,
            stalled: 0,
            span: 1.0,
            cooled: 0,
            asked: Vec::new(),
        }
    }

    fn temperature(&self) -> f64 {
        HOT / (self.cooled + 1) as f64
    }

    /// Goes to the point that was asked for, or stays where it is.
    fn judge(&mut self, worth: f64) {
        // Half of those that are worth as much are accepted, and fewer of those that are worse: the rule of Glauber.
        let share = 1.0 / (1.0 + libm::exp((worth - self.worth) / self.temperature()));
        // Drawn for better points, too, so that what comes next does not depend on them.
        let drawn = self.acceptance.uniform();
        self.stalled = if worth < self.least { 0 } else { self.stalled + 1 };
        self.least = self.least.min(worth);
        if worth < self.worth || drawn < share {
            self.place.clone_from(&self.asked);
            self.worth = worth;
        }
        if self.stalled >= PATIENCE {
            (self.stalled, self.cooled) = (0, 0);
        }
        self.cooled += 1;
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
                (self.place, self.worth) = (best.clone(), worth / self.span);
                self.least = self.worth;
            }
            self.opening = None;
        }
        let width = self.temperature() / 2.0;
        let mut jump = |x: &f64| mirrored(x + width * libm::tan(PI * (self.moves.uniform() - 0.5)));
        self.asked = self.place.iter().map(&mut jump).collect();
        vec![self.asked.clone()]
    }

    fn tell(&mut self, values: &[f64]) {
        match &mut self.opening {
            Some(opening) => opening.tell(values),
            None => values.iter().for_each(|value| self.judge(value / self.span)),
        }
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
