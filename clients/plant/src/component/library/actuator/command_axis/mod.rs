//! An axis that is moved by command frames: a motion controller, its drive, and the axis itself.
//!
//! A frame holds five bits and five values. A rising edge of `execute` starts what the other bits say; a new edge
//! replaces what goes on. Positions, speeds and accelerations are in units of the axis, as the PLC has them.
//!
//! # Equations
//! - **position**: speed is a trapezoid or a triangle over time, from any speed, without a limit of jerk;
//! - **speed**: a ramp to the target speed, towards the target position, while `speed_control` is TRUE, then a ramp to rest;
//!   an axis with ends stops at them;
//! - **torque**: `tracking` closes, `torque_control` opens, neither stops; the piston runs at the flow of its pump until
//!   it meets something, and then presses with the target torque, %;
//! - **tracking**: `per_turn` moves the target torque towards 0 for each turn of the axis that it tracks; `offset` keeps
//!   `ratio` times its position, and the target position as an offset; `rate` keeps `ratio` times its speed; `curve` is a
//!   line through two points of its position, and an offset.
//!
//! Without `enable` the axis slows down and stands. A drive with a valve is fed forward by its table of voltage and
//! flow, `u = Q⁻¹(v)`, with a position loop: `T du'/dt = u - u'`, `d²v/dt² = ω²(Q(u') - v) - 2Dω dv/dt`.
//!
//! # Source
//! Nyyssönen 2018, 3.1.1 to 3.1.4, 3.2 and Figs. 13, 17, 22 to 24; the valve: M. Jelali, A. Kroll, *Hydraulic
//! Servo-systems*, Springer 2003, ch. 4, linearised.

mod motion;
mod ramps;
mod valve;

#[cfg(test)]
mod tests;

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Conflict, Start, Turn};
use crate::component::declare::{choice, failures, own_types, parameters, signals};
use crate::component::kind::Frames;
use crate::setpoint::Setpoint;
use motion::Mode;
use ramps::Ramps;
use valve::{FlowTable, Oil, Valve};

choice! {
    /// What tracking means.
    Track {
        /// Nothing: the bit closes an axis under torque.
        None = "none",
        /// So much for each turn of the other axis.
        PerTurn = "per_turn",
        /// The position of the other axis.
        Offset = "offset",
        /// The speed of the other axis.
        Rate = "rate",
        /// A line through two points over the position of the other axis.
        Curve = "curve",
    }
}

choice! {
    /// What moves the axis.
    Drive {
        /// It is where it should be.
        Ideal = "ideal",
        /// A 4/3 proportional valve on a cylinder.
        Valve = "valve",
    }
}

parameters! {
    /// An axis and its drive. Positions in units of the axis.
    Parameters {
        /// least position
        lower_units: f64 = 0.0 => -1e9, 1e9;
        /// greatest position
        upper_units: f64 = 65000.0 => -1e9, 1e9;
        /// where it stands at the set-up
        initial_units: f64 = 0.0 => -1e9, 1e9;
        /// it turns without ends, and its position begins at 0 again here; 0 for an axis with ends
        modulo_units: f64 = 0.0 => 0.0, 1e9;
        /// so close to its target it is in position
        window_units: f64 = 5.0 => 0.0, 1e9;
        /// speed under torque, by the flow of the pump
        stroke_units_s: f64 = 30000.0 => 1e-3, 1e9;
        /// acceleration and deceleration where a command has none
        braking_units_s2: f64 = 100_000.0 => 1e-3, 1e12;
        /// what tracking means: "none", `"per_turn"`, "offset", "rate" or "curve"
        track: Track = Track::None;
        /// units of the other axis that are one turn of it
        turn_units: f64 = 100.0 => 1e-6, 1e9;
        /// where the position of the other axis begins at 0 again; 0 if it does not
        turn_modulo_units: f64 = 0.0 => 0.0, 1e9;
        /// units of this axis for one of the other
        ratio: f64 = 1.0 => -1e6, 1e6;
        /// of a curve: the other axis at the first point
        curve_from_units: f64 = 0.0 => -1e9, 1e9;
        /// of a curve: this axis at the first point
        curve_at_from_units: f64 = 0.0 => -1e9, 1e9;
        /// of a curve: the other axis at the second point
        curve_to_units: f64 = 65000.0 => -1e9, 1e9;
        /// of a curve: this axis at the second point
        curve_at_to_units: f64 = 0.0 => -1e9, 1e9;
        /// what moves it: "ideal" or "valve"
        drive: Drive = Drive::Ideal;
        /// speed at 10 V: flow of the valve over the area of the piston
        full_units_s: f64 = 100_000.0 => 1e-3, 1e9;
        /// speed at the knee of the flow
        knee_units_s: f64 = 10000.0 => 1e-6, 1e9;
        /// voltage at the knee of the flow
        knee_v: f64 = 3.0 => 0.0, 10.0;
        /// voltage at which flow begins
        dead_v: f64 = 0.2 => 0.0, 10.0;
        /// time constant of the spool
        spool_s: f64 = 0.006 => 0.0, 1.0;
        /// natural frequency of the oil's spring with what it moves
        natural_hz: f64 = 15.0 => 0.1, 100.0;
        /// damping of the oil's spring
        damping: f64 = 0.4 => 0.0, 10.0;
        /// gain of the position loop
        gain_1_s: f64 = 12.0 => 0.0, 1000.0;
        /// what a transducer that drifts adds in a second
        drift_units_s: f64 = 20.0 => -1e6, 1e6;
    }
}

signals! {
    /// The command frame, and what the axis meets and tracks.
    Inputs {
        /// a rising edge starts a command
        execute: bool,
        /// track another axis; of an axis under torque: close
        tracking: bool,
        /// under torque: open
        torque_control: bool,
        /// run while this is TRUE
        speed_control: bool,
        /// commands are taken; without it the axis stands
        enable: bool,
        /// where to, or the offset of tracking
        target_position: f64,
        /// greatest speed, units/s
        target_speed: f64,
        /// greatest acceleration, units/s²
        target_acceleration: f64,
        /// greatest deceleration, units/s²
        target_deceleration: f64,
        /// pressure of the drive under torque, %; of tracking per turn the way for each turn
        target_torque: f64,
        /// position of the axis that is tracked, in its units
        tracked: f64,
        /// speed of the axis that is tracked, in its units per second
        tracked_speed: f64,
        /// what it closes on stands here
        obstacle: f64 = -1e9,
    }
}

signals! {
    /// The feedback frame, and what else there is to see.
    Outputs {
        /// the axis is well
        enabled: bool,
        /// the target is reached
        in_position: bool,
        /// by the transducer
        actual_position: f64,
        /// units/s
        actual_speed: f64,
        /// where it is
        position: f64,
        /// how fast it is, units/s
        speed: f64,
        /// pressure with which it holds, %
        pressing_pct: f64,
        /// control voltage of the valve
        valve_v: f64,
        /// 0 idle, 1 position, 2 speed, 3 torque, 4 tracking, 5 stopping
        mode: i32,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// the drive does not answer: no motion, and it is not well
        Dead = "dead",
        /// the pump stands: no motion and no pressure
        NoPressure = "no_pressure",
        /// a hose has burst: a fifth of the speed, and no pressure
        HoseBurst = "hose_burst",
        /// the spool's edges are worn: 0.8 V more until flow begins
        WornValve = "worn_valve",
        /// the transducer drifts
        Drifting = "drifting",
        /// the feedback frame stays as it is
        FrozenFeedback = "frozen_feedback",
        /// the axis does not move, and is well
        Jammed = "jammed",
    }
}

/// What the feedback frame says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Feedback {
    enabled: bool,
    in_position: bool,
    position: f64,
    speed: f64,
}

/// What it remembers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    mode: Mode,
    executed: bool,
    ramps: Ramps,
    /// Since the move began, s.
    since_s: f64,
    target: f64,
    /// Where the control wants it, and where it is.
    set: Setpoint,
    actual: Setpoint,
    oil: Oil,
    /// The axis that is tracked, a turn ago.
    tracked: f64,
    /// Deceleration of the command that goes on.
    braking: f64,
    in_position: bool,
    pressing_pct: f64,
    drift: f64,
    feedback: Feedback,
}

/// An axis by its parameters.
pub(crate) struct CommandAxis {
    p: Parameters,
    valve: Valve,
}

impl Component for CommandAxis {
    const NAME: &'static str = "command_axis";
    const SUMMARY: &'static str =
        "axis with a motion controller that takes command frames: position, speed, torque, tracking";
    const FORMULA: &'static [&'static str] = &[
        "position: trapezoid or triangle of speed from v, a, d",
        "per_turn: dx/dφ = -s/2π",
        "valve: u = Q⁻¹(v), T du'/dt = u - u'",
        "oil: d²v/dt² = ω²(Q(u') - v) - 2Dω dv/dt",
    ];
    const SOURCE: &'static str = "Nyyssönen 2018, 3.1 and Figs. 13, 22 to 24; Jelali, Kroll 2003, ch. 4, linearised";
    const FRAMES: Frames = Frames {
        command: &[
            "execute",
            "tracking",
            "torque_control",
            "speed_control",
            "enable",
            "target_position",
            "target_speed",
            "target_acceleration",
            "target_deceleration",
            "target_torque",
        ],
        feedback: &["enabled", "in_position", "actual_position", "actual_speed"],
    };
    const INITIAL: &'static [&'static str] = &["initial_units"];
    own_types!();

    fn new(p: Parameters) -> Self {
        let table = FlowTable { dead_v: p.dead_v, knee_v: p.knee_v, knee: p.knee_units_s, full: p.full_units_s };
        let valve =
            Valve { table, spool_s: p.spool_s, natural_hz: p.natural_hz, damping: p.damping, gain_1_s: p.gain_1_s };
        Self { p, valve }
    }

    fn conflict(p: &Parameters) -> Option<Conflict> {
        let turns = p.modulo_units > 0.0;
        let checks = [
            (p.lower_units >= p.upper_units && !turns, "lower_units", "a number below `upper_units`"),
            (
                !(p.lower_units..=p.upper_units).contains(&p.initial_units) && !turns,
                "initial_units",
                "a number from `lower_units` to `upper_units`",
            ),
            (p.dead_v >= p.knee_v, "dead_v", "a number below `knee_v`"),
            (p.knee_v >= 10.0, "knee_v", "a number below 10"),
            (p.knee_units_s >= p.full_units_s, "knee_units_s", "a number below `full_units_s`"),
            (p.curve_from_units == p.curve_to_units, "curve_to_units", "another number than `curve_from_units`"),
        ];
        let wrong = checks.into_iter().find(|(wrong, ..)| *wrong);
        wrong.map(|(_, key, wanted)| Conflict { key, wanted })
    }

    fn uses(p: &Parameters, input: usize) -> bool {
        let tracks = p.track != Track::None;
        !matches!(input, TRACKED | TRACKED_SPEED) || tracks
    }

    fn initial(&self, _: &Start) -> State {
        let rest = Setpoint { position: self.p.initial_units, velocity: 0.0 };
        State {
            mode: Mode::Idle,
            executed: false,
            ramps: Ramps::default(),
            since_s: 0.0,
            target: self.p.initial_units,
            set: rest,
            actual: rest,
            oil: Oil::REST,
            tracked: 0.0,
            braking: self.p.braking_units_s2,
            in_position: false,
            pressing_pct: 0.0,
            drift: 0.0,
            feedback: Feedback::default(),
        }
    }

    fn drive(&self, state: &mut State, inputs: &Inputs, turn: &Turn) {
        self.command(state, inputs);
        self.motion(state, inputs, turn);
    }

    fn sense(&self, state: &mut State, inputs: &Inputs, turn: &Turn) -> Outputs {
        if !turn.failed.has(Failure::FrozenFeedback) {
            state.feedback = Feedback {
                enabled: inputs.enable && !turn.failed.has(Failure::Dead),
                in_position: state.in_position,
                position: state.actual.position + state.drift,
                speed: state.actual.velocity,
            };
        }
        let Feedback { enabled, in_position, position, speed } = state.feedback;
        Outputs {
            enabled,
            in_position,
            actual_position: position,
            actual_speed: speed,
            position: state.actual.position,
            speed: state.actual.velocity,
            pressing_pct: state.pressing_pct,
            valve_v: state.oil.command_v,
            mode: state.mode.number(),
        }
    }
}

/// Places of the inputs that only tracking reads.
const TRACKED: usize = 10;
const TRACKED_SPEED: usize = 11;
