//! Moves of one axis beside their closed forms.

use proptest::prelude::*;

use crate::bench::Bench;

/// What of a move can be predicted: duration and position over time, from rest to rest.
///
/// Seven parts (B. Siciliano et al., Robotics, 2009, 4.2; L. Biagiotti, C. Melchiorri, Trajectory Planning, 2008,
/// 3.4): jerk, acceleration, jerk back, velocity, and the same back to rest with equal acceleration and deceleration.
struct Seven {
    jerk_s: f64,
    hold_s: f64,
    cruise_s: f64,
    acceleration: f64,
    jerk: f64,
    distance: f64,
}

impl Seven {
    fn new(distance: f64, velocity: f64, acceleration: f64, jerk: f64) -> Self {
        let way = |peak: f64| {
            let (jerk_s, hold_s) = Self::to_velocity(peak, acceleration, jerk);
            peak * (2.0 * jerk_s + hold_s)
        };
        // The peak velocity of a way too short is where both ramps make it up.
        let (mut low, mut peak) = (0.0, velocity);
        if way(velocity) > distance {
            let mut high = velocity;
            for _ in 0..200 {
                let middle = f64::midpoint(low, high);
                if way(middle) <= distance { low = middle } else { high = middle }
            }
            peak = low;
        }
        let (jerk_s, hold_s) = Self::to_velocity(peak, acceleration, jerk);
        let cruise_s = (distance - way(peak)) / peak;
        let acceleration = peak / (jerk_s + hold_s);
        Self { jerk_s, hold_s, cruise_s, acceleration, jerk, distance }
    }

    fn to_velocity(peak: f64, acceleration: f64, jerk: f64) -> (f64, f64) {
        if jerk == 0.0 {
            (0.0, peak / acceleration)
        } else if peak >= acceleration * acceleration / jerk {
            (acceleration / jerk, peak / acceleration - acceleration / jerk)
        } else {
            ((peak / jerk).sqrt(), 0.0)
        }
    }

    fn ramp_s(&self) -> f64 {
        2.0 * self.jerk_s + self.hold_s
    }

    fn duration_s(&self) -> f64 {
        2.0 * self.ramp_s() + self.cruise_s
    }

    /// Where it is within its first ramp.
    fn in_ramp(&self, t: f64) -> f64 {
        let (tj, th, a, j) = (self.jerk_s, self.hold_s, self.acceleration, self.jerk);
        if t <= tj {
            j * t * t * t / 6.0
        } else if t <= tj + th {
            let v = j * tj * tj / 2.0;
            let since = t - tj;
            j * tj * tj * tj / 6.0 + v * since + a * since * since / 2.0
        } else {
            // Point-symmetric about its middle.
            let peak = a * (tj + th);
            let ramp = self.ramp_s();
            peak * ramp / 2.0 - peak * (ramp - t) + self.in_ramp(ramp - t)
        }
    }

    fn position(&self, t: f64) -> f64 {
        let (ramp, peak) = (self.ramp_s(), self.acceleration * (self.jerk_s + self.hold_s));
        if t >= self.duration_s() {
            self.distance
        } else if t <= ramp {
            self.in_ramp(t)
        } else if t <= ramp + self.cruise_s {
            peak * ramp / 2.0 + peak * (t - ramp)
        } else {
            self.distance - self.in_ramp(self.duration_s() - t)
        }
    }
}

/// Runs the move in steps of 10 ms beside the closed form; every position within `tolerance`.
fn holds(distance: f64, velocity: f64, acceleration: f64, jerk: f64) {
    let expected = Seven::new(distance.abs(), velocity, acceleration, jerk);
    let mut bench = Bench::new();
    bench.start(
        "Relative",
        &[
            ("Distance", distance),
            ("Velocity", velocity),
            ("Acceleration", acceleration),
            ("Deceleration", acceleration),
            ("Jerk", jerk),
        ],
    );
    bench.scan();
    let begun = bench.now_s();
    let tolerance = 1e-9 * distance.abs().max(1.0);
    while !bench.get("Relative.Done") {
        bench.scan();
        let t = bench.now_s() - begun;
        let error = bench.position() - distance.signum() * expected.position(t);
        assert!(error.abs() < tolerance, "{t} s: {error}");
        assert!(t < expected.duration_s() + 0.011, "{t} s, and not done");
    }
    assert!(bench.now_s() - begun > expected.duration_s() - 1e-6);
    assert_eq!((bench.position(), bench.velocity(), bench.acceleration()), (distance, 0.0, 0.0));
}

#[test]
fn trapezoids_and_triangles_are_their_closed_forms() {
    holds(100.0, 20.0, 10.0, 0.0);
    holds(-100.0, 20.0, 10.0, 0.0);
    holds(10.0, 20.0, 10.0, 0.0);
    holds(-0.001, 20.0, 10.0, 0.0);
}

#[test]
fn jerk_limited_moves_are_their_closed_forms() {
    holds(100.0, 20.0, 10.0, 20.0);
    holds(-100.0, 20.0, 10.0, 20.0);
    // The velocity is not reached; nor the acceleration.
    holds(25.0, 20.0, 10.0, 20.0);
    holds(1.0, 20.0, 10.0, 20.0);
    // The velocity is, the acceleration is not.
    holds(100.0, 2.0, 10.0, 20.0);
}

#[test]
fn acceleration_and_deceleration_are_distinguished() {
    let mut bench = Bench::new();
    let values = [("Position", 100.0), ("Velocity", 20.0), ("Acceleration", 10.0), ("Deceleration", 40.0)];
    bench.start("Absolute", &values);
    bench.scan();
    let begun = bench.now_s();
    let (mut highest, mut lowest) = (0.0_f64, 0.0_f64);
    while !bench.get("Absolute.Done") {
        bench.scan();
        highest = highest.max(bench.acceleration());
        lowest = lowest.min(bench.acceleration());
    }
    assert_eq!((highest, lowest), (10.0, -40.0));
    // 2 s and 20 u, 0.5 s and 5 u, 75 u with 20 u/s between them.
    let duration = 2.0 + 0.5 + 75.0 / 20.0;
    assert!((bench.now_s() - begun - duration).abs() < 1e-9, "{}", bench.now_s() - begun);
}

#[test]
fn steps_do_not_matter() {
    let at = |step_ns: u64| {
        let mut bench = Bench::new();
        bench.start("Absolute", &[("Position", 7.0), ("Velocity", 2.0), ("Acceleration", 3.0), ("Jerk", 9.0)]);
        bench.scan();
        bench.step_ns = step_ns;
        bench.scans((1_200_000_000 / step_ns) as usize);
        [bench.position(), bench.velocity(), bench.acceleration()]
    };
    for (fine, coarse) in at(1_000_000).into_iter().zip(at(40_000_000)) {
        assert!((fine - coarse).abs() < 1e-9, "{fine} {coarse}");
    }
}

/// A target behind, or too near to stop before it: past it, and back.
#[test]
fn a_move_that_cannot_stop_in_time_comes_back() {
    let mut bench = Bench::new();
    bench.start("Velocity", &[("Velocity", 10.0), ("Acceleration", 10.0)]);
    bench.until("Velocity.InVelocity");
    let here = bench.position();
    bench.start(
        "Absolute",
        &[("Position", here + 1.0), ("Velocity", 10.0), ("Acceleration", 10.0), ("Deceleration", 10.0)],
    );
    bench.scan();
    let here = bench.position();
    let mut furthest = here;
    while !bench.get("Absolute.Done") {
        bench.scan();
        furthest = furthest.max(bench.position());
    }
    assert!((furthest - (here + 5.0)).abs() < 1e-9, "10 u/s need 5 u at 10 u/s2: {}", furthest - here);
    assert!(bench.get("Velocity.CommandAborted"));
    assert!((bench.position() - (here + 0.9)).abs() < 1e-9);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    #[test]
    fn any_move_from_rest_is_its_closed_form(
        distance in prop_oneof![0.001..100.0_f64, -100.0..-0.001_f64],
        velocity in 0.5..50.0_f64,
        acceleration in 0.5..50.0_f64,
        jerk in prop_oneof![Just(0.0), 1.0..500.0_f64],
    ) {
        holds(distance, velocity, acceleration, jerk);
    }
}
