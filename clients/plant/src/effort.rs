//! What a drive does to its joint, and what the joint reports to the drive: the one way between the equations
//! of a component and those of the mechanism that it moves.

use serde::{Deserialize, Serialize};

use super::setpoint::Setpoint;

/// What a joint reports to its drive as a sub-step begins.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Motion {
    pub(crate) position: f64,
    pub(crate) velocity: f64,
    /// What it would take to accelerate the joint, kg or kg·m²: of all that moves with it.
    pub(crate) mass: f64,
    /// What the drive exerted in the last sub-step, N or N·m.
    pub(crate) exerted: f64,
}

/// What a drive does to its joint in a sub-step. Forces are in N or N·m, along the coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Effort {
    /// Its force at the velocity that it received.
    pub(crate) force: f64,
    /// By how much the force falls as the velocity grows, not below 0.
    pub(crate) slope: f64,
    /// A velocity that it seeks with all of its force, in place of `force` and `slope`.
    pub(crate) sought: Option<f64>,
    /// The greatest force, either way.
    pub(crate) most: f64,
    /// Dry friction; without bound for what is blocked.
    pub(crate) dry: f64,
    /// Viscous friction, N·s/m or N·m·s.
    pub(crate) viscous: f64,
}

impl Effort {
    /// A force and nothing else.
    pub(crate) const fn of(force: f64) -> Self {
        Self { force, slope: 0.0, sought: None, most: f64::INFINITY, dry: 0.0, viscous: 0.0 }
    }

    /// A joint that is blocked.
    pub(crate) const BLOCKED: Self = Self { dry: f64::INFINITY, ..Self::of(0.0) };
}

/// The drives of a plant, by their number.
pub(crate) trait Drives {
    /// The longest sub-step of a drive's own equations, s.
    fn longest_s(&self, drive: usize) -> f64;
    /// Moves a drive's own state by a sub-step of `dt_s`, in which its joint moves so.
    fn advance(&mut self, drive: usize, motion: Motion, dt_s: f64) -> Effort;
    /// What a drive would do at the end of a step in which its joint moves so; its state stays.
    fn foresee(&self, drive: usize, motion: Motion, dt_s: f64) -> Effort;
}

/// A plant without drives, for tests of what moves by itself.
#[cfg(test)]
pub(crate) struct Nobody;

#[cfg(test)]
impl Drives for Nobody {
    fn longest_s(&self, _: usize) -> f64 {
        f64::INFINITY
    }

    fn advance(&mut self, _: usize, _: Motion, _: f64) -> Effort {
        Effort::of(0.0)
    }

    fn foresee(&self, _: usize, _: Motion, _: f64) -> Effort {
        Effort::of(0.0)
    }
}

/// Where a joint was measured, and how fast.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Mark {
    pub(crate) position: f64,
    pub(crate) velocity: f64,
}

/// The way that a joint is to follow in a turn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Path {
    pub(crate) from: Setpoint,
    pub(crate) to: Setpoint,
    /// Length of the turn.
    pub(crate) turn_s: f64,
}

impl Path {
    /// A path that stays where it is.
    pub(crate) fn at_rest(position: f64) -> Self {
        let rest = Setpoint { position, velocity: 0.0 };
        Self { from: rest, to: rest, turn_s: 1.0 }
    }

    /// Where the path is, `part` of the turn after its start: the cubic with the velocities of both ends.
    pub(crate) fn at(&self, part: f64) -> f64 {
        let Self { from, to, turn_s } = *self;
        let rest = 1.0 - part;
        let ends = rest * rest * (1.0 + 2.0 * part) * from.position + part * part * (3.0 - 2.0 * part) * to.position;
        ends + part * rest * turn_s * (rest * from.velocity - part * to.velocity)
    }

    /// How fast it goes there, m/s or rad/s.
    pub(crate) fn velocity(&self, part: f64) -> f64 {
        let Self { from, to, turn_s } = *self;
        let rest = 1.0 - part;
        let way = 6.0 * part * rest * (to.position - from.position) / turn_s;
        way + rest * (1.0 - 3.0 * part) * from.velocity + part * (3.0 * part - 2.0) * to.velocity
    }
}

/// How many equal sub-steps of at most `longest_s` make `dt_s`, and how long each is.
pub(crate) fn substeps(dt_s: f64, longest_s: f64) -> (u32, f64) {
    // a whole number of sub-steps is not one more for a rounding
    let count = (dt_s / longest_s - 1e-9).ceil().clamp(1.0, 1e6);
    (count as u32, dt_s / count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_a_parabola_where_its_ends_are() {
        // 3 m/s², from 1 m/s
        let at = |t: f64| 1.0 * t + 1.5 * t * t;
        let path = Path {
            from: Setpoint { position: 0.0, velocity: 1.0 },
            to: Setpoint { position: at(0.2), velocity: 1.6 },
            turn_s: 0.2,
        };
        for part in [0.0, 0.3, 0.5, 1.0] {
            assert!((path.at(part) - at(0.2 * part)).abs() < 1e-16, "{part}");
            assert!((path.velocity(part) - (1.0 + 3.0 * 0.2 * part)).abs() < 1e-14, "{part}");
        }
    }
}
