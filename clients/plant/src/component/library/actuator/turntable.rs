//! A turntable, or a wheel, that runs on or steps from station to station.
//!
//! # Equations
//! - running: `dω/dt = ±α` until `ω = k ω_N`;
//! - stepping: from station to station, 2π/n apart, by a trapezoid of velocity on a rising `step`;
//! - `at_station` within the tolerance of a station, at rest.
//!
//! # Source
//! closed form; wheels of the filling machine (Sivtoft 2002, ch. 5).

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::kind::Dependence;
use crate::coupling::{Coordinate, Follow, Indexes};
use crate::setpoint::{Bounds, Setpoint};

parameters! {
    /// Its parameters.
    Parameters {
        /// stations on a turn
        stations: u32 = 4 => 1.0, 1000.0;
        /// greatest speed
        speed_rad_s: f64 = 2.0 => 1e-6, 1000.0;
        /// greatest acceleration
        acceleration_rad_s2: f64 = 8.0 => 1e-6, 1e5;
        /// greatest torque on a joint
        torque_max_nm: f64 = 1000.0 => 0.001, 1e7;
        /// at a station within this
        tolerance_rad: f64 = 0.001 => 1e-9, 1.0;
    }
}

signals! {
    /// What it takes.
    Inputs {
        /// runs on
        run: bool,
        /// part of the greatest speed, -1 to 1
        fraction: f64 = 1.0,
        /// rising: to the next station
        step: bool,
    }
}

signals! {
    /// What it gives.
    Outputs {
        /// angle since the set-up, turns counted
        angle_rad: f64,
        /// angular velocity
        velocity_rad_s: f64,
        /// at rest at a station
        at_station: bool,
        /// the station, from 0
        station: i32,
        /// moves
        busy: bool,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// it does not move
        Blocked = "blocked",
        /// the coupling slips: half the speed
        Slipping = "slipping",
    }
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    wheel: Setpoint,
    from: Setpoint,
    target_rad: Option<f64>,
    stepped: bool,
}

/// A turntable, or a wheel, that runs on or steps from station to station, by its parameters.
pub(crate) struct Turntable {
    p: Parameters,
}

impl Turntable {
    /// From one station to the next.
    fn pitch_rad(&self) -> f64 {
        TAU / f64::from(self.p.stations)
    }
}

impl Component for Turntable {
    const NAME: &'static str = "turntable";
    const SUMMARY: &'static str = "turntable or wheel: runs on, or steps from station to station";
    const FORMULA: &'static [&'static str] = &["dω/dt = ±α until ω = k ω_N", "stations 2π/n apart"];
    const SOURCE: &'static str = "closed form; wheels of the filling machine (Sivtoft 2002, ch. 5)";
    const DEPENDENCES: &'static [Dependence] = &[Dependence { inputs: &["fraction"], on: &["run"] }];
    own_types!(moves Indexes);

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, start: &Start<Option<Coordinate>>) -> State {
        let position = start.seen.map_or(0.0, |joint| joint.position);
        State {
            wheel: Setpoint { position, velocity: 0.0 },
            from: Setpoint { position, velocity: 0.0 },
            ..State::default()
        }
    }

    fn drive(&self, state: &mut State, inputs: &Inputs, turn: &Turn<Option<Coordinate>>) {
        let before = std::mem::replace(&mut state.stepped, inputs.step);
        let rising = inputs.step && !before;
        if let Some(joint) = turn.seen {
            let slack = self.p.speed_rad_s * turn.dt_s;
            state.wheel = state.wheel.near(joint.position, slack, || joint.velocity);
        }
        state.from = state.wheel;
        if turn.failed.has(Failure::Blocked) {
            state.wheel.velocity = 0.0;
            return;
        }
        let slipping = if turn.failed.has(Failure::Slipping) { 0.5 } else { 1.0 };
        let bounds = Bounds::unlimited(slipping * self.p.speed_rad_s, self.p.acceleration_rad_s2);
        if rising && !inputs.run && state.target_rad.is_none() {
            let next = (state.wheel.position / self.pitch_rad() + 0.5).floor() + 1.0;
            state.target_rad = Some(next * self.pitch_rad());
        }
        state.target_rad = state.target_rad.filter(|_| !inputs.run);
        state.wheel = if let Some(target) = state.target_rad {
            state.wheel.towards_position(target, &bounds, turn.dt_s)
        } else {
            let part = if inputs.run { inputs.fraction.clamp(-1.0, 1.0) } else { 0.0 };
            state.wheel.towards_velocity(part * bounds.speed, &bounds, turn.dt_s)
        };
        state.target_rad =
            state.target_rad.filter(|target| state.wheel.position != *target || state.wheel.velocity != 0.0);
    }

    fn effect(&self, state: &State) -> Follow {
        Follow { from: state.from, to: state.wheel, effort_max: self.p.torque_max_nm }
    }

    fn sense(&self, state: &mut State, _: &Inputs, turn: &Turn<Option<Coordinate>>) -> Outputs {
        let angle_rad = turn.seen.map_or(state.wheel.position, |joint| joint.position);
        let velocity_rad_s = turn.seen.map_or(state.wheel.velocity, |joint| joint.velocity);
        let nearest = (angle_rad / self.pitch_rad()).round();
        let off_rad = (angle_rad - nearest * self.pitch_rad()).abs();
        Outputs {
            angle_rad,
            velocity_rad_s,
            at_station: off_rad <= self.p.tolerance_rad && state.wheel.velocity == 0.0,
            station: (nearest as i64).rem_euclid(i64::from(self.p.stations)) as i32,
            busy: state.wheel.velocity != 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;
    use crate::component::tests::Rig;

    const REST: Inputs = Inputs { run: false, fraction: 1.0, step: false };
    const STEP: Inputs = Inputs { step: true, ..REST };
    const RUN: Inputs = Inputs { run: true, ..REST };

    fn rig() -> Rig<Turntable> {
        Rig::new(Turntable::new(Parameters::default()))
    }

    #[test]
    fn it_steps_around_and_takes_the_time_of_a_trapezoid() {
        let mut rig = rig();
        // (π/2)/2 + 2/8 = 1.035 s, and a few periods as the setpoint brakes on the grid of periods
        assert!(rig.run(STEP, 0.01, 103).busy);
        let out = rig.run(STEP, 0.01, 7);
        assert!(out.at_station && out.station == 1 && out.angle_rad == FRAC_PI_2, "{out:?}");
        for station in [2, 3, 0] {
            rig.run(REST, 0.01, 1);
            assert_eq!(rig.run(STEP, 0.01, 120).station, station);
        }
    }

    #[test]
    fn it_runs_on_at_its_part_of_the_speed() {
        let out = rig().run(Inputs { fraction: -0.5, ..RUN }, 0.01, 200);
        assert_eq!(out.velocity_rad_s, -1.0);
        // a ramp of 1/8 s and the rest of two seconds
        assert!((out.angle_rad + (2.0 - 0.0625)).abs() < 1e-12);
    }

    #[test]
    fn each_failure_has_its_effect() {
        assert_eq!(rig().failing(Failure::Blocked).run(RUN, 0.01, 50).angle_rad, 0.0);
        assert_eq!(rig().failing(Failure::Slipping).run(RUN, 0.01, 200).velocity_rad_s, 1.0);
    }
}
