//! Motion from rest to rest in the least time, within limits of speed, acceleration and jerk.
//!
//! Seven segments in closed form; without a limit of jerk, the three of a trapezoid. The half that
//! speeds up is point-symmetric about its middle, and the half that slows down is its mirror image.

use serde::{Deserialize, Serialize};

/// Limits of a motion, all above 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Limits {
    pub(crate) speed: f64,
    pub(crate) acceleration: f64,
    /// m/s³, none for a trapezoid
    pub(crate) jerk: Option<f64>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Profile {
    /// Way, with its sign.
    distance: f64,
    /// Greatest speed that is reached.
    peak: f64,
    /// Time of constant jerk at each end of speeding up.
    jerk_s: f64,
    /// Time of speeding up.
    ramp_s: f64,
    /// Time at the greatest speed.
    cruise_s: f64,
}

/// Where a motion is, and how fast.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Point {
    pub(crate) way: f64,
    pub(crate) velocity: f64,
}

impl Profile {
    /// The fastest motion over a distance.
    pub(crate) fn plan(distance: f64, limits: &Limits) -> Self {
        let way = distance.abs();
        let Limits { speed, acceleration, jerk } = *limits;
        let jerk_s = |jerk: f64| (acceleration / jerk).min((speed / jerk).sqrt());
        // up to the full speed, if the way is long enough
        let full_jerk_s = jerk.map_or(0.0, jerk_s);
        let reached = jerk.map_or(acceleration, |jerk| jerk * full_jerk_s);
        let full_ramp_s = full_jerk_s + speed / reached;
        if way >= speed * full_ramp_s {
            let cruise_s = way / speed - full_ramp_s;
            return Self { distance, peak: speed, jerk_s: full_jerk_s, ramp_s: full_ramp_s, cruise_s };
        }
        let short = jerk.filter(|jerk| way < 2.0 * acceleration * (acceleration / jerk) * (acceleration / jerk));
        let (jerk_s, ramp_s) = match (short, jerk) {
            // the acceleration is not reached either: way = 2 j t³
            (Some(jerk), _) => {
                let jerk_s = libm::cbrt(0.5 * way / jerk);
                (jerk_s, 2.0 * jerk_s)
            }
            // way = a (t - tj) t
            (None, jerk) => {
                let jerk_s = jerk.map_or(0.0, |jerk| acceleration / jerk);
                (jerk_s, 0.5 * jerk_s + (0.25 * jerk_s * jerk_s + way / acceleration).sqrt())
            }
        };
        let peak = if ramp_s > 0.0 { way / ramp_s } else { 0.0 };
        Self { distance, peak, jerk_s, ramp_s, cruise_s: 0.0 }
    }

    /// How long the motion takes.
    pub(crate) fn duration_s(&self) -> f64 {
        2.0 * self.ramp_s + self.cruise_s
    }

    /// Speeding up from rest.
    fn ramp(&self, t_s: f64) -> Point {
        if t_s > 0.5 * self.ramp_s {
            let mirrored = self.ramp(self.ramp_s - t_s);
            let way = 0.5 * self.peak * self.ramp_s - self.peak * (self.ramp_s - t_s) + mirrored.way;
            return Point { way, velocity: self.peak - mirrored.velocity };
        }
        let acceleration = self.peak / (self.ramp_s - self.jerk_s);
        if t_s >= self.jerk_s {
            let velocity = acceleration * (t_s - 0.5 * self.jerk_s);
            let since_s = t_s - self.jerk_s;
            let first = acceleration * self.jerk_s * self.jerk_s / 6.0;
            let way = first + 0.5 * acceleration * since_s * (self.jerk_s + since_s);
            return Point { way, velocity };
        }
        let jerk = acceleration / self.jerk_s;
        Point { way: jerk * t_s * t_s * t_s / 6.0, velocity: 0.5 * jerk * t_s * t_s }
    }

    /// The motion at a time since its start.
    pub(crate) fn at(&self, t_s: f64) -> Point {
        let way = self.distance.abs();
        let left_s = self.duration_s() - t_s;
        let ahead = if left_s <= 0.0 {
            Point { way, velocity: 0.0 }
        } else if t_s < self.ramp_s {
            self.ramp(t_s)
        } else if left_s < self.ramp_s {
            let mirrored = self.ramp(left_s);
            Point { way: way - mirrored.way, velocity: mirrored.velocity }
        } else {
            Point { way: self.peak * (t_s - 0.5 * self.ramp_s), velocity: self.peak }
        };
        let sign = 1.0_f64.copysign(self.distance);
        Point { way: sign * ahead.way, velocity: sign * ahead.velocity }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SMOOTH: Limits = Limits { speed: 0.5, acceleration: 2.0, jerk: Some(20.0) };
    const SHARP: Limits = Limits { jerk: None, ..SMOOTH };

    #[test]
    fn durations_are_those_of_the_textbook() {
        let duration = |distance: f64, limits: &Limits| Profile::plan(distance, limits).duration_s();
        let close = |left: f64, right: f64| assert!((left - right).abs() < 1e-14, "{left} {right}");
        // trapezoid d/v + v/a; triangle 2 √(d/a); smooth d/v + v/a + a/j; all jerk 4 ∛(d/2j)
        close(duration(1.0, &SHARP), 2.0 + 0.25);
        close(duration(0.02, &SHARP), 2.0 * 0.1);
        close(duration(-1.0, &SMOOTH), 2.0 + 0.25 + 0.1);
        close(duration(0.001, &SMOOTH), 4.0 * libm::cbrt(0.001 / 40.0));
        close(duration(0.0, &SMOOTH), 0.0);
    }

    #[test]
    fn every_motion_is_smooth_keeps_its_limits_and_arrives() {
        for limits in [SMOOTH, SHARP] {
            for distance in [1.0, 0.3, 0.15, 0.04, 0.001, -0.5] {
                let profile = Profile::plan(distance, &limits);
                let h = profile.duration_s() / 1000.0;
                let points: Vec<_> = (0..=1000).map(|k| profile.at(f64::from(k) * h)).collect();
                for pair in points.windows(2) {
                    let acceleration = (pair[1].velocity - pair[0].velocity) / h;
                    assert!(pair[1].velocity.abs() <= limits.speed * (1.0 + 1e-12));
                    assert!(acceleration.abs() <= limits.acceleration * (1.0 + 1e-9), "{distance} {acceleration}");
                    let mean = 0.5 * (pair[0].velocity + pair[1].velocity);
                    let moved = pair[1].way - pair[0].way;
                    // trapezoid rule: a h²/4 where a corner of the velocity lies between the points
                    assert!((moved - mean * h).abs() <= 0.25 * limits.acceleration * h * h + 1e-15);
                }
                if let Some(jerk) = limits.jerk {
                    for three in points.windows(3) {
                        let bend = three[2].velocity - 2.0 * three[1].velocity + three[0].velocity;
                        assert!(bend.abs() <= jerk * h * h * (1.0 + 1e-6), "{distance}");
                    }
                }
                let end = profile.at(profile.duration_s() + 1.0);
                assert_eq!((end.way, end.velocity.abs()), (distance, 0.0));
            }
        }
    }
}
