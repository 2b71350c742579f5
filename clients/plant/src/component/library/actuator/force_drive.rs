//! A drive with a force command: a linear motor, a voice coil, or a servo press in force mode.
//!
//! # Equations
//! - `T dF/dt = F_c - F`, with the command `F_c` within `±F_max`: the current loop;
//! - where its force would take it beyond `±v_max` it seeks that velocity with no more than `|F|`;
//! - without a joint `m dv/dt = F - F_load - F_c sgn(v)`.
//!
//! # Source
//! W. Leonhard, *Control of Electrical Drives*, Springer 2001, ch. 7 (current loop as a lag of first order).
//!
//! # Method
//! The lag is exact; sub-steps of at most 0.25 ms, in which the force is constant.

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::{Resistance, Travel};
use crate::coupling::{Coordinate, Slides};
use crate::effort::{Effort, Motion};

use crate::component::commanded::{Commanded, LONGEST_S, Limits, Order, OwnMass};

parameters! {
    /// A drive, and what it moves without a joint.
    Parameters {
        /// greatest force either way
        force_max_n: f64 = 1000.0 => 0.001, 1e8;
        /// speed that it does not go beyond by itself
        speed_max_m_s: f64 = 2.0 => 1e-6, 1000.0;
        /// time constant of the current loop
        current_loop_s: f64 = 0.001 => 0.0, 10.0;
        /// all that moves; on a joint its bodies do
        moving_kg: f64 = 20.0 => 0.001, 1e6;
        /// constant load against the way up
        load_n: f64 = 0.0 => -1e7, 1e7;
        /// dry friction
        friction_n: f64 = 0.0 => 0.0, 1e6;
        /// lower end of the way without a joint, a stop
        lower_m: f64 = -1000.0 => -1e6, 0.0;
        /// upper end of the way without a joint, a stop
        upper_m: f64 = 1000.0 => 0.0, 1e6;
    }
}

signals! {
    /// What the PLC asks for.
    Inputs {
        /// the drive is on; without it it exerts nothing
        enable: bool = true,
        /// force up the coordinate
        command_n: f64,
    }
}

signals! {
    /// Feedback of the drive.
    Outputs {
        /// what it exerts
        force_n: f64,
        /// measured position
        position_m: f64,
        /// measured velocity
        velocity_m_s: f64,
        /// the command is beyond the greatest force, or the speed is at its limit
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
pub(crate) struct ForceDrive {
    p: Parameters,
}

impl ForceDrive {
    fn limits(&self) -> Limits {
        Limits { effort: self.p.force_max_n, speed: self.p.speed_max_m_s, lag_s: self.p.current_loop_s }
    }
}

fn order(inputs: &Inputs, turn: &Turn<Option<Coordinate>>) -> Order {
    if turn.failed.has(Failure::NoPower) || !inputs.enable {
        Order::Off
    } else if turn.failed.has(Failure::CommandFrozen) {
        Order::AsBefore
    } else {
        Order::Effort(inputs.command_n)
    }
}

impl Component for ForceDrive {
    const NAME: &'static str = "force_drive";
    const SUMMARY: &'static str = "drive with a force command: linear motor, voice coil, press in force mode";
    const FORMULA: &'static [&'static str] = &[
        "T dF/dt = F_c - F, F_c within ±F_max",
        "beyond ±v_max it brakes with |F|",
        "m dv/dt = F - F_load - F_c sgn(v)",
    ];
    const SOURCE: &'static str = "W. Leonhard, Control of Electrical Drives, 2001, ch. 7";
    own_types!(sees Slides);

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
        let range = (p.lower_m, p.upper_m);
        let resistance = Resistance { mass: p.moving_kg, dry: p.friction_n, viscous: 0.0, range };
        let own = OwnMass { load: p.load_n, resistance };
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
        state.commanded.on_joint(&self.limits(), &motion, (self.p.load_n, self.p.friction_n), dt_s)
    }

    fn sense(&self, state: &mut State, _: &Inputs, turn: &Turn<Option<Coordinate>>) -> Outputs {
        Outputs {
            force_n: state.commanded.exerted(),
            position_m: turn.seen.map_or(state.travel.position, |joint| joint.position),
            velocity_m_s: turn.seen.map_or(state.travel.velocity, |joint| joint.velocity),
            limited: state.commanded.is_limited(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    fn on(command_n: f64) -> Inputs {
        Inputs { enable: true, command_n }
    }

    #[test]
    fn the_force_follows_its_command_as_a_lag_at_every_step() {
        for (dt_s, turns) in [(1e-4, 20), (1e-3, 2), (2e-3, 1)] {
            let mut rig = Rig::new(ForceDrive::new(Parameters::default()));
            let out = rig.run(on(200.0), dt_s, turns);
            let exact = 200.0 * (1.0 - libm::exp(-2.0));
            assert!((out.force_n - exact).abs() < 1e-9, "{dt_s}: {out:?}");
        }
    }

    #[test]
    fn it_goes_no_faster_than_its_limit() {
        let p = Parameters { speed_max_m_s: 0.5, ..Parameters::default() };
        let mut rig = Rig::new(ForceDrive::new(p));
        let out = rig.run(on(5000.0), 0.01, 100);
        assert!(out.limited && (out.velocity_m_s - 0.5).abs() < 1e-12 && out.force_n.abs() < 1e-9, "{out:?}");
    }

    #[test]
    fn at_its_stop_it_presses_with_all_of_its_force() {
        for command_n in [500.0, -500.0] {
            let p = Parameters {
                moving_kg: 1.0,
                speed_max_m_s: 0.05,
                current_loop_s: 0.0,
                lower_m: -0.005,
                upper_m: 0.005,
                ..Parameters::default()
            };
            let mut rig = Rig::new(ForceDrive::new(p));
            let out = rig.run(on(command_n), 0.01, 100);
            assert_eq!((out.velocity_m_s, out.force_n, out.limited), (0.0, command_n, false));
        }
    }

    #[test]
    fn a_jammed_drive_stands_and_presses_and_one_without_power_does_not() {
        let mut rig = Rig::new(ForceDrive::new(Parameters::default())).failing(Failure::Jammed);
        let out = rig.run(on(100.0), 0.01, 100);
        assert_eq!((out.position_m, out.velocity_m_s), (0.0, 0.0));
        assert!((out.force_n - 100.0).abs() < 1e-9);
        let mut rig = Rig::new(ForceDrive::new(Parameters::default())).failing(Failure::NoPower);
        assert_eq!(rig.run(on(100.0), 0.01, 100).velocity_m_s, 0.0);
    }

    #[test]
    fn a_frozen_command_stays() {
        let mut rig = Rig::new(ForceDrive::new(Parameters::default()));
        rig.run(on(100.0), 0.01, 10);
        let mut rig = rig.failing(Failure::CommandFrozen);
        assert!((rig.run(on(0.0), 0.01, 10).force_n - 100.0).abs() < 1e-9);
    }
}
