//! What couples the coordinate of a joint to those of others, as data of a checked scene with the
//! coordinates counted from the scene's pose.

use super::model;
use super::model::Mechanics;

/// A joint that others lead.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Coupled {
    /// Index of the joint in the scene.
    pub(crate) joint: usize,
    /// The joints that lead it, two at most.
    pub(crate) of: Vec<Of>,
    /// Play between the flanks, m or rad of the joint.
    pub(crate) backlash: f64,
    /// The greatest force on the joint, N or N·m, beyond which it slips.
    pub(crate) slip: Option<f64>,
}

/// A joint that leads, and what it asks for.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Of {
    pub(crate) joint: usize,
    law: Law,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Law {
    Ratio(f64),
    /// Counted from the scene's pose.
    Cam(Cam),
}

/// A curve through points without corners, which may repeat.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Cam {
    knots: Vec<Knot>,
    /// From its first point to its last, where it begins again.
    turn: Option<[f64; 2]>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Knot {
    x: f64,
    y: f64,
    slope: f64,
}

impl Coupled {
    /// The couplings of a scene; behind them those of joints that follow others, which stand where these
    /// take them.
    pub(crate) fn all(scene: &Mechanics) -> Vec<Self> {
        let written = scene.couplings.iter().map(|coupling| Self::new(coupling, scene));
        let moved = scene.joints.iter().enumerate().filter(|(_, joint)| !joint.guided);
        let follows = moved.filter_map(|(joint, described)| {
            let follows = described.follows?;
            let of = vec![Of { joint: follows.joint, law: Law::Ratio(follows.factor) }];
            Some(Self { joint, of, backlash: 0.0, slip: None })
        });
        written.chain(follows).collect()
    }

    /// Whether it is about this joint.
    pub(crate) fn joins(&self, joint: usize) -> bool {
        self.joint == joint || self.of.iter().any(|of| of.joint == joint)
    }

    fn new(coupling: &model::Coupling, scene: &Mechanics) -> Self {
        let initial = |joint: usize| scene.joints[joint].initial;
        let of = coupling.of.iter().map(|share| {
            let from = [initial(share.joint), initial(coupling.joint)];
            Of { joint: share.joint, law: Law::of(&share.law, from) }
        });
        Self { joint: coupling.joint, of: of.collect(), backlash: coupling.backlash, slip: coupling.slip }
    }
}

impl Law {
    /// The law of a scene, its coordinates counted from here.
    pub(crate) fn of(law: &model::CouplingLaw, [x, y]: [f64; 2]) -> Self {
        let (points, repeats) = match law {
            model::CouplingLaw::Ratio(ratio) => return Self::Ratio(*ratio),
            model::CouplingLaw::Cam(points) => (points, false),
            model::CouplingLaw::RepeatingCam(points) => (points, true),
        };
        let points: Vec<_> = points.iter().map(|point| [point[0] - x, point[1] - y]).collect();
        Self::Cam(Cam::through(&points, repeats))
    }

    /// Where it has the joint that is led, and the slope there.
    pub(crate) fn at(&self, x: f64) -> (f64, f64) {
        match self {
            Self::Ratio(ratio) => (ratio * x, *ratio),
            Self::Cam(cam) => cam.at(x),
        }
    }
}

impl Cam {
    /// The slopes at its points are those of the parabola through three of them, so that it has no corners; at its
    /// ends it goes on straight, or as on its other end.
    fn through(points: &[[f64; 2]], repeats: bool) -> Self {
        let secant = |k: usize| (points[k + 1][1] - points[k][1]) / (points[k + 1][0] - points[k][0]);
        let wide = |k: usize| points[k + 1][0] - points[k][0];
        let between = |k: usize, next: usize| {
            let [before, after] = [wide(k), wide(next)];
            (secant(k) * after + secant(next) * before) / (before + after)
        };
        let last = points.len() - 1;
        let slope = |k: usize| match k {
            0 if !repeats => secant(0),
            k if k == last && !repeats => secant(k - 1),
            k if k == 0 || k == last => between(last - 1, 0),
            k => between(k - 1, k),
        };
        let turn = repeats.then(|| [points[last][0] - points[0][0], points[last][1] - points[0][1]]);
        let knots = points.iter().enumerate().map(|(k, [x, y])| Knot { x: *x, y: *y, slope: slope(k) }).collect();
        Self { knots, turn }
    }

    fn at(&self, x: f64) -> (f64, f64) {
        let (Some([wide, high]), Some(first)) = (self.turn, self.knots.first()) else { return on(&self.knots, x) };
        let turns = ((x - first.x) / wide).floor();
        let (value, slope) = on(&self.knots, x - turns * wide);
        (value + turns * high, slope)
    }
}

impl Of {
    /// What it asks for at a coordinate, and the slope there.
    pub(crate) fn at(&self, x: f64) -> (f64, f64) {
        self.law.at(x)
    }
}

fn on(knots: &[Knot], x: f64) -> (f64, f64) {
    let after = knots.partition_point(|knot| knot.x <= x);
    let straight = |knot: &Knot| (knot.y + knot.slope * (x - knot.x), knot.slope);
    let (Some(one), Some(other)) = (after.checked_sub(1).and_then(|k| knots.get(k)), knots.get(after)) else {
        // a checked cam has two points at least
        return knots.get(after.saturating_sub(1)).map_or((0.0, 0.0), straight);
    };
    let (wide, t) = (other.x - one.x, (x - one.x) / (other.x - one.x));
    let rest = 1.0 - t;
    let value = rest * rest * ((1.0 + 2.0 * t) * one.y + t * wide * one.slope)
        + t * t * ((3.0 - 2.0 * t) * other.y - rest * wide * other.slope);
    let slope = 6.0 * t * rest * (other.y - one.y) / wide
        + rest * (1.0 - 3.0 * t) * one.slope
        + t * (3.0 * t - 2.0) * other.slope;
    (value, slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cam_goes_through_its_points_without_corners() {
        let points = [[0.0, 0.0], [1.0, 0.5], [2.0, 2.0], [4.0, 2.0]];
        let cam = Cam::through(&points, false);
        for [x, y] in points {
            assert!((cam.at(x).0 - y).abs() < 1e-15);
        }
        smooth(&cam);
    }

    fn smooth(cam: &Cam) {
        for k in -10..60 {
            let x = 0.1 * f64::from(k) + 0.013;
            let (step, (before, _), (after, _)) = (1e-6, cam.at(x - 1e-6), cam.at(x + 1e-6));
            // central differences: third derivatives times 1e-12, roundings of 1e-16/1e-6
            assert!(((after - before) / (2.0 * step) - cam.at(x).1).abs() < 1e-8, "{x}");
        }
    }

    #[test]
    fn a_cam_of_a_parabola_is_that_parabola_inside() {
        let points: Vec<_> = (0..6).map(|k| [f64::from(k), f64::from(k * k)]).collect();
        let (value, slope) = Cam::through(&points, false).at(2.5);
        assert!((value - 6.25).abs() < 1e-14 && (slope - 5.0).abs() < 1e-14);
    }

    #[test]
    fn a_cam_that_repeats_goes_on_as_it_began() {
        // as an indexer: it dwells, then goes on by 0.5, each turn of 4
        let points = [[0.0, 0.0], [1.0, 0.0], [3.0, 0.5], [4.0, 0.5]];
        let cam = Cam::through(&points, true);
        for turns in [-3.0, -1.0, 0.0, 1.0, 7.0] {
            for [x, y] in points {
                assert!((cam.at(x + 4.0 * turns).0 - (y + 0.5 * turns)).abs() < 1e-12, "{x} {turns}");
            }
        }
        smooth(&cam);
    }
}
