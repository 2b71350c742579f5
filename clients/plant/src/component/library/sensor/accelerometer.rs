//! An accelerometer on a body: what a mass in it feels along the body's axes.
//!
//! # Equations
//! - `τ df/dt = a - g - f`: a acceleration of its point over the last period, g free fall. At rest it shows
//!   9.81 m/s² upwards, in free fall 0;
//! - `y = q round((f + b + N(0, σ))/q)` within ± the measuring range.
//!
//! # Source
//! IEEE Std 1293-2018 (bias, range, noise of an accelerometer).

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::{felt, quantised};
use crate::coupling::{Motion, Moving};
use onescan_server::random::Random;

parameters! {
    /// Its parameters.
    Parameters {
        /// measuring range, to either side
        range_m_s2: f64 = 160.0 => 0.01, 1e6;
        /// time constant
        lag_s: f64 = 0.001 => 0.0, 100.0;
        /// bias of each axis
        bias_m_s2: f64 = 0.0 => -1e3, 1e3;
        /// standard deviation of each axis' noise
        noise_m_s2: f64 = 0.0 => 0.0, 1e3;
        /// resolution; 0 for none
        quantum_m_s2: f64 = 0.0 => 0.0, 1e3;
    }
}

signals! {
    /// What it takes.
    Inputs {}
}

signals! {
    /// What it gives.
    Outputs {
        /// along the body's x
        x_m_s2: f64,
        /// along the body's y
        y_m_s2: f64,
        /// along the body's z
        z_m_s2: f64,
        /// an axis is at an end of its range
        saturated: bool,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// the mass sticks: the values stand
        Stuck = "stuck",
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

/// An accelerometer, by its parameters.
pub(crate) struct Accelerometer {
    p: Parameters,
}

impl Component for Accelerometer {
    const NAME: &'static str = "accelerometer";
    const SUMMARY: &'static str = "accelerometer on a body: what a mass in it feels along three axes";
    const FORMULA: &'static [&'static str] =
        &["τ df/dt = a - g - f", "y = q round((f + b + N(0, σ))/q), within ± range"];
    const SOURCE: &'static str = "IEEE Std 1293-2018 (bias, range, noise)";
    own_types!(senses Motion);

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, start: &Start<Moving>) -> State {
        State { felt_m_s2: None, random: Random::new(start.seed) }
    }

    fn sense(&self, state: &mut State, _: &Inputs, turn: &Turn<Moving>) -> Outputs {
        let p = &self.p;
        let stands = turn.failed.has(Failure::Stuck);
        let felt = felt(&mut state.felt_m_s2, turn.seen.felt_m_s2, p.lag_s, turn.dt_s, stands);
        let [x_m_s2, y_m_s2, z_m_s2] = felt.map(|felt| {
            let noisy = felt + p.bias_m_s2 + p.noise_m_s2 * state.random.normal();
            quantised(noisy, p.quantum_m_s2).clamp(-p.range_m_s2, p.range_m_s2)
        });
        if turn.failed.has(Failure::NoSupply) {
            return Outputs::default();
        }
        let saturated = [x_m_s2, y_m_s2, z_m_s2].iter().any(|shown| shown.abs() >= p.range_m_s2);
        Outputs { x_m_s2, y_m_s2, z_m_s2, saturated }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    fn rig(p: Parameters, felt_m_s2: [f64; 3]) -> Rig<Accelerometer> {
        let mut rig = Rig::new(Accelerometer::new(p));
        rig.seen = Moving { felt_m_s2, ..Moving::default() };
        rig
    }

    #[test]
    fn a_step_comes_through_the_lag_at_any_period() {
        for dt_s in [0.001, 0.01] {
            let mut rig = rig(Parameters { lag_s: 0.05, bias_m_s2: 0.5, ..Parameters::default() }, [0.0, 0.0, 9.81]);
            assert_eq!(rig.run(Inputs {}, dt_s, 1).z_m_s2, 10.31);
            rig.seen.felt_m_s2 = [4.0, 0.0, 9.81];
            let out = rig.run(Inputs {}, dt_s, (0.1 / dt_s) as u32);
            // a hundred factors, each rounded to 2^-53
            assert!((out.x_m_s2 - 0.5 - 4.0 * (1.0 - libm::exp(-2.0))).abs() < 1e-12, "{out:?}");
        }
    }

    #[test]
    fn it_has_its_range_and_its_resolution() {
        let p = Parameters { range_m_s2: 20.0, quantum_m_s2: 0.5, ..Parameters::default() };
        let out = rig(p, [25.0, 3.3, 0.0]).run(Inputs {}, 0.01, 1);
        assert_eq!((out.x_m_s2, out.y_m_s2, out.saturated), (20.0, 3.5, true));
    }

    #[test]
    fn the_noise_has_its_deviation() {
        let mut rig = rig(Parameters { noise_m_s2: 0.1, ..Parameters::default() }, [0.0; 3]);
        let seen: Vec<_> = (0..10_000).map(|_| rig.run(Inputs {}, 0.01, 1).y_m_s2).collect();
        let variance = seen.iter().map(|x| x * x).sum::<f64>() / 10_000.0;
        // five standard errors √(2/n) of a variance
        assert!((variance / 0.01 - 1.0).abs() < 5.0 * 0.014_2, "{variance}");
    }

    #[test]
    fn each_failure_has_its_effect() {
        let felt = [1.0, 2.0, 3.0];
        let p = Parameters::default;
        assert_eq!(rig(p(), felt).failing(Failure::NoSupply).run(Inputs {}, 0.01, 1), Outputs::default());
        let mut stuck = rig(p(), felt).failing(Failure::Stuck);
        stuck.run(Inputs {}, 0.01, 1);
        stuck.seen.felt_m_s2 = [0.0; 3];
        assert_eq!(stuck.run(Inputs {}, 0.01, 100).z_m_s2, 3.0);
    }
}
