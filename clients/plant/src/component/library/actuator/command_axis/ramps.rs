//! A move to a position in closed form, from any speed: stretches of constant acceleration, each with the speeds at
//! its ends, so that a plateau is the target speed to the bit.

use serde::{Deserialize, Serialize};

use crate::setpoint::Setpoint;

/// What a move may do, in units of the axis per second; all above 0.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Limits {
    pub(super) speed: f64,
    pub(super) acceleration: f64,
    pub(super) deceleration: f64,
}

/// A stretch of constant acceleration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Stretch {
    duration_s: f64,
    from: f64,
    to: f64,
}

impl Stretch {
    fn way(self) -> f64 {
        0.5 * (self.from + self.to) * self.duration_s
    }
}

/// A move that has been planned.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Ramps {
    start: f64,
    target: f64,
    /// Braking first where the axis is too fast or runs the wrong way, then up, along and down.
    stretches: [Stretch; 4],
}

impl Ramps {
    /// The quickest move from `now` to a rest at `target`.
    pub(super) fn plan(now: Setpoint, target: f64, limits: Limits) -> Self {
        let Limits { speed, acceleration, deceleration } = limits;
        let way = target - now.position;
        let stop = now.velocity * now.velocity.abs() / (2.0 * deceleration);
        // what is left once the axis has stopped decides the direction, unless it can stop on the way
        let sign = if (way - stop) * way < 0.0 || way == 0.0 { (way - stop).signum() } else { way.signum() };
        let first = now.velocity * sign;
        let brake = |from: f64, to: f64| Stretch {
            duration_s: (from - to).abs() / deceleration,
            from: sign * from,
            to: sign * to,
        };
        let braked = if first < 0.0 {
            brake(first, 0.0)
        } else if first > speed {
            brake(first, speed)
        } else {
            Stretch { duration_s: 0.0, from: now.velocity, to: now.velocity }
        };
        let begun = braked.to * sign;
        let left = ((way - braked.way()) * sign).max(0.0);
        let both = acceleration + deceleration;
        let highest =
            ((2.0 * acceleration * deceleration * left + deceleration * begun * begun) / both).max(0.0).sqrt();
        let peak = highest.min(speed).max(begun);
        let up = Stretch { duration_s: (peak - begun) / acceleration, from: sign * begun, to: sign * peak };
        let down = Stretch { duration_s: peak / deceleration, from: sign * peak, to: 0.0 };
        let along = left - up.way() * sign - down.way() * sign;
        let duration_s = if peak > 0.0 { (along / peak).max(0.0) } else { 0.0 };
        let cruise = Stretch { duration_s, from: sign * peak, to: sign * peak };
        Self { start: now.position, target, stretches: [braked, up, cruise, down] }
    }

    /// How long the move takes, s.
    pub(super) fn duration_s(&self) -> f64 {
        self.stretches.iter().map(|stretch| stretch.duration_s).sum()
    }

    /// Where the axis is so long after the start.
    pub(super) fn at(&self, since_s: f64) -> Setpoint {
        let (mut position, mut left_s) = (self.start, since_s);
        for stretch in &self.stretches {
            if left_s < stretch.duration_s {
                let slope = (stretch.to - stretch.from) / stretch.duration_s;
                let velocity = if stretch.to == stretch.from { stretch.to } else { stretch.from + slope * left_s };
                return Setpoint { position: position + 0.5 * (stretch.from + velocity) * left_s, velocity };
            }
            position += stretch.way();
            left_s -= stretch.duration_s;
        }
        Setpoint { position: self.target, velocity: 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The linear feeder's command in `[Nyyssönen]` Fig. 22.
    const FEEDER: Limits = Limits { speed: 8000.0, acceleration: 15_000.0, deceleration: 15_000.0 };

    fn from_rest(target: f64) -> Ramps {
        Ramps::plan(Setpoint::default(), target, FEEDER)
    }

    #[test]
    fn the_feeder_moves_as_in_the_figure() {
        // speeding up 8/15 s, along 6300/8000 - 8/15 s
        assert!((from_rest(6300.0).duration_s() - 1.320_833_333_333).abs() < 1e-9);
        assert!((from_rest(13_950.0).duration_s() - 2.277_083_333_333).abs() < 1e-9);
        assert_eq!(from_rest(6300.0).at(0.6), Setpoint { velocity: 8000.0, ..from_rest(6300.0).at(0.6) });
        assert_eq!(from_rest(6300.0).at(1.33), Setpoint { position: 6300.0, velocity: 0.0 });
        // below 4266.67 units a triangle
        let short = from_rest(2000.0);
        assert!((short.duration_s() - 0.730_296_743).abs() < 1e-9);
        assert!((short.at(0.5 * short.duration_s()).velocity - 5_477.225_575).abs() < 1e-6);
    }

    proptest! {
        /// From any speed a move ends where it should, is never faster than it may unless it began so, and its
        /// position is the integral of its velocity.
        #[test]
        fn a_move_is_its_own_integral(
            velocity in -9000.0..9000.0_f64,
            target in -20_000.0..20_000.0_f64,
            speed in 100.0..9000.0_f64,
            acceleration in 1000.0..40_000.0_f64,
            deceleration in 1000.0..40_000.0_f64,
        ) {
            let now = Setpoint { position: 0.0, velocity };
            let limits = Limits { speed, acceleration, deceleration };
            let ramps = Ramps::plan(now, target, limits);
            let end_s = ramps.duration_s();
            let last: f64 = ramps.stretches.iter().map(|stretch| stretch.way()).sum();
            prop_assert!((last - target).abs() < 1e-6 * (1.0 + target.abs()), "{last} {ramps:?}");
            let (mut integral, mut before, count) = (0.0, now.velocity, 20_000);
            let part_s = end_s / f64::from(count);
            for k in 1..=count {
                let point = ramps.at(part_s * f64::from(k) - 1e-12);
                prop_assert!(point.velocity.abs() <= speed.max(velocity.abs()) * (1.0 + 1e-12));
                integral += 0.5 * (before + point.velocity) * part_s;
                before = point.velocity;
                // the trapezoid rule errs where a ramp begins or ends within a part
                let error = (point.position - integral).abs();
                prop_assert!(error < 4.0 * part_s * speed.max(velocity.abs()), "{k}: {point:?} {integral}");
            }
        }
    }
}
