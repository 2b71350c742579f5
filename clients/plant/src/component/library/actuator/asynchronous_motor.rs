//! An asynchronous motor behind an inverter or a soft starter with a ramp.
//!
//! # Equations
//! - `n_s = 60 f / p_pairs`: synchronous speed, of a frequency that goes to its setpoint at a limited rate;
//! - `s = (ω_s - ω) / ω_s,N`: slip, related to the rated synchronous speed;
//! - `M = 2 M_k / (s/s_k + s_k/s)`: Kloss's formula, with pull-out torque and slip; flux held constant;
//! - `J dω/dt = M - M_load - d ω`.
//!
//! # Source
//! M. Kloss, *Drehmoment und Schlüpfung des Drehstrommotors*, Archiv für Elektrotechnik 5 (1916).
//!
//! # Method
//! Runge and Kutta's fourth order, sub-steps of at most 0.5 ms.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::{Travel, ramp, substeps};
use crate::component::kind::Dependence;
use crate::coupling::{Coordinate, Turns};
use crate::effort::{Effort, Motion};

/// Longest sub-step.
const LONGEST_S: f64 = 0.5e-3;

parameters! {
    /// A motor and what feeds it.
    Parameters {
        /// rated frequency, that of a full setpoint
        frequency_hz: f64 = 50.0 => 1.0, 1000.0;
        /// pairs of poles
        pole_pairs: u32 = 2 => 1.0, 24.0;
        /// pull-out torque
        pull_out_nm: f64 = 50.0 => 0.001, 1e6;
        /// slip at the pull-out torque
        pull_out_rated_slip: f64 = 0.2 => 0.01, 1.0;
        /// inertia of the motor and of all that it turns
        inertia_kg_m2: f64 = 0.05 => 1e-6, 1e5;
        /// constant load, against the motion
        load_nm: f64 = 0.0 => 0.0, 1e6;
        /// load that grows with the speed
        viscous_nm_s: f64 = 0.0 => 0.0, 1e5;
        /// from standstill to the rated frequency; 0: straight on line
        ramp_s: f64 = 2.0 => 0.0, 600.0;
        /// at speed within this part of the setpoint
        at_speed_pct: f64 = 10.0 => 0.1, 100.0;
    }
}

signals! {
    /// Contactor or inverter.
    Inputs {
        /// runs
        run: bool,
        /// turns the other way
        reverse: bool,
        /// part of the rated frequency, 0 to 1
        setpoint: f64 = 1.0,
    }
}

signals! {
    /// Feedback of the inverter.
    Outputs {
        /// speed of the shaft
        speed_1_min: f64,
        /// angular velocity of the shaft
        velocity_rad_s: f64,
        /// torque in the air gap
        torque_nm: f64,
        /// frequency that the motor gets
        frequency_hz: f64,
        /// turns
        running: bool,
        /// the speed is that of the setpoint
        at_speed: bool,
        /// the motor protection has tripped
        fault: bool,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// the motor protection trips: no torque, `fault` is on
        Tripped = "tripped",
        /// a phase is missing: half the torque
        PhaseLoss = "phase_loss",
        /// the shaft is blocked
        Blocked = "blocked",
    }
}

/// What it remembers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    frequency_hz: f64,
    torque_nm: f64,
    shaft: Travel,
}

/// A motor by its parameters.
pub(crate) struct AsynchronousMotor {
    p: Parameters,
    rated_rad_s: f64,
    longest_s: f64,
}

impl AsynchronousMotor {
    /// Torque in the air gap at a frequency and a speed.
    fn torque_nm(&self, frequency_hz: f64, velocity_rad_s: f64) -> f64 {
        let synchronous = frequency_hz / self.p.frequency_hz * self.rated_rad_s;
        let slip = (synchronous - velocity_rad_s) / self.rated_rad_s;
        let related = slip / self.p.pull_out_rated_slip;
        // 2 / (r + 1/r) without its division by zero at r = 0
        2.0 * self.p.pull_out_nm * related / (1.0 + related * related)
    }

    /// Moves the frequency by a sub-step; the part of its torque that the motor has.
    fn feed(&self, state: &mut State, inputs: &Inputs, turn: &Turn<Option<Coordinate>>, dt_s: f64) -> f64 {
        let tripped = turn.failed.has(Failure::Tripped);
        let sign = if inputs.reverse { -1.0 } else { 1.0 };
        let wanted = if inputs.run && !tripped { sign * inputs.setpoint.clamp(0.0, 1.0) } else { 0.0 };
        let wanted_hz = wanted * self.p.frequency_hz;
        state.frequency_hz = if self.p.ramp_s > 0.0 {
            ramp(state.frequency_hz, wanted_hz, self.p.frequency_hz / self.p.ramp_s, dt_s)
        } else {
            wanted_hz
        };
        let fed = !tripped && (inputs.run || state.frequency_hz != 0.0);
        match (fed, turn.failed.has(Failure::PhaseLoss)) {
            (false, _) => 0.0,
            (true, true) => 0.5,
            (true, false) => 1.0,
        }
    }

    fn substep(&self, state: &mut State, part: f64, dt_s: f64) {
        let v = state.shaft.velocity;
        let driving_nm = |velocity: f64| {
            let motor_nm = if part == 0.0 { 0.0 } else { part * self.torque_nm(state.frequency_hz, velocity) };
            motor_nm - self.p.viscous_nm_s * velocity
        };
        let at_rest_nm = driving_nm(0.0);
        // the load is against the motion, and at rest against what would move it
        let load_nm = if v == 0.0 {
            self.p.load_nm.min(at_rest_nm.abs()).copysign(at_rest_nm)
        } else {
            self.p.load_nm.copysign(v)
        };
        let rate = |velocity: f64| (driving_nm(velocity) - load_nm) / self.p.inertia_kg_m2;
        let k1 = rate(v);
        let k2 = rate(v + 0.5 * dt_s * k1);
        let k3 = rate(v + 0.5 * dt_s * k2);
        let k4 = rate(v + dt_s * k3);
        let mut after = v + dt_s / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
        // a load brakes to a stand and no farther
        if after * v < 0.0 && at_rest_nm.abs() <= self.p.load_nm {
            after = 0.0;
        }
        state.shaft = Travel { position: state.shaft.position + 0.5 * dt_s * (v + after), velocity: after };
    }
}

impl Component for AsynchronousMotor {
    const NAME: &'static str = "asynchronous_motor";
    const SUMMARY: &'static str = "asynchronous motor with a ramp of its frequency";
    const FORMULA: &'static [&'static str] =
        &["ω_s = 2π f / p", "s = (ω_s - ω) / ω_s,N", "M = 2 M_k / (s/s_k + s_k/s)", "J dω/dt = M - M_load - d ω"];
    const SOURCE: &'static str = "M. Kloss, Archiv für Elektrotechnik 5 (1916)";
    const DEPENDENCES: &'static [Dependence] = &[Dependence { inputs: &["reverse", "setpoint"], on: &["run"] }];
    own_types!(sees Turns);

    fn new(p: Parameters) -> Self {
        let rated_rad_s = TAU * p.frequency_hz / f64::from(p.pole_pairs);
        Self { p, rated_rad_s, longest_s: LONGEST_S }
    }

    fn initial(&self, start: &Start<Option<Coordinate>>) -> State {
        let position = start.seen.map_or(0.0, |joint| joint.position);
        let shaft = Travel { position, velocity: 0.0 };
        State { frequency_hz: 0.0, torque_nm: 0.0, shaft }
    }

    fn drive(&self, state: &mut State, inputs: &Inputs, turn: &Turn<Option<Coordinate>>) {
        if turn.seen.is_some() {
            return;
        }
        let (count, dt_s) = substeps(turn.dt_s, self.longest_s);
        for _ in 0..count {
            let part = self.feed(state, inputs, turn, dt_s);
            if turn.failed.has(Failure::Blocked) {
                state.shaft.velocity = 0.0;
            } else {
                self.substep(state, part, dt_s);
            }
            state.torque_nm = part * self.torque_nm(state.frequency_hz, state.shaft.velocity);
        }
    }

    fn longest_s(&self) -> f64 {
        self.longest_s
    }

    fn advance(
        &self,
        state: &mut State,
        inputs: &Inputs,
        turn: &Turn<Option<Coordinate>>,
        motion: Motion,
        dt_s: f64,
    ) -> Effort {
        let velocity = motion.velocity;
        state.shaft = Travel::of(&motion);
        let part = self.feed(state, inputs, turn, dt_s);
        if turn.failed.has(Failure::Blocked) {
            state.torque_nm = part * self.torque_nm(state.frequency_hz, 0.0);
            return Effort::BLOCKED;
        }
        let torque_nm = |velocity: f64| part * self.torque_nm(state.frequency_hz, velocity);
        let (now_nm, step_rad_s) = (torque_nm(velocity), 1e-3 * self.rated_rad_s);
        let slope = (now_nm - torque_nm(velocity + step_rad_s)) / step_rad_s;
        state.torque_nm = now_nm;
        Effort { slope: slope.max(0.0), dry: self.p.load_nm, viscous: self.p.viscous_nm_s, ..Effort::of(now_nm) }
    }

    fn sense(&self, state: &mut State, inputs: &Inputs, turn: &Turn<Option<Coordinate>>) -> Outputs {
        let velocity_rad_s = turn.seen.map_or(state.shaft.velocity, |joint| joint.velocity);
        let wanted = inputs.setpoint.clamp(0.0, 1.0) * self.rated_rad_s;
        let near = (velocity_rad_s.abs() - wanted).abs() <= 0.01 * self.p.at_speed_pct * wanted;
        Outputs {
            speed_1_min: velocity_rad_s * 60.0 / TAU,
            velocity_rad_s,
            torque_nm: state.torque_nm,
            frequency_hz: state.frequency_hz,
            running: velocity_rad_s.abs() > 0.01 * self.rated_rad_s,
            at_speed: inputs.run && near && wanted > 0.0,
            fault: turn.failed.has(Failure::Tripped),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    const RUN: Inputs = Inputs { run: true, reverse: false, setpoint: 1.0 };
    const STOP: Inputs = Inputs { run: false, ..RUN };

    fn rig(p: Parameters) -> Rig<AsynchronousMotor> {
        Rig::new(AsynchronousMotor::new(p))
    }

    fn on_line() -> Parameters {
        Parameters { ramp_s: 0.0, ..Parameters::default() }
    }

    /// Run-up of a free motor from slip 1 to s: `t = J ω_s / (2 M_k) [(1 - s²)/(2 s_k) + s_k ln(1/s)]`.
    fn run_up_s(slip: f64) -> f64 {
        let rated_rad_s = TAU * 25.0;
        0.05 * rated_rad_s / 100.0 * ((1.0 - slip * slip) / 0.4 - 0.2 * libm::log(slip))
    }

    #[test]
    fn the_run_up_is_its_closed_form() {
        let mut rig = rig(on_line());
        let mut t_s = 0.0;
        for _ in 0..300 {
            rig.run(RUN, 0.001, 1);
            t_s += 0.001;
            let slip = 1.0 - rig.state.shaft.velocity / rig.component.rated_rad_s;
            if slip < 1e-3 {
                break;
            }
            // the fourth order leaves 1e-9 s; two hundred additions are rounded
            assert!((run_up_s(slip) - t_s).abs() < 1e-8, "{t_s}: {}", run_up_s(slip));
        }
        assert!(t_s > 0.15, "the closed form was really followed");
    }

    #[test]
    fn halving_the_step_divides_the_error_by_sixteen() {
        let error = |longest_s: f64| {
            let mut rig = rig(on_line());
            rig.component.longest_s = longest_s;
            rig.run(RUN, 0.16, 1);
            let slip = 1.0 - rig.state.shaft.velocity / rig.component.rated_rad_s;
            (run_up_s(slip) - 0.16).abs()
        };
        let errors = [error(8e-3), error(4e-3), error(2e-3)];
        for pair in errors.windows(2) {
            assert!((10.0..26.0).contains(&(pair[0] / pair[1])), "{errors:?}");
        }
    }

    #[test]
    fn under_load_it_runs_at_the_slip_of_kloss() {
        let load_nm = 25.0;
        let mut rig = rig(on_line());
        rig.run(RUN, 0.01, 100);
        // it would not start under this load
        rig.component.p.load_nm = load_nm;
        let out = rig.run(RUN, 0.01, 300);
        // 2 r / (1 + r²) = M / M_k = 1/2 at r = 2 - √3
        let slip = 0.2 * (2.0 - 3.0_f64.sqrt());
        let exact = TAU * 25.0 * (1.0 - slip);
        // a fixed point of the integration, reached to rounding
        assert!((out.velocity_rad_s - exact).abs() < 1e-9, "{} {exact}", out.velocity_rad_s);
        assert!((out.torque_nm - load_nm).abs() < 1e-9 && out.running && out.at_speed);
    }

    #[test]
    fn the_ramp_takes_its_time_both_ways() {
        let mut rig = rig(Parameters::default());
        assert_eq!(rig.run(RUN, 0.01, 100).frequency_hz.round(), 25.0);
        assert!(rig.run(RUN, 0.01, 150).at_speed);
        let out = rig.run(STOP, 0.01, 100);
        assert!((out.frequency_hz - 25.0).abs() < 1e-6 && out.running);
        let back = rig.run(Inputs { reverse: true, ..RUN }, 0.01, 400);
        assert!(back.speed_1_min < -1490.0, "{back:?}");
    }

    #[test]
    fn a_load_stops_it_and_does_not_turn_it() {
        let mut rig = rig(Parameters { load_nm: 10.0, ..on_line() });
        rig.run(RUN, 0.01, 200);
        let out = rig.run(STOP, 0.01, 300);
        assert_eq!((out.velocity_rad_s, out.running), (0.0, false));
    }

    #[test]
    fn each_failure_has_its_effect() {
        let after = |mode: Failure| rig(Parameters { load_nm: 30.0, ..on_line() }).failing(mode).run(RUN, 0.01, 100);
        let tripped = after(Failure::Tripped);
        assert!(tripped.fault && !tripped.running);
        assert_eq!(after(Failure::Blocked).velocity_rad_s, 0.0);
        assert!(!after(Failure::PhaseLoss).running, "half the torque does not lift 30 N·m off");
    }
}
