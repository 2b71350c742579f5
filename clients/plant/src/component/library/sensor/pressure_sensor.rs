//! A pressure transmitter: first-order lag, noise, a current loop.
//!
//! # Equations
//! - `τ dx/dt = p - x`, exact over a period;
//! - `y = x + N(0, σ)` within the measuring range;
//! - `I = 4 mA + 16 mA (y - p_low)/(p_high - p_low)`.
//!
//! # Source
//! NAMUR NE 43 (current on failure); IEC 60381-1 (4 to 20 mA).

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Conflict, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::lag;
use onescan_server::random::Random;

parameters! {
    /// Its parameters.
    Parameters {
        /// lower end of the measuring range
        low_bar: f64 = 0.0 => -1.0, 1e4;
        /// upper end of the measuring range
        high_bar: f64 = 10.0 => -0.9, 1e4;
        /// time constant
        lag_s: f64 = 0.01 => 0.0, 1000.0;
        /// standard deviation of the noise
        noise_bar: f64 = 0.0 => 0.0, 1e3;
    }
}

signals! {
    /// What it takes.
    Inputs {
        /// what it measures
        pressure_bar: f64,
    }
}

signals! {
    /// What it gives.
    Outputs {
        /// what it shows
        measured_bar: f64,
        /// current of the loop
        current_ma: f64,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// the loop is broken: 0 mA
        BrokenWire = "broken_wire",
        /// a short circuit: 22 mA, which NE 43 calls a failure
        ShortCircuit = "short_circuit",
        /// the value stands
        Frozen = "frozen",
    }
}

/// What it remembers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    value: f64,
    random: Random,
}

/// A pressure transmitter, by its parameters.
pub(crate) struct PressureSensor {
    p: Parameters,
}

impl Component for PressureSensor {
    const NAME: &'static str = "pressure_sensor";
    const SUMMARY: &'static str = "pressure transmitter with lag, noise and a loop of 4 to 20 mA";
    const FORMULA: &'static [&'static str] = &["τ dx/dt = p - x", "y = x + N(0, σ)", "I = 4 mA + 16 mA (y - p_low)/(p_high - p_low)"];
    const SOURCE: &'static str = "NAMUR NE 43 (current on failure); IEC 60381-1 (4 to 20 mA)";
    own_types!();

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn conflict(p: &Parameters) -> Option<Conflict> {
        (p.high_bar <= p.low_bar).then_some(Conflict { key: "high_bar", wanted: "a number above `low_bar`" })
    }

    fn initial(&self, start: &Start) -> State {
        State { value: 0.0, random: Random::new(start.seed) }
    }

    fn sense(&self, state: &mut State, inputs: &Inputs, turn: &Turn) -> Outputs {
        if !turn.failed.has(Failure::Frozen) {
            state.value = lag(state.value, inputs.pressure_bar, self.p.lag_s, turn.dt_s);
        }
        let (low, high) = (self.p.low_bar, self.p.high_bar);
        let noisy = state.value + self.p.noise_bar * state.random.normal();
        let measured_bar = noisy.clamp(low, high);
        let current_ma = 4.0 + 16.0 * (measured_bar - low) / (high - low);
        let broken = |current_ma: f64| Outputs { measured_bar: (current_ma - 4.0) / 16.0 * (high - low) + low, current_ma };
        match (turn.failed.has(Failure::BrokenWire), turn.failed.has(Failure::ShortCircuit)) {
            (true, _) => broken(0.0),
            (false, true) => broken(22.0),
            (false, false) => Outputs { measured_bar, current_ma },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    const FIVE: Inputs = Inputs { pressure_bar: 5.0 };

    fn rig(p: Parameters) -> Rig<PressureSensor> {
        Rig::new(PressureSensor::new(p))
    }

    #[test]
    fn a_step_comes_through_the_lag_at_any_period() {
        for dt_s in [0.001, 0.01] {
            let out = rig(Parameters { lag_s: 0.05, ..Parameters::default() }).run(FIVE, dt_s, (0.1 / dt_s) as u32);
            // a hundred factors, each rounded to 2^-53
            assert!((out.measured_bar - 5.0 * (1.0 - libm::exp(-2.0))).abs() < 1e-13, "{out:?}");
        }
        assert_eq!(rig(Parameters { lag_s: 0.0, ..Parameters::default() }).run(FIVE, 0.01, 1).current_ma, 12.0);
    }

    #[test]
    fn the_noise_has_its_deviation() {
        let mut rig = rig(Parameters { lag_s: 0.0, noise_bar: 0.1, ..Parameters::default() });
        let seen: Vec<_> = (0..10_000).map(|_| rig.run(FIVE, 0.01, 1).measured_bar - 5.0).collect();
        let variance = seen.iter().map(|x| x * x).sum::<f64>() / 10_000.0;
        // five standard errors √(2/n) of a variance
        assert!((variance / 0.01 - 1.0).abs() < 5.0 * 0.014_2, "{variance}");
    }

    #[test]
    fn each_failure_has_its_effect() {
        let after = |mode: Failure| rig(Parameters::default()).failing(mode).run(FIVE, 0.01, 100);
        assert_eq!(after(Failure::BrokenWire).current_ma, 0.0);
        assert_eq!(after(Failure::ShortCircuit).current_ma, 22.0);
        assert_eq!(after(Failure::Frozen).measured_bar, 0.0);
    }
}
