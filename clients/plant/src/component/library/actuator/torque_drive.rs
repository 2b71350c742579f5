//! A drive with a torque command: a servo motor in torque mode, a winder, a screwdriver.
//!
//! # Equations
//! - `T dM/dt = M_c - M`, with the command `M_c` within `±M_max`: the current loop;
//! - where its torque would take it beyond `±ω_max` it seeks that velocity with no more than `|M|`;
//! - without a joint `J dω/dt = M - M_load - M_f sgn(ω)`.
//!
//! # Source
//! W. Leonhard, *Control of Electrical Drives*, Springer 2001, ch. 7 (current loop as a lag of first order).
//!
//! # Method
//! The lag is exact; sub-steps of at most 0.25 ms, in which the torque is constant.

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::{Resistance, Travel};
use crate::coupling::{Coordinate, Turns};
use crate::effort::{Effort, Motion};

use crate::component::commanded::{Commanded, LONGEST_S, Limits, Order, OwnMass};

parameters! {
    /// A drive, and what it moves without a joint.
    Parameters {
        /// greatest torque either way
        torque_max_nm: f64 = 10.0 => 0.001, 1e8;
        /// speed that it does not go beyond by itself
        speed_max_rad_s: f64 = 300.0 => 1e-6, 1000.0;
        /// time constant of the current loop
        current_loop_s: f64 = 0.001 => 0.0, 10.0;
        /// all that turns; on a joint its bodies do
        inertia_kg_m2: f64 = 0.1 => 0.001, 1e6;
        /// constant load against the way up
        load_nm: f64 = 0.0 => -1e7, 1e7;
        /// dry friction
        friction_nm: f64 = 0.0 => 0.0, 1e6;
        /// lower end of the way without a joint, a stop
        lower_rad: f64 = -1000.0 => -1e6, 0.0;
        /// upper end of the way without a joint, a stop
        upper_rad: f64 = 1000.0 => 0.0, 1e6;
    }
}

signals! {
    /// What the PLC asks for.
    Inputs {
        /// the drive is on; without it it exerts nothing
        enable: bool = true,
        /// torque up the coordinate
        command_nm: f64,
    }
}

signals! {
    /// Feedback of the drive.
    Outputs {
        /// what it exerts
        torque_nm: f64,
        /// measured position
        angle_rad: f64,
        /// measured velocity
        velocity_rad_s: f64,
        /// the command is beyond the greatest torque, or the speed is at its limit
        limited: bool,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// it exerts nothing
        NoPower = "no_power",
        /// it goes on with the command that it has
        CommandFrozen = "command_frozen",
        /// it does not move
        Jammed = "jammed",
    }
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    commanded: Commanded,
    travel: Travel,
}

/// A drive by its parameters.
pub(crate) struct TorqueDrive {
    p: Parameters,
}

impl TorqueDrive {
    fn limits(&self) -> Limits {
        Limits { effort: self.p.torque_max_nm, speed: self.p.speed_max_rad_s, lag_s: self.p.current_loop_s }
    }
}

fn order(inputs: &Inputs, turn: &Turn<Option<Coordinate>>) -> Order {
    if turn.failed.has(Failure::NoPower) || !inputs.enable {
        Order::Off
    } else if turn.failed.has(Failure::CommandFrozen) {
        Order::AsBefore
    } else {
        Order::Effort(inputs.command_nm)
    }
}

impl Component for TorqueDrive {
    const NAME: &'static str = "torque_drive";
    const SUMMARY: &'static str = "drive with a torque command: servo motor in torque mode, winder, screwdriver";
    const FORMULA: &'static [&'static str] = &[
        "T dM/dt = M_c - M, M_c within ±M_max",
        "beyond ±ω_max it brakes with |M|",
        "J dω/dt = M - M_load - M_f sgn(ω)",
    ];
    const SOURCE: &'static str = "W. Leonhard, Control of Electrical Drives, 2001, ch. 7";
    own_types!(sees Turns);

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, start: &Start<Option<Coordinate>>) -> State {
        let position = start.seen.map_or(0.0, |joint| joint.position);
        State { commanded: Commanded::default(), travel: Travel { position, velocity: 0.0 } }
    }

    fn drive(&self, state: &mut State, inputs: &Inputs, turn: &Turn<Option<Coordinate>>) {
        state.commanded.take(order(inputs, turn), &self.limits());
        if turn.seen.is_some() {
            return;
        }
        let p = &self.p;
        let range = (p.lower_rad, p.upper_rad);
        let resistance = Resistance { mass: p.inertia_kg_m2, dry: p.friction_nm, viscous: 0.0, range };
        let own = OwnMass { load: p.load_nm, resistance };
        let jammed = turn.failed.has(Failure::Jammed);
        state.commanded.turn(&mut state.travel, &self.limits(), &own, (turn.dt_s, jammed));
    }

    fn longest_s(&self) -> f64 {
        LONGEST_S
    }

    fn advance(
        &self,
        state: &mut State,
        _: &Inputs,
        turn: &Turn<Option<Coordinate>>,
        motion: Motion,
        dt_s: f64,
    ) -> Effort {
        if turn.failed.has(Failure::Jammed) {
            state.commanded.settle(&self.limits(), dt_s);
            return Effort::BLOCKED;
        }
        state.commanded.on_joint(&self.limits(), &motion, (self.p.load_nm, self.p.friction_nm), dt_s)
    }

    fn sense(&self, state: &mut State, _: &Inputs, turn: &Turn<Option<Coordinate>>) -> Outputs {
        Outputs {
            torque_nm: state.commanded.exerted(),
            angle_rad: turn.seen.map_or(state.travel.position, |joint| joint.position),
            velocity_rad_s: turn.seen.map_or(state.travel.velocity, |joint| joint.velocity),
            limited: state.commanded.is_limited(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    fn on(command_nm: f64) -> Inputs {
        Inputs { enable: true, command_nm }
    }

    #[test]
    fn the_torque_follows_its_command_as_a_lag_at_every_step() {
        for (dt_s, turns) in [(1e-4, 20), (1e-3, 2), (2e-3, 1)] {
            let mut rig = Rig::new(TorqueDrive::new(Parameters::default()));
            let out = rig.run(on(8.0), dt_s, turns);
            let exact = 8.0 * (1.0 - libm::exp(-2.0));
            assert!((out.torque_nm - exact).abs() < 1e-9, "{dt_s}: {out:?}");
        }
    }

    #[test]
    fn it_goes_no_faster_than_its_limit() {
        let p = Parameters { speed_max_rad_s: 0.5, ..Parameters::default() };
        let mut rig = Rig::new(TorqueDrive::new(p));
        let out = rig.run(on(5000.0), 0.01, 100);
        assert!(out.limited && (out.velocity_rad_s - 0.5).abs() < 1e-12 && out.torque_nm.abs() < 1e-9, "{out:?}");
    }

    #[test]
    fn a_jammed_drive_stands_and_presses_and_one_without_power_does_not() {
        let mut rig = Rig::new(TorqueDrive::new(Parameters::default())).failing(Failure::Jammed);
        let out = rig.run(on(5.0), 0.01, 100);
        assert_eq!((out.angle_rad, out.velocity_rad_s), (0.0, 0.0));
        assert!((out.torque_nm - 5.0).abs() < 1e-9);
        let mut rig = Rig::new(TorqueDrive::new(Parameters::default())).failing(Failure::NoPower);
        assert_eq!(rig.run(on(5.0), 0.01, 100).velocity_rad_s, 0.0);
    }

    #[test]
    fn a_frozen_command_stays() {
        let mut rig = Rig::new(TorqueDrive::new(Parameters::default()));
        rig.run(on(5.0), 0.01, 10);
        let mut rig = rig.failing(Failure::CommandFrozen);
        assert!((rig.run(on(0.0), 0.01, 10).torque_nm - 5.0).abs() < 1e-9);
    }
}
