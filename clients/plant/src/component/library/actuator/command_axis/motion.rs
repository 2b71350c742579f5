//! The state machine of commands, and the motion of a period in each of its states.

use serde::{Deserialize, Serialize};

use super::ramps::{Limits, Ramps};
use super::valve::{Oil, Wanted, Wear};
use super::{CommandAxis, Drive, Failure, Inputs, Parameters, State, Track};
use crate::component::behaviour::Turn;
use crate::setpoint::{Bounds, Setpoint};

/// What an axis does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Mode {
    /// Nothing since the set-up.
    Idle,
    Position,
    Speed,
    Torque,
    Tracking,
    /// It slows down, or has.
    Stopping,
}

impl Mode {
    /// Its number in the outputs.
    pub(super) const fn number(self) -> i32 {
        match self {
            Self::Idle => 0,
            Self::Position => 1,
            Self::Speed => 2,
            Self::Torque => 3,
            Self::Tracking => 4,
            Self::Stopping => 5,
        }
    }
}

/// Part of the pressure with which a piston that moves freely runs.
const FREE_PRESSURE: f64 = 0.1;
/// Part of the speed that a burst hose leaves.
const BURST_SPEED: f64 = 0.2;

/// A value of a frame, or what stands for it where that is not a number above 0.
fn or(value: f64, preset: f64) -> f64 {
    if value.is_finite() && value > 0.0 { value } else { preset }
}

/// A value of a frame, 0 where it is none.
fn finite(value: f64) -> f64 {
    if value.is_finite() { value } else { 0.0 }
}

impl Parameters {
    fn turns(&self) -> bool {
        self.modulo_units > 0.0
    }

    /// The position nearest to `wanted` that the axis has.
    fn within(&self, wanted: f64) -> f64 {
        if self.turns() { wanted } else { wanted.clamp(self.lower_units, self.upper_units) }
    }
}

impl CommandAxis {
    fn limits(&self, inputs: &Inputs) -> Limits {
        let p = &self.p;
        Limits {
            speed: or(inputs.target_speed, p.stroke_units_s),
            acceleration: or(inputs.target_acceleration, p.braking_units_s2),
            deceleration: or(inputs.target_deceleration, p.braking_units_s2),
        }
    }

    /// Takes what a frame says: a new command at a rising edge, and rest without `enable`.
    pub(super) fn command(&self, state: &mut State, inputs: &Inputs) {
        let rising = inputs.execute && !state.executed;
        state.executed = inputs.execute;
        if !inputs.enable {
            if !matches!(state.mode, Mode::Idle | Mode::Stopping) {
                state.mode = Mode::Stopping;
                state.in_position = false;
            }
            return;
        }
        if !rising {
            return;
        }
        let limits = self.limits(inputs);
        state.in_position = false;
        state.braking = limits.deceleration;
        state.mode = if inputs.tracking && self.p.track != Track::None {
            state.tracked = finite(inputs.tracked);
            Mode::Tracking
        } else if inputs.tracking || inputs.torque_control {
            Mode::Torque
        } else if inputs.speed_control {
            state.target = finite(inputs.target_position);
            Mode::Speed
        } else {
            state.target = self.p.within(finite(inputs.target_position));
            state.ramps = Ramps::plan(state.set, state.target, limits);
            state.since_s = 0.0;
            Mode::Position
        };
    }

    /// Moves the axis by a period.
    pub(super) fn motion(&self, state: &mut State, inputs: &Inputs, turn: &Turn) {
        let dt_s = turn.dt_s;
        if dt_s <= 0.0 {
            return;
        }
        if turn.failed.has(Failure::Drifting) {
            state.drift += self.p.drift_units_s * dt_s;
        }
        let stuck = [Failure::Dead, Failure::Jammed].into_iter().any(|mode| turn.failed.has(mode));
        if stuck || (turn.failed.has(Failure::NoPressure) && self.p.drive == Drive::Ideal) {
            // the control goes on from where the axis really is, once it is free
            state.actual.velocity = 0.0;
            self.stand(state, 0.0);
            state.in_position = false;
            return;
        }
        let from = state.set;
        if state.mode == Mode::Torque {
            self.press(state, inputs, turn);
        } else {
            state.pressing_pct = 0.0;
            state.set = self.wanted(state, inputs, dt_s);
            self.follow(state, from, inputs, turn);
        }
        self.wrap(state);
    }

    /// The axis stands where it is, and presses so.
    fn stand(&self, state: &mut State, pressing_pct: f64) {
        state.set = Setpoint { position: state.actual.position, velocity: 0.0 };
        state.oil = Oil::REST;
        state.pressing_pct = pressing_pct;
        if state.mode == Mode::Position {
            state.ramps = Ramps::plan(state.set, state.target, self.slow(state));
            state.since_s = 0.0;
        }
    }

    /// Limits of a move that is taken up again.
    fn slow(&self, state: &State) -> Limits {
        Limits { speed: self.p.stroke_units_s, acceleration: state.braking, deceleration: state.braking }
    }

    /// Where the control wants the axis at the end of the period.
    fn wanted(&self, state: &mut State, inputs: &Inputs, dt_s: f64) -> Setpoint {
        match state.mode {
            Mode::Idle | Mode::Torque => Setpoint { velocity: 0.0, ..state.set },
            Mode::Position => {
                state.since_s += dt_s;
                state.ramps.at(state.since_s)
            }
            Mode::Speed if inputs.speed_control => self.run(state, inputs, dt_s),
            Mode::Speed | Mode::Stopping => {
                let bounds = Bounds::unlimited(f64::INFINITY, or(inputs.target_deceleration, state.braking));
                self.bounded(state.set.towards_velocity(0.0, &bounds, dt_s))
            }
            Mode::Tracking => self.track(state, inputs, dt_s),
        }
    }

    fn bounded(&self, set: Setpoint) -> Setpoint {
        let position = self.p.within(set.position);
        if position == set.position { set } else { Setpoint { position, velocity: 0.0 } }
    }

    /// Speed control: the speed of the frame holds as it is now, for a PLC that changes it in every scan.
    fn run(&self, state: &State, inputs: &Inputs, dt_s: f64) -> Setpoint {
        let limits = self.limits(inputs);
        let way = state.target - state.set.position;
        let target = if self.p.turns() { state.target } else { way };
        let wanted = finite(inputs.target_speed).max(0.0).copysign(target);
        let slower = wanted.abs() < state.set.velocity.abs() || wanted * state.set.velocity < 0.0;
        let rate = if slower { limits.deceleration } else { limits.acceleration };
        if self.p.turns() {
            return state.set.towards_velocity(wanted, &Bounds::unlimited(f64::INFINITY, rate), dt_s);
        }
        let bounds = Bounds::unlimited(limits.speed, limits.deceleration.min(rate));
        let end = if target > 0.0 { self.p.upper_units } else { self.p.lower_units };
        self.bounded(state.set.towards_position(self.p.within(end), &bounds, dt_s))
    }

    /// Tracking of another axis, whose position is that of a turn ago: so its way in this turn is added.
    fn track(&self, state: &mut State, inputs: &Inputs, dt_s: f64) -> Setpoint {
        let p = &self.p;
        let ahead = finite(inputs.tracked) + finite(inputs.tracked_speed) * dt_s;
        let set = state.set;
        let fastest = or(inputs.target_speed, p.stroke_units_s);
        let position = match p.track {
            Track::None => return Setpoint { velocity: 0.0, ..set },
            Track::Rate => {
                let bounds = Bounds::unlimited(fastest, or(inputs.target_acceleration, p.braking_units_s2));
                return set.towards_velocity(p.ratio * finite(inputs.tracked_speed), &bounds, dt_s);
            }
            Track::PerTurn => {
                let mut moved = ahead - state.tracked;
                if p.turn_modulo_units > 0.0 {
                    moved -= (moved / p.turn_modulo_units).round() * p.turn_modulo_units;
                }
                state.tracked = ahead;
                set.position - finite(inputs.target_torque) * moved / p.turn_units
            }
            Track::Offset => p.ratio * ahead + finite(inputs.target_position),
            Track::Curve => {
                let slope = (p.curve_at_to_units - p.curve_at_from_units) / (p.curve_to_units - p.curve_from_units);
                let part =
                    ahead.clamp(p.curve_from_units.min(p.curve_to_units), p.curve_from_units.max(p.curve_to_units));
                p.curve_at_from_units + slope * (part - p.curve_from_units) + finite(inputs.target_position)
            }
        };
        let most = fastest * dt_s;
        let next = p.within(set.position + (position - set.position).clamp(-most, most));
        state.target = p.within(position);
        Setpoint { position: next, velocity: (next - set.position) / dt_s }
    }

    /// The axis follows what the control wants.
    fn follow(&self, state: &mut State, from: Setpoint, inputs: &Inputs, turn: &Turn) {
        let burst = turn.failed.has(Failure::HoseBurst);
        if self.p.drive == Drive::Ideal && burst {
            let position = from.position + BURST_SPEED * (state.set.position - from.position);
            state.actual = Setpoint { position, velocity: BURST_SPEED * state.set.velocity };
            self.stand(state, 0.0);
        } else if self.p.drive == Drive::Ideal {
            state.actual = state.set;
        } else {
            let wear = Wear {
                worn: turn.failed.has(Failure::WornValve),
                no_pressure: turn.failed.has(Failure::NoPressure) || burst,
            };
            let wanted = Wanted { from, to: state.set, is_on: inputs.enable };
            self.valve.advance(&mut state.oil, &mut state.actual, &wanted, wear, turn.dt_s);
            let bounded = self.bounded(state.actual);
            if bounded != state.actual {
                state.actual = bounded;
                state.oil = Oil::REST;
            }
        }
        let reached = match state.mode {
            Mode::Position => state.since_s >= state.ramps.duration_s(),
            Mode::Tracking => matches!(self.p.track, Track::Offset | Track::Curve),
            Mode::Idle | Mode::Speed | Mode::Torque | Mode::Stopping => false,
        };
        // once it was, it stays until the next command
        state.in_position |= reached && (state.actual.position - state.target).abs() <= self.p.window_units;
    }

    /// Torque control: towards an end until the piston meets something.
    fn press(&self, state: &mut State, inputs: &Inputs, turn: &Turn) {
        let p = &self.p;
        let lost = turn.failed.has(Failure::NoPressure) || turn.failed.has(Failure::HoseBurst);
        let torque = if lost { 0.0 } else { finite(inputs.target_torque).clamp(0.0, 100.0) };
        let way = match (inputs.tracking, inputs.torque_control) {
            (true, false) => -1.0,
            (false, true) => 1.0,
            // both at once make no sense, and neither is what a lost supply looks like
            (true, true) | (false, false) => 0.0,
        };
        let obstacle =
            if finite(inputs.obstacle) > p.lower_units { inputs.obstacle.min(p.upper_units) } else { p.lower_units };
        let end = if way < 0.0 { obstacle.min(state.actual.position) } else { p.upper_units };
        let still = way == 0.0 || torque == 0.0;
        let moved = if still { 0.0 } else { way * p.stroke_units_s * turn.dt_s };
        let met = !still && (end - state.actual.position).abs() <= moved.abs();
        let position = if met { end } else { state.actual.position + moved };
        let velocity = if met || still { 0.0 } else { way * p.stroke_units_s };
        state.actual = Setpoint { position, velocity };
        let pressing = match (still, met) {
            (true, _) => 0.0,
            (false, true) => torque,
            (false, false) => FREE_PRESSURE * torque,
        };
        self.stand(state, pressing);
        state.in_position = !still && (state.in_position || met);
    }

    /// An axis that turns begins at 0 again.
    fn wrap(&self, state: &mut State) {
        let modulo = self.p.modulo_units;
        if modulo <= 0.0 || state.mode == Mode::Position || (0.0..modulo).contains(&state.actual.position) {
            return;
        }
        let turns = (state.actual.position / modulo).floor() * modulo;
        state.actual.position -= turns;
        state.set.position -= turns;
    }
}
