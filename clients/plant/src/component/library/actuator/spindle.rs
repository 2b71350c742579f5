//! A spindle: speed with a ramp, tool clamp, orientation left to the drive.
//!
//! # Equations
//! - `dω/dt = ±M_max/J`, a constant torque, until the commanded speed;
//! - `M_cut` brakes: `J dω/dt = M - M_cut - d ω` with the drive making up up to its torque;
//! - it runs only with its tool clamped.
//!
//! # Source
//! closed form.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::{Travel, ramp, substeps};
use crate::component::kind::Dependence;
use crate::coupling::{Coordinate, Turns};
use crate::effort::{Effort, Motion};

parameters! {
    /// Its parameters.
    Parameters {
        /// greatest speed
        speed_1_min: f64 = 12000.0 => 1.0, 1e6;
        /// greatest torque
        torque_max_nm: f64 = 20.0 => 1e-4, 1e6;
        /// inertia with the tool; on a joint its bodies have it
        inertia_kg_m2: f64 = 0.01 => 1e-9, 1e5;
        /// friction that grows with the speed
        viscous_nm_s: f64 = 0.0 => 0.0, 1e4;
        /// at speed within this part of the command
        at_speed_pct: f64 = 2.0 => 0.01, 100.0;
        /// from open to clamped
        clamp_s: f64 = 0.5 => 0.0, 60.0;
    }
}

signals! {
    /// What it takes.
    Inputs {
        /// runs
        run: bool,
        /// commanded speed, negative: the other way
        command_1_min: f64,
        /// torque of the cut
        cutting_nm: f64,
        /// clamps the tool
        clamp: bool = true,
    }
}

signals! {
    /// What it gives.
    Outputs {
        /// speed
        speed_1_min: f64,
        /// torque of the drive
        torque_nm: f64,
        /// at the commanded speed
        at_speed: bool,
        /// at rest
        stopped: bool,
        /// the tool is clamped
        clamped: bool,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// the drive is off
        DriveFault = "drive_fault",
        /// the clamp does not close
        ClampOpen = "clamp_open",
    }
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    shaft: Travel,
    torque_nm: f64,
    clamp: f64,
}

/// A spindle, by its parameters.
pub(crate) struct Spindle {
    p: Parameters,
}

/// Longest sub-step.
const LONGEST_S: f64 = 1e-3;

impl Spindle {
    fn wanted_rad_s(&self, state: &State, inputs: &Inputs) -> f64 {
        let wanted = if inputs.run && state.clamp >= 1.0 { inputs.command_1_min } else { 0.0 };
        wanted.clamp(-self.p.speed_1_min, self.p.speed_1_min) * TAU / 60.0
    }
}

impl Component for Spindle {
    const NAME: &'static str = "spindle";
    const SUMMARY: &'static str = "spindle with a ramp, a load and a tool clamp";
    const FORMULA: &'static [&'static str] = &["J dω/dt = M - M_cut - d ω, |M| ≤ M_max"];
    const SOURCE: &'static str = "closed form";
    const DEPENDENCES: &'static [Dependence] = &[Dependence { inputs: &["command_1_min"], on: &["run"] }];
    own_types!(sees Turns);

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, start: &Start<Option<Coordinate>>) -> State {
        let position = start.seen.map_or(0.0, |joint| joint.position);
        State { shaft: Travel { position, velocity: 0.0 }, clamp: 1.0, ..State::default() }
    }

    fn drive(&self, state: &mut State, inputs: &Inputs, turn: &Turn<Option<Coordinate>>) {
        let p = &self.p;
        let closing = inputs.clamp && !turn.failed.has(Failure::ClampOpen);
        let rate_1_s = if p.clamp_s > 0.0 { 1.0 / p.clamp_s } else { f64::MAX };
        state.clamp = ramp(state.clamp, f64::from(u8::from(closing)), rate_1_s, turn.dt_s);
        if turn.seen.is_some() {
            return;
        }
        let fed = !turn.failed.has(Failure::DriveFault);
        let wanted = self.wanted_rad_s(state, inputs);
        let (count, dt_s) = substeps(turn.dt_s, LONGEST_S);
        for _ in 0..count {
            let v = state.shaft.velocity;
            let cut_nm = inputs.cutting_nm.max(0.0);
            let needed = p.inertia_kg_m2 * (wanted - v) / dt_s + cut_nm.copysign(v) + p.viscous_nm_s * v;
            state.torque_nm = if fed { needed.clamp(-p.torque_max_nm, p.torque_max_nm) } else { 0.0 };
            let driven = v + dt_s * (state.torque_nm - p.viscous_nm_s * v) / p.inertia_kg_m2;
            // the cut brakes what turns, and never turns it
            let after = (driven.abs() - dt_s * cut_nm / p.inertia_kg_m2).max(0.0).copysign(driven);
            state.shaft = Travel { position: state.shaft.position + 0.5 * dt_s * (v + after), velocity: after };
        }
    }

    fn longest_s(&self) -> f64 {
        LONGEST_S
    }

    fn advance(
        &self,
        state: &mut State,
        inputs: &Inputs,
        turn: &Turn<Option<Coordinate>>,
        motion: Motion,
        _: f64,
    ) -> Effort {
        state.shaft = Travel::of(&motion);
        state.torque_nm = motion.exerted;
        let fed = !turn.failed.has(Failure::DriveFault);
        Effort {
            sought: fed.then(|| self.wanted_rad_s(state, inputs)),
            most: self.p.torque_max_nm,
            dry: inputs.cutting_nm.max(0.0),
            viscous: self.p.viscous_nm_s,
            ..Effort::of(0.0)
        }
    }

    fn sense(&self, state: &mut State, inputs: &Inputs, turn: &Turn<Option<Coordinate>>) -> Outputs {
        let velocity = turn.seen.map_or(state.shaft.velocity, |joint| joint.velocity);
        let speed_1_min = velocity * 60.0 / TAU;
        let off = (speed_1_min - inputs.command_1_min).abs();
        Outputs {
            speed_1_min,
            torque_nm: state.torque_nm,
            at_speed: inputs.run && off <= 0.01 * self.p.at_speed_pct * inputs.command_1_min.abs(),
            stopped: speed_1_min.abs() < 1e-3 * self.p.speed_1_min,
            clamped: state.clamp >= 1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    const RUN: Inputs = Inputs { run: true, command_1_min: 6000.0, cutting_nm: 0.0, clamp: true };

    fn rig() -> Rig<Spindle> {
        Rig::new(Spindle::new(Parameters::default()))
    }

    #[test]
    fn it_runs_up_at_its_greatest_torque() {
        // J ω / M = 0.01 · 628.3 / 20 = 0.314 s
        let mut rig = rig();
        let out = rig.run(RUN, 0.01, 20);
        let exact = 20.0 / 0.01 * 0.2 * 60.0 / TAU;
        // a constant rate is integrated exactly; two hundred additions are rounded
        assert!((out.speed_1_min - exact).abs() < 1e-9 && !out.at_speed);
        let out = rig.run(RUN, 0.01, 12);
        assert!(out.at_speed && (out.speed_1_min - 6000.0).abs() < 1e-9);
    }

    #[test]
    fn it_runs_out_by_its_closed_form_and_halving_the_step_halves_the_error() {
        // without a drive J dω/dt = -d ω: ω = ω0 exp(-d t/J)
        let error = |dt_s: f64| {
            let p = Parameters { viscous_nm_s: 0.01, ..Parameters::default() };
            let mut rig = Rig::new(Spindle::new(p));
            let before = rig.run(RUN, 0.01, 200);
            assert!((before.speed_1_min - 6000.0).abs() < 1e-9, "{before:?}");
            let out = rig.failing(Failure::DriveFault).run(RUN, dt_s, (1.0 / dt_s).round() as u32);
            (out.speed_1_min - 6000.0 * libm::exp(-1.0)).abs()
        };
        let errors = [1e-3, 5e-4, 2.5e-4].map(error);
        // half of d dt/J in a time constant
        assert!(errors[0] < 0.0006 * 6000.0 * libm::exp(-1.0), "{errors:?}");
        // first order: the ratio tends to 2
        assert!(errors.windows(2).all(|pair| (pair[0] / pair[1] - 2.0).abs() < 0.05), "{errors:?}");
    }

    #[test]
    fn a_cut_is_made_up_for_until_the_torque_is_spent() {
        let mut rig = rig();
        rig.run(RUN, 0.01, 50);
        let out = rig.run(Inputs { cutting_nm: 12.0, ..RUN }, 0.01, 50);
        assert!(out.at_speed && (out.torque_nm - 12.0).abs() < 1e-9, "{out:?}");
        let out = rig.run(Inputs { cutting_nm: 30.0, ..RUN }, 0.01, 100);
        assert!(out.stopped && !out.at_speed, "{out:?}");
    }

    #[test]
    fn it_runs_only_with_its_tool_clamped() {
        let mut rig = rig();
        assert!(rig.run(Inputs { clamp: false, ..RUN }, 0.01, 60).stopped);
        assert!(rig.run(RUN, 0.01, 100).clamped && !rig.run(RUN, 0.01, 1).stopped);
    }

    #[test]
    fn each_failure_has_its_effect() {
        assert!(rig().failing(Failure::DriveFault).run(RUN, 0.01, 50).stopped);
        assert!(!rig().failing(Failure::ClampOpen).run(RUN, 0.01, 50).clamped);
    }
}
