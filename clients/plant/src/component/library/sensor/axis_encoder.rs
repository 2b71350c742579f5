//! An encoder with a number for an output: position and velocity of a joint, driven or passive, as a drive
//! or a measuring box gives them.
//!
//! # Equations
//! - `x = q floor(s (ξ - ξ_0)/q) + N(0, σ)` with the joint's coordinate ξ, in m or rad;
//! - `τ dv/dt = dx/dt - v`: the velocity is that of the shown position, smoothed.
//!
//! # Source
//! closed form; a quantised position gives a velocity in steps of q/Δt, as W. Brown et al., IEEE Trans. Ind.
//! Electron. 39 (1992), p. 11.

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::lag;
use crate::coupling::{Coordinate, Measures};
use onescan_server::random::Random;

parameters! {
    /// Its parameters; lengths are in m for a prismatic joint, angles in rad for a revolute one.
    Parameters {
        /// the coordinate that it shows as 0
        offset: f64 = 0.0 => -1e6, 1e6;
        /// what it shows for 1 m or 1 rad, such as 57.29578 for degrees
        scale_ratio: f64 = 1.0 => -1e6, 1e6;
        /// resolution, in what it shows; 0 for none
        step_span: f64 = 0.0 => 0.0, 1e6;
        /// standard deviation of the noise, in what it shows
        noise_span: f64 = 0.0 => 0.0, 1e6;
        /// time constant of the velocity
        lag_s: f64 = 0.0 => 0.0, 100.0;
    }
}

signals! {
    /// What it takes.
    Inputs {}
}

signals! {
    /// What it gives.
    Outputs {
        /// where the joint is
        position: f64,
        /// how fast it moves, per second
        velocity: f64,
        /// position and velocity are right
        valid: bool,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// no answer: 0, and not valid
        LinkDown = "link_down",
        /// the shaft slips: the position stands
        Slipping = "slipping",
    }
}

/// What it remembers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    position: Option<f64>,
    velocity: f64,
    random: Random,
}

/// An encoder, by its parameters.
pub(crate) struct AxisEncoder {
    p: Parameters,
}

impl AxisEncoder {
    fn shown(&self, coordinate: f64) -> f64 {
        let exact = self.p.scale_ratio * (coordinate - self.p.offset);
        if self.p.step_span > 0.0 { (exact / self.p.step_span).floor() * self.p.step_span } else { exact }
    }
}

impl Component for AxisEncoder {
    const NAME: &'static str = "axis_encoder";
    const SUMMARY: &'static str = "encoder with numbers for outputs: position and velocity of any joint";
    const FORMULA: &'static [&'static str] = &["x = q floor(s (ξ - ξ_0)/q) + N(0, σ)", "τ dv/dt = dx/dt - v"];
    const SOURCE: &'static str =
        "closed form; Brown et al., IEEE Trans. Ind. Electron. 39 (1992) (velocity of a quantised position)";
    own_types!(senses Measures);

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, start: &Start<Coordinate>) -> State {
        State { position: None, velocity: 0.0, random: Random::new(start.seed) }
    }

    fn sense(&self, state: &mut State, _: &Inputs, turn: &Turn<Coordinate>) -> Outputs {
        let noise = self.p.noise_span * state.random.normal();
        let before = state.position;
        let now = self.shown(turn.seen.position) + noise;
        let now = if turn.failed.has(Failure::Slipping) { before.unwrap_or(now) } else { now };
        state.position = Some(now);
        if turn.dt_s > 0.0 {
            let rate = (now - before.unwrap_or(now)) / turn.dt_s;
            state.velocity = lag(state.velocity, rate, self.p.lag_s, turn.dt_s);
        }
        if turn.failed.has(Failure::LinkDown) {
            return Outputs::default();
        }
        Outputs { position: now, velocity: state.velocity, valid: true }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    fn rig(p: Parameters) -> Rig<AxisEncoder> {
        Rig::new(AxisEncoder::new(p))
    }

    fn at(rig: &mut Rig<AxisEncoder>, position: f64) -> Outputs {
        rig.seen = Coordinate { position, velocity: 0.0 };
        rig.run(Inputs {}, 0.01, 1)
    }

    #[test]
    fn it_shows_the_coordinate_in_its_unit_and_the_rate_of_what_it_shows() {
        let mut rig = rig(Parameters { offset: 0.5, scale_ratio: 1000.0, ..Parameters::default() });
        assert_eq!(at(&mut rig, 0.75), Outputs { position: 250.0, velocity: 0.0, valid: true });
        let out = at(&mut rig, 0.76);
        assert!((out.position - 260.0).abs() < 1e-9 && (out.velocity - 1000.0).abs() < 1e-6, "{out:?}");
    }

    #[test]
    fn a_coarse_encoder_is_quiet_until_its_next_step() {
        let mut rig = rig(Parameters { step_span: 0.1, ..Parameters::default() });
        let shown: Vec<_> = [0.0, 0.09, 0.11, 0.19, -0.01].iter().map(|x| at(&mut rig, *x)).collect();
        let expected = [(0.0, 0.0), (0.0, 0.0), (0.1, 10.0), (0.1, 0.0), (-0.1, -20.0)];
        for (out, (position, velocity)) in shown.iter().zip(expected) {
            assert!((out.position - position).abs() < 1e-12 && (out.velocity - velocity).abs() < 1e-9, "{shown:?}");
        }
    }

    #[test]
    fn the_velocity_comes_through_its_lag_at_any_period() {
        for dt_s in [0.001, 0.01] {
            let mut rig = rig(Parameters { lag_s: 0.1, ..Parameters::default() });
            let turns = (0.2 / dt_s) as u32;
            let mut out = rig.run(Inputs {}, dt_s, 1);
            for k in 1..=turns {
                rig.seen = Coordinate { position: 3.0 * dt_s * f64::from(k), velocity: 3.0 };
                out = rig.run(Inputs {}, dt_s, 1);
            }
            // a steady 3 per second through exp(-t/τ); differences of positions are rounded
            assert!((out.velocity - 3.0 * (1.0 - libm::exp(-2.0))).abs() < 1e-10, "{out:?}");
        }
    }

    #[test]
    fn each_failure_has_its_effect() {
        assert_eq!(at(&mut rig(Parameters::default()).failing(Failure::LinkDown), 1.0), Outputs::default());
        let mut slipping = rig(Parameters::default()).failing(Failure::Slipping);
        at(&mut slipping, 1.0);
        assert_eq!(at(&mut slipping, 2.0).position, 1.0);
    }
}
