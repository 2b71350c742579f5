//! A resistance thermometer: first-order lag of its sleeve, noise, resistance of platinum.
//!
//! # Equations
//! - `τ dx/dt = ϑ - x`, exact over a period; `y = x + N(0, σ)`;
//! - `R = R_0 (1 + A y + B y²)`, and `+ R_0 C (y - 100) y³` below 0 °C: Callendar and van Dusen.
//!
//! # Source
//! IEC 60751:2022, 4.2.

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::lag;
use onescan_server::random::Random;

parameters! {
    /// Its parameters.
    Parameters {
        /// resistance at 0 °C
        rated_ohm: f64 = 100.0 => 1.0, 1e5;
        /// time constant of sensor and sleeve
        lag_s: f64 = 10.0 => 0.0, 1e5;
        /// standard deviation of the noise, in K
        noise_degc: f64 = 0.0 => 0.0, 100.0;
        /// what it shows at the set-up
        initial_degc: f64 = 20.0 => -200.0, 850.0;
    }
}

signals! {
    /// What it takes.
    Inputs {
        /// what it measures
        temperature_degc: f64 = 20.0,
    }
}

signals! {
    /// What it gives.
    Outputs {
        /// what it shows
        measured_degc: f64,
        /// its resistance
        resistance_ohm: f64,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// the wire is broken: the greatest reading, 850 °C
        BrokenWire = "broken_wire",
        /// a short circuit: the least reading, -200 °C
        ShortCircuit = "short_circuit",
        /// out of its sleeve: it shows 20 °C
        PulledOut = "pulled_out",
    }
}

/// What it remembers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    value: f64,
    random: Random,
}

/// A resistance thermometer, by its parameters.
pub(crate) struct TemperatureSensor {
    p: Parameters,
}

/// Ends of the range of the standard.
const LOWEST_DEGC: f64 = -200.0;
const HIGHEST_DEGC: f64 = 850.0;

/// Resistance of platinum at a temperature, related to that at 0 °C.
fn platinum(degc: f64) -> f64 {
    let (a, b, c) = (3.9083e-3, -5.775e-7, -4.183e-12);
    let cubic = if degc < 0.0 { c * (degc - 100.0) * degc * degc * degc } else { 0.0 };
    1.0 + a * degc + b * degc * degc + cubic
}

impl Component for TemperatureSensor {
    const NAME: &'static str = "temperature_sensor";
    const SUMMARY: &'static str = "resistance thermometer (Pt100) with lag and noise";
    const FORMULA: &'static [&'static str] = &["τ dx/dt = ϑ - x", "y = x + N(0, σ)", "R = R_0 (1 + A y + B y² + C (y - 100) y³ for y < 0)"];
    const SOURCE: &'static str = "IEC 60751:2022, 4.2";
    const INITIAL: &'static [&'static str] = &["initial_degc"];
    own_types!();

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, start: &Start) -> State {
        State { value: self.p.initial_degc, random: Random::new(start.seed) }
    }

    fn sense(&self, state: &mut State, inputs: &Inputs, turn: &Turn) -> Outputs {
        let around = if turn.failed.has(Failure::PulledOut) { 20.0 } else { inputs.temperature_degc };
        state.value = lag(state.value, around, self.p.lag_s, turn.dt_s);
        let noisy = state.value + self.p.noise_degc * state.random.normal();
        let measured_degc = match (turn.failed.has(Failure::BrokenWire), turn.failed.has(Failure::ShortCircuit)) {
            (true, _) => HIGHEST_DEGC,
            (false, true) => LOWEST_DEGC,
            (false, false) => noisy.clamp(LOWEST_DEGC, HIGHEST_DEGC),
        };
        Outputs { measured_degc, resistance_ohm: self.p.rated_ohm * platinum(measured_degc) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    fn rig(p: Parameters) -> Rig<TemperatureSensor> {
        Rig::new(TemperatureSensor::new(p))
    }

    #[test]
    fn platinum_is_as_in_the_table_of_the_standard() {
        // IEC 60751 table 1, printed to 0.01 Ω
        for (degc, ohm) in [(-200.0, 18.52), (-100.0, 60.26), (0.0, 100.0), (100.0, 138.51), (850.0, 390.48)] {
            assert!((100.0 * platinum(degc) - ohm).abs() <= 0.005 + 1e-9, "{degc}");
        }
    }

    #[test]
    fn a_step_comes_through_the_lag() {
        let out = rig(Parameters::default()).run(Inputs { temperature_degc: 120.0 }, 0.1, 100);
        // a hundred factors, each rounded to 2^-53
        assert!((out.measured_degc - (120.0 - 100.0 * libm::exp(-1.0))).abs() < 1e-11, "{out:?}");
    }

    #[test]
    fn each_failure_has_its_effect() {
        let hot = Inputs { temperature_degc: 200.0 };
        let after = |mode: Failure| rig(Parameters::default()).failing(mode).run(hot, 10.0, 10).measured_degc;
        assert_eq!(after(Failure::BrokenWire), 850.0);
        assert_eq!(after(Failure::ShortCircuit), -200.0);
        assert_eq!(after(Failure::PulledOut), 20.0);
    }
}
