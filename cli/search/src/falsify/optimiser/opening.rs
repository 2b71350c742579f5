//! What is looked at first, before a search that is led by margins: some points by chance, then corners.
//!
//! Where several points are worth the same and none less, nothing leads anywhere, as where gears alone decide. Then chance
//! finds what there is: points are drawn, corners once among them, until one is worth less than all others.

use std::cmp::Ordering;
use std::f64::consts::FRAC_PI_2;

use onescan_server::random::Random;

use super::anywhere;
use crate::falsify::space::Point;

/// So many points are drawn first: enough to see whether their margins differ.
const FIRST: usize = 3;
/// So many are drawn at a time where they do not.
const MORE: usize = 8;
/// So often, before corners come where nothing leads to them.
const BEFORE_CORNERS: usize = 6;

/// The points before a search.
pub(super) struct Opening {
    dimensions: usize,
    random: Random,
    corners: Vec<Point>,
    /// The points that were asked for last.
    asked: Vec<Point>,
    /// What was worth least so far, what that is, and how many points were worth as little.
    least: Option<(Point, f64, usize)>,
    /// How often more points were drawn because nothing led anywhere.
    drifts: usize,
    /// The greatest worth that is none of an infinite margin.
    greatest: Option<f64>,
}

impl Opening {
    pub(super) fn new(dimensions: usize, random: Random, corners: Vec<Point>) -> Self {
        Self { dimensions, random, corners, asked: Vec::new(), least: None, drifts: 0, greatest: None }
    }

    /// The points that are to be simulated next; nothing once a search can be led.
    pub(super) fn ask(&mut self) -> Option<Vec<Point>> {
        let is_flat = self.least.as_ref().is_none_or(|(_, _, count)| *count > 1);
        self.asked = if self.least.is_none() {
            self.near_ends(FIRST)
        } else if !self.corners.is_empty() && (!is_flat || self.drifts == BEFORE_CORNERS) {
            std::mem::take(&mut self.corners)
        } else if is_flat {
            self.drifts += 1;
            if self.drifts == 1 {
                let (ends, evenly) = (self.near_ends(MORE / 2), self.evenly(MORE / 2));
                ends.into_iter().zip(evenly).flat_map(|(one, other)| [one, other]).collect()
            } else {
                self.evenly(MORE)
            }
        } else {
            return None;
        };
        Some(self.asked.clone())
    }

    /// Takes what the points are worth that were asked for last.
    pub(super) fn tell(&mut self, values: &[f64]) {
        for (point, value) in self.asked.drain(..).zip(values) {
            if value.abs() < super::FAR {
                self.greatest = Some(self.greatest.map_or(*value, |greatest| greatest.max(*value)));
            }
            match &mut self.least {
                Some((_, least, count)) => match value.total_cmp(least) {
                    Ordering::Less => self.least = Some((point, *value, 1)),
                    Ordering::Equal => *count += 1,
                    Ordering::Greater => {}
                },
                None => self.least = Some((point, *value, 1)),
            }
        }
    }

    /// The point that is worth least, and what that is.
    pub(super) fn best(&self) -> Option<(&Point, f64)> {
        self.least.as_ref().map(|(point, least, _)| (point, *least))
    }

    /// How far apart the points are in what they are worth; 1 where that is nothing.
    pub(super) fn span(&self) -> f64 {
        let least = self.least.as_ref().map(|(_, least, _)| *least);
        let span = self.greatest.zip(least).map(|(greatest, least)| greatest - least);
        span.filter(|span| span.is_finite() && *span > 0.0).unwrap_or(1.0)
    }

    /// Points by chance, evenly.
    fn evenly(&mut self, count: usize) -> Vec<Point> {
        (0..count).map(|_| anywhere(self.dimensions, &mut self.random)).collect()
    }

    /// Points by chance. Numbers near their ends come more often than those between, by the distribution of the arcsine:
    /// what holds between often breaks where an input jumps from end to end.
    fn near_ends(&mut self, count: usize) -> Vec<Point> {
        let (dimensions, random) = (self.dimensions, &mut self.random);
        let mut number = || {
            let sine = libm::sin(FRAC_PI_2 * random.uniform());
            sine * sine
        };
        (0..count).map(|_| (0..dimensions).map(|_| number()).collect()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sizes of the batches until a search can be led, and the best point.
    fn opened(worth: impl Fn(usize, &Point) -> f64) -> (Vec<usize>, Point) {
        let mut opening = Opening::new(3, Random::new(1), vec![vec![0.0; 3], vec![1.0; 3]]);
        let (mut sizes, mut asked) = (Vec::new(), 0);
        while let Some(points) = opening.ask() {
            let values: Vec<f64> =
                points.iter().enumerate().map(|(index, point)| worth(asked + index, point)).collect();
            asked += points.len();
            sizes.push(points.len());
            opening.tell(&values);
            assert!(sizes.len() < 20, "it goes on for ever");
        }
        (sizes, opening.best().expect("a point").0.clone())
    }

    #[test]
    fn corners_come_once_margins_differ() {
        let (sizes, best) = opened(|_, point| point.iter().sum());
        assert_eq!((sizes, best), (vec![3, 2], vec![0.0; 3]));
    }

    #[test]
    fn where_nothing_leads_points_are_drawn_until_something_does() {
        let (sizes, _) = opened(|number, _| if number < 30 { 0.5 } else { 0.4 - number as f64 / 1e3 });
        assert_eq!(sizes, [3, 8, 8, 8, 8, 2]);
        let (sizes, best) = opened(|_, point| if *point == vec![1.0; 3] { 0.0 } else { 0.5 });
        assert_eq!((sizes, best), (vec![3, 8, 8, 8, 8, 8, 8, 2], vec![1.0; 3]), "corners are tried, too");
    }
}
