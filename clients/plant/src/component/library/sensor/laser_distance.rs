//! A laser distance sensor: measures how far along its beam the first body is.
//!
//! # Equations
//! - `τ dx/dt = s - x`, with the distance s along the beam, exact over a period;
//! - `y = q round((x + N(0, σ))/q)` within the measuring range;
//! - `I = 4 mA + 16 mA (y - near)/(far - near)`; without a body in the range `y = far` and 20.5 mA.
//!
//! # Source
//! IEC 60947-5-7 (analogue output); NAMUR NE 43 (3.6 mA on failure, 20.5 mA beyond the range).

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Conflict, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::{lag, quantised};
use crate::coupling::{Hit, Ray};
use onescan_server::random::Random;

parameters! {
    /// Its parameters.
    Parameters {
        /// near end of the measuring range
        near_m: f64 = 0.05 => 0.0, 1000.0;
        /// far end of the measuring range
        far_m: f64 = 2.0 => 0.001, 10000.0;
        /// time constant
        lag_s: f64 = 0.005 => 0.0, 100.0;
        /// standard deviation of the noise
        noise_m: f64 = 0.0 => 0.0, 1.0;
        /// resolution; 0 for none
        quantum_m: f64 = 0.0 => 0.0, 1.0;
    }
}

signals! {
    /// What it takes.
    Inputs {}
}

signals! {
    /// What it gives.
    Outputs {
        /// what it shows
        distance_m: f64,
        /// a body is within the measuring range
        in_range: bool,
        /// current of the loop
        current_ma: f64,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// no light comes back, as from a dirty lens
        Dirty = "dirty",
        /// the laser is off: 3.6 mA, which NE 43 calls a failure
        LaserOff = "laser_off",
        /// the value stands
        Frozen = "frozen",
    }
}

/// What it remembers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    /// None while there is nothing in the range.
    distance_m: Option<f64>,
    random: Random,
}

/// A laser distance sensor, by its parameters.
pub(crate) struct LaserDistance {
    p: Parameters,
}

impl Component for LaserDistance {
    const NAME: &'static str = "laser_distance";
    const SUMMARY: &'static str =
        "laser distance sensor: how far along its beam the first body is, with a loop of 4 to 20 mA";
    const FORMULA: &'static [&'static str] = &[
        "τ dx/dt = s - x",
        "y = q round((x + N(0, σ))/q)",
        "I = 4 mA + 16 mA (y - near)/(far - near), 20.5 mA beyond",
    ];
    const SOURCE: &'static str = "IEC 60947-5-7 (analogue output); NAMUR NE 43 (current on failure)";
    own_types!(senses Ray);

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn conflict(p: &Parameters) -> Option<Conflict> {
        (p.far_m <= p.near_m).then_some(Conflict { key: "far_m", wanted: "a number above `near_m`" })
    }

    fn initial(&self, start: &Start<Hit>) -> State {
        State { distance_m: None, random: Random::new(start.seed) }
    }

    fn sense(&self, state: &mut State, _: &Inputs, turn: &Turn<Hit>) -> Outputs {
        let p = &self.p;
        let seen = turn.seen.hit_m.filter(|hit_m| (p.near_m..=p.far_m).contains(hit_m));
        let seen = seen.filter(|_| !turn.failed.has(Failure::Dirty));
        if !turn.failed.has(Failure::Frozen) {
            // what comes into the range is measured at once, then followed
            state.distance_m = seen.map(|now_m| lag(state.distance_m.unwrap_or(now_m), now_m, p.lag_s, turn.dt_s));
        }
        let noise_m = p.noise_m * state.random.normal();
        if turn.failed.has(Failure::LaserOff) {
            return Outputs { distance_m: p.far_m, in_range: false, current_ma: 3.6 };
        }
        let Some(distance_m) = state.distance_m else {
            return Outputs { distance_m: p.far_m, in_range: false, current_ma: 20.5 };
        };
        let distance_m = quantised(distance_m + noise_m, p.quantum_m).clamp(p.near_m, p.far_m);
        let current_ma = 4.0 + 16.0 * (distance_m - p.near_m) / (p.far_m - p.near_m);
        Outputs { distance_m, in_range: true, current_ma }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    fn rig(p: Parameters) -> Rig<LaserDistance> {
        let mut rig = Rig::new(LaserDistance::new(p));
        rig.seen = Hit { hit_m: Some(1.025) };
        rig
    }

    #[test]
    fn a_step_comes_through_the_lag_and_the_loop_is_linear() {
        for dt_s in [0.001, 0.01] {
            let mut rig = rig(Parameters { lag_s: 0.05, ..Parameters::default() });
            let first = rig.run(Inputs {}, dt_s, 1);
            assert_eq!((first.distance_m, first.current_ma, first.in_range), (1.025, 12.0, true));
            rig.seen = Hit { hit_m: Some(0.5) };
            let out = rig.run(Inputs {}, dt_s, (0.1 / dt_s) as u32);
            // a hundred factors, each rounded to 2^-53
            assert!((out.distance_m - (0.5 + 0.525 * libm::exp(-2.0))).abs() < 1e-13, "{out:?}");
        }
    }

    #[test]
    fn beyond_its_range_it_sees_nothing() {
        for hit_m in [None, Some(0.04), Some(2.1)] {
            let mut rig = rig(Parameters::default());
            rig.seen = Hit { hit_m };
            let out = rig.run(Inputs {}, 0.01, 1);
            assert_eq!((out.distance_m, out.current_ma, out.in_range), (2.0, 20.5, false), "{hit_m:?}");
        }
    }

    #[test]
    fn noise_has_its_deviation_and_resolution_its_steps() {
        let mut rig = rig(Parameters { noise_m: 0.01, ..Parameters::default() });
        let seen: Vec<_> = (0..10_000).map(|_| rig.run(Inputs {}, 0.01, 1).distance_m - 1.025).collect();
        let variance = seen.iter().map(|x| x * x).sum::<f64>() / 10_000.0;
        // five standard errors √(2/n) of a variance
        assert!((variance / 1e-4 - 1.0).abs() < 5.0 * 0.014_2, "{variance}");
        let coarse = Parameters { quantum_m: 0.1, ..Parameters::default() };
        assert!((self::rig(coarse).run(Inputs {}, 0.01, 1).distance_m - 1.0).abs() < 1e-12);
    }

    #[test]
    fn each_failure_has_its_effect() {
        let after = |mode: Failure| rig(Parameters::default()).failing(mode).run(Inputs {}, 0.01, 3);
        assert_eq!(after(Failure::Dirty).current_ma, 20.5);
        assert_eq!(after(Failure::LaserOff).current_ma, 3.6);
        let mut frozen = rig(Parameters::default()).failing(Failure::Frozen);
        frozen.state.distance_m = Some(0.3);
        assert_eq!(frozen.run(Inputs {}, 0.01, 5).distance_m, 0.3);
    }
}
