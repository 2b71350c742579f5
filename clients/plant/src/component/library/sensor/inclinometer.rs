//! An inclinometer: how far a body is tilted, by the direction of what a mass in it feels.
//!
//! # Equations
//! - `τ df/dt = a - g - f` along the body's axes: a acceleration, g free fall;
//! - `roll = atan2(f_y, f_z)`, `pitch = atan2(-f_x, √(f_y² + f_z²))`;
//! - `y = q round((angle + N(0, σ))/q)`.
//!
//! A body that accelerates seems to tilt, as with every inclinometer.
//!
//! # Source
//! M. Pedley, Tilt Sensing Using a Three-Axis Accelerometer, NXP AN3461, 2013, eqs. 25 and 26.

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::{felt, quantised};
use crate::coupling::{Motion, Moving};
use onescan_server::random::Random;

parameters! {
    /// Its parameters.
    Parameters {
        /// time constant
        lag_s: f64 = 0.05 => 0.0, 100.0;
        /// standard deviation of the noise
        noise_deg: f64 = 0.0 => 0.0, 90.0;
        /// resolution; 0 for none
        quantum_deg: f64 = 0.0 => 0.0, 90.0;
    }
}

signals! {
    /// What it takes.
    Inputs {}
}

signals! {
    /// What it gives.
    Outputs {
        /// tilt about the body's x
        roll_deg: f64,
        /// tilt about the body's y
        pitch_deg: f64,
        /// both tilts together: from the body's z to the vertical
        tilt_deg: f64,
        /// it has its supply
        valid: bool,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// the values stand
        Frozen = "frozen",
        /// no supply: all values are 0
        NoSupply = "no_supply",
    }
}

/// What it remembers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    /// Behind the lag; none before the first look.
    felt_m_s2: Option<[f64; 3]>,
    random: Random,
}

/// An inclinometer, by its parameters.
pub(crate) struct Inclinometer {
    p: Parameters,
}

impl Component for Inclinometer {
    const NAME: &'static str = "inclinometer";
    const SUMMARY: &'static str = "inclinometer: how far a body is tilted, by what a mass in it feels";
    const FORMULA: &'static [&'static str] =
        &["τ df/dt = a - g - f", "roll = atan2(f_y, f_z), pitch = atan2(-f_x, √(f_y² + f_z²))"];
    const SOURCE: &'static str = "M. Pedley, Tilt Sensing Using a Three-Axis Accelerometer, NXP AN3461, 2013";
    own_types!(senses Motion);

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, start: &Start<Moving>) -> State {
        State { felt_m_s2: None, random: Random::new(start.seed) }
    }

    fn sense(&self, state: &mut State, _: &Inputs, turn: &Turn<Moving>) -> Outputs {
        let p = &self.p;
        let stands = turn.failed.has(Failure::Frozen);
        let felt = felt(&mut state.felt_m_s2, turn.seen.felt_m_s2, p.lag_s, turn.dt_s, stands);
        let mut shown =
            |angle_rad: f64| quantised(angle_rad.to_degrees() + p.noise_deg * state.random.normal(), p.quantum_deg);
        let [x, y, z] = felt;
        let across = (y * y + z * z).sqrt();
        let (roll_deg, pitch_deg) = (shown(libm::atan2(y, z)), shown(libm::atan2(-x, across)));
        let tilt_deg = shown(libm::atan2((x * x + y * y).sqrt(), z));
        if turn.failed.has(Failure::NoSupply) {
            return Outputs::default();
        }
        Outputs { roll_deg, pitch_deg, tilt_deg, valid: true }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    const G: f64 = 9.81;

    fn rig(felt_m_s2: [f64; 3]) -> Rig<Inclinometer> {
        let mut rig = Rig::new(Inclinometer::new(Parameters { lag_s: 0.05, ..Parameters::default() }));
        rig.seen = Moving { felt_m_s2, ..Moving::default() };
        rig
    }

    #[test]
    fn a_body_at_rest_shows_its_angles() {
        let (sin, cos) = libm::sincos(0.5);
        let rolled = rig([0.0, G * sin, G * cos]).run(Inputs {}, 0.01, 1);
        assert!((rolled.roll_deg - 0.5_f64.to_degrees()).abs() < 1e-12 && rolled.pitch_deg.abs() < 1e-12, "{rolled:?}");
        let pitched = rig([-G * sin, 0.0, G * cos]).run(Inputs {}, 0.01, 1);
        assert!((pitched.pitch_deg - 0.5_f64.to_degrees()).abs() < 1e-12 && pitched.roll_deg == 0.0, "{pitched:?}");
        assert!((pitched.tilt_deg - pitched.pitch_deg).abs() < 1e-12);
    }

    #[test]
    fn acceleration_looks_like_a_tilt_and_comes_through_the_lag() {
        for dt_s in [0.001, 0.01] {
            let mut rig = rig([0.0, 0.0, G]);
            rig.run(Inputs {}, dt_s, 1);
            rig.seen.felt_m_s2 = [2.0, 0.0, G];
            let out = rig.run(Inputs {}, dt_s, (0.1 / dt_s) as u32);
            let felt = 2.0 * (1.0 - libm::exp(-2.0));
            assert!((out.pitch_deg - libm::atan2(-felt, G).to_degrees()).abs() < 1e-11, "{out:?}");
        }
    }

    #[test]
    fn each_failure_has_its_effect() {
        assert_eq!(rig([1.0, 1.0, G]).failing(Failure::NoSupply).run(Inputs {}, 0.01, 1), Outputs::default());
        let mut frozen = rig([0.0, 0.0, G]).failing(Failure::Frozen);
        frozen.run(Inputs {}, 0.01, 1);
        frozen.seen.felt_m_s2 = [0.0, G, 0.0];
        assert_eq!(frozen.run(Inputs {}, 0.01, 100).roll_deg, 0.0);
    }
}
