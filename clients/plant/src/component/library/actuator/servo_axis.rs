//! A servo axis: profile generator, position and velocity loop, limits, homing.
//!
//! # Equations
//! - set motion: seven segments from rest to rest (`jerk_m_s3`), or a trapezoid if it is 0;
//! - `v_c = k_ff v_set + K_v (x_set - x)`: position loop, within ±1.2 of the greatest speed;
//! - `F = m (v_c - v) / T_v`, within `±F_max`: velocity loop;
//! - `m dv/dt = F - F_load - F_c sgn(v)`;
//! - following error `x_set - x`; without feed-forward `v / K_v` at constant velocity.
//!
//! # States
//! Off, standing, moving, jogging, homing, stopping, error. A move waits for rest: a new target during
//! a move is taken up by the next rising `execute`. Before homing the axis counts from where it was
//! switched on, and refuses targets if `needs_homing`.
//!
//! # Source
//! L. Biagiotti, C. Melchiorri, *Trajectory Planning*, Springer 2008, 3.4; PLCopen *Motion Control* 2.0 (states).
//!
//! # Method
//! Set motion exact; loops semi-implicit with sub-steps of at most 0.25 ms, first order.

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Conflict, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::{Resistance, Travel, ramp, substeps};
use crate::component::kind::Dependence;
use crate::component::profile::{Limits, Point, Profile};
use crate::coupling::{Coordinate, Slides};
use crate::effort::{Effort, Motion};

/// Longest sub-step.
const LONGEST_S: f64 = 0.25e-3;
/// Time constant of the velocity loop's integral part, in those of the loop itself.
const INTEGRAL_LOOPS: f64 = 5.0;
/// How far the position loop may go beyond the greatest speed.
const OVERSPEED: f64 = 1.2;

parameters! {
    /// An axis, its drive and its motor.
    Parameters {
        /// greatest speed
        speed_m_s: f64 = 0.5 => 1e-6, 1000.0;
        /// greatest acceleration
        acceleration_m_s2: f64 = 2.0 => 1e-6, 1e5;
        /// greatest jerk; 0 for a trapezoid of velocity
        jerk_m_s3: f64 = 20.0 => 0.0, 1e7;
        /// speed of homing
        homing_m_s: f64 = 0.05 => 1e-6, 100.0;
        /// where the reference switch is, below which it is on
        reference_m: f64 = 0.0 => -1000.0, 1000.0;
        /// targets are refused before homing
        needs_homing: bool = true;
        /// lower end of the way, a stop
        lower_m: f64 = -0.05 => -1000.0, 1000.0;
        /// upper end of the way, a stop
        upper_m: f64 = 1.0 => -1000.0, 1000.0;
        /// where it is at the set-up, unless a joint says so
        initial_m: f64 = 0.1 => -1000.0, 1000.0;
        /// gain of the position loop
        gain_1_s: f64 = 50.0 => 0.1, 10000.0;
        /// part of the set velocity that is fed forward
        feed_forward_ratio: f64 = 0.0 => 0.0, 1.0;
        /// time constant of the velocity loop
        velocity_loop_s: f64 = 0.003 => 0.0001, 1.0;
        /// all that moves; on a joint its bodies do, and the velocity loop is tuned to this or to what they are at the set-up, whichever is more
        moving_kg: f64 = 20.0 => 0.001, 1e6;
        /// greatest force of motor and drive
        force_max_n: f64 = 1000.0 => 0.001, 1e7;
        /// constant load against the way up
        load_n: f64 = 0.0 => -1e6, 1e6;
        /// dry friction
        friction_n: f64 = 5.0 => 0.0, 1e6;
        /// a greater following error is an error of the axis
        following_max_m: f64 = 0.02 => 1e-6, 100.0;
        /// in position within this of the target
        window_m: f64 = 0.0001 => 1e-9, 10.0;
    }
}

signals! {
    /// What the PLC asks for.
    Inputs {
        /// drive on
        enable: bool,
        /// rising: go to `target_m`
        execute: bool,
        /// where to
        target_m: f64,
        /// how fast; 0 or more than the greatest: the greatest
        speed_m_s: f64,
        /// rising: find the reference switch
        home: bool,
        /// moves up while it is on
        jog_forward: bool,
        /// moves down while it is on
        jog_reverse: bool,
        /// stops, while it is on
        halt: bool,
        /// rising: leave the error
        reset: bool,
    }
}

signals! {
    /// Feedback of the drive.
    Outputs {
        /// the drive holds the axis
        ready: bool,
        /// it moves because it was ordered to
        busy: bool,
        /// at the last target
        in_position: bool,
        /// the position is known
        homed: bool,
        /// an error has stopped it
        error: bool,
        /// measured position
        position_m: f64,
        /// measured velocity
        velocity_m_s: f64,
        /// set position less the measured one
        following_m: f64,
        /// force of the motor
        force_n: f64,
        /// reference switch
        reference: bool,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// the drive reports an error and lets go
        DriveFault = "drive_fault",
        /// the encoder stands still
        EncoderFrozen = "encoder_frozen",
        /// the axis cannot move
        Blocked = "blocked",
        /// the reference switch stays off
        ReferenceDead = "reference_dead",
    }
}

/// What the axis is doing.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Doing {
    Off,
    Standing,
    Moving {
        profile: Profile,
        start_m: f64,
        since_s: f64,
    },
    /// At a velocity: jogging, homing; 0 to stop.
    Velocity {
        wanted_m_s: f64,
        homing: bool,
    },
    Error,
}

/// Ramps down to rest, and stands then.
const STOPPING: Doing = Doing::Velocity { wanted_m_s: 0.0, homing: false };

/// True if one way of jogging is asked for; both at once ask for none.
fn jogs(inputs: &Inputs) -> bool {
    inputs.jog_forward != inputs.jog_reverse
}

/// What it remembers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    doing: Doing,
    /// Where the drive wants the axis.
    set: Point,
    /// Where the axis is.
    axis: Travel,
    /// Integral part of the velocity loop.
    integral_n: f64,
    /// Mass that the velocity loop is tuned to on a joint.
    tuned_kg: Option<f64>,
    /// What the drive knows of where the axis is.
    encoder_m: f64,
    /// Coordinate that the drive calls 0.
    zero_m: f64,
    homed: bool,
    force_n: f64,
    target_m: Option<f64>,
    /// `execute`, `home` and `reset` of the last period.
    before: [bool; 3],
}

impl State {
    /// Whether the drive holds the axis.
    const fn held(&self) -> bool {
        !matches!(self.doing, Doing::Off | Doing::Error)
    }
}

/// An axis by its parameters.
pub(crate) struct ServoAxis {
    p: Parameters,
    longest_s: f64,
}

impl ServoAxis {
    fn limits(&self, asked_m_s: f64) -> Limits {
        let speed = if asked_m_s > 0.0 { asked_m_s.min(self.p.speed_m_s) } else { self.p.speed_m_s };
        let jerk = (self.p.jerk_m_s3 > 0.0).then_some(self.p.jerk_m_s3);
        Limits { speed, acceleration: self.p.acceleration_m_s2, jerk }
    }

    /// What the inputs make of what it is doing.
    ///
    /// Commands act on their rising edges, so that a held input starts nothing twice. Trips come before
    /// all commands: a fault of the drive, or a set point that has left the encoder too far behind
    /// while the drive holds the axis.
    fn decide(&self, state: &mut State, inputs: &Inputs, turn: &Turn<Option<Coordinate>>) {
        let now = [inputs.execute, inputs.home, inputs.reset];
        let [execute, home, reset] = [0, 1, 2].map(|i| now[i] && !state.before[i]);
        state.before = now;
        let faulty = turn.failed.has(Failure::DriveFault);
        let following = (state.set.way - state.encoder_m).abs() > self.p.following_max_m;
        let held = !matches!(state.doing, Doing::Off | Doing::Error);
        if faulty || (held && following) {
            state.doing = Doing::Error;
        }
        state.doing = match state.doing {
            // an error stays until it is reset, enabled or not, and no reset ends a fault that lasts
            Doing::Error if reset && !faulty => Doing::Off,
            Doing::Error => Doing::Error,
            // without `enable` whatever it does ends at once, and every command is lost
            _ if !inputs.enable => Doing::Off,
            // enabling takes a period of its own: the set point starts from the encoder at rest
            Doing::Off => Doing::Standing,
            Doing::Standing => self.leave_rest(state, inputs, [execute, home]),
            Doing::Velocity { homing: true, .. } => self.home(state, inputs, turn),
            Doing::Moving { .. } if inputs.halt => STOPPING,
            // a move goes on to its target: a new `execute` waits for rest
            moving @ Doing::Moving { .. } => moving,
            Doing::Velocity { homing: false, .. } if jogs(inputs) && !inputs.halt => self.jog(inputs),
            Doing::Velocity { homing: false, .. } => STOPPING,
        };
    }

    /// What starts at rest: of commands in one period a move comes before homing, homing before a jog.
    fn leave_rest(&self, state: &mut State, inputs: &Inputs, [execute, home]: [bool; 2]) -> Doing {
        if execute {
            self.start(state, inputs)
        } else if home {
            Doing::Velocity { wanted_m_s: -self.p.homing_m_s, homing: true }
        } else if jogs(inputs) {
            self.jog(inputs)
        } else {
            Doing::Standing
        }
    }

    /// Homing goes on to the reference switch. The switch comes before `halt`: an axis that reaches it
    /// in the period of the halt is homed, and stops all the same.
    fn home(&self, state: &mut State, inputs: &Inputs, turn: &Turn<Option<Coordinate>>) -> Doing {
        if self.reference(state, turn) {
            (state.homed, state.zero_m) = (true, self.p.reference_m);
            return STOPPING;
        }
        if inputs.halt { STOPPING } else { state.doing }
    }

    fn start(&self, state: &mut State, inputs: &Inputs) -> Doing {
        let target_m = inputs.target_m + state.zero_m;
        let inside = (self.p.lower_m..=self.p.upper_m).contains(&target_m);
        if !inside || (self.p.needs_homing && !state.homed) {
            return Doing::Error;
        }
        state.target_m = Some(target_m);
        let start_m = state.set.way;
        let profile = Profile::plan(target_m - start_m, &self.limits(inputs.speed_m_s));
        Doing::Moving { profile, start_m, since_s: 0.0 }
    }

    fn jog(&self, inputs: &Inputs) -> Doing {
        let speed = self.limits(inputs.speed_m_s).speed;
        Doing::Velocity { wanted_m_s: if inputs.jog_forward { speed } else { -speed }, homing: false }
    }

    /// Moves the set point by a sub-step.
    fn set(&self, state: &mut State, dt_s: f64) {
        match &mut state.doing {
            Doing::Moving { profile, start_m, since_s } => {
                *since_s += dt_s;
                let Point { way, velocity } = profile.at(*since_s);
                state.set = Point { way: *start_m + way, velocity };
                if *since_s >= profile.duration_s() {
                    state.doing = Doing::Standing;
                }
            }
            Doing::Velocity { wanted_m_s, homing } => {
                let velocity = ramp(state.set.velocity, *wanted_m_s, self.p.acceleration_m_s2, dt_s);
                state.set = Point { way: state.set.way + 0.5 * (state.set.velocity + velocity) * dt_s, velocity };
                if velocity == 0.0 && *wanted_m_s == 0.0 && !*homing {
                    state.doing = Doing::Standing;
                }
            }
            Doing::Standing => state.set.velocity = 0.0,
            Doing::Off | Doing::Error => state.set = Point { way: state.encoder_m, velocity: 0.0 },
        }
    }

    /// The velocity that the position loop asks for.
    fn asked(&self, state: &State) -> f64 {
        let p = &self.p;
        let most = OVERSPEED * p.speed_m_s;
        let wanted = p.feed_forward_ratio * state.set.velocity + p.gain_1_s * (state.set.way - state.encoder_m);
        wanted.clamp(-most, most)
    }

    fn substep(&self, state: &mut State, turn: &Turn<Option<Coordinate>>, dt_s: f64) {
        let p = &self.p;
        // without the drive a brake takes hold, as strong as the motor
        let asked = if state.held() { self.asked(state) } else { 0.0 };
        let loop_s = p.velocity_loop_s.max(dt_s);
        let hold_n = p.moving_kg * (asked - state.axis.velocity) / loop_s + p.load_n;
        state.force_n = hold_n.clamp(-p.force_max_n, p.force_max_n);
        if turn.failed.has(Failure::Blocked) {
            state.axis.velocity = 0.0;
        } else {
            let resistance =
                Resistance { mass: p.moving_kg, dry: p.friction_n, viscous: 0.0, range: (p.lower_m, p.upper_m) };
            state.axis.push(state.force_n - p.load_n, &resistance, dt_s);
        }
        if !turn.failed.has(Failure::EncoderFrozen) {
            state.encoder_m = state.axis.position;
        }
        self.set(state, dt_s);
    }

    fn reference(&self, state: &State, turn: &Turn<Option<Coordinate>>) -> bool {
        state.axis.position <= self.p.reference_m && !turn.failed.has(Failure::ReferenceDead)
    }
}

impl Component for ServoAxis {
    const NAME: &'static str = "servo_axis";
    const SUMMARY: &'static str = "servo axis: jerk-limited or trapezoidal moves, loops, limits, homing";
    const FORMULA: &'static [&'static str] = &[
        "set motion in seven segments of constant jerk, or three of constant acceleration",
        "v_c = k_ff v_set + K_v (x_set - x)",
        "m dv/dt = F - F_load - F_c sgn(v), F = m (v_c - v)/T_v within ±F_max",
        "following error v/K_v at constant velocity without feed-forward",
    ];
    const SOURCE: &'static str =
        "L. Biagiotti, C. Melchiorri, Trajectory Planning, 2008, 3.4; PLCopen Motion Control 2.0 (states)";
    const DEPENDENCES: &'static [Dependence] =
        &[Dependence { inputs: &["execute", "home", "jog_forward", "jog_reverse"], on: &["enable"] }];
    const INITIAL: &'static [&'static str] = &["initial_m"];
    own_types!(sees Slides);

    fn new(p: Parameters) -> Self {
        Self { p, longest_s: LONGEST_S }
    }

    fn conflict(p: &Parameters) -> Option<Conflict> {
        if p.upper_m <= p.lower_m {
            return Some(Conflict { key: "upper_m", wanted: "a number above `lower_m`" });
        }
        let inside = |way_m: f64| (p.lower_m..=p.upper_m).contains(&way_m);
        if !inside(p.initial_m) {
            return Some(Conflict { key: "initial_m", wanted: "a number from `lower_m` to `upper_m`" });
        }
        (!inside(p.reference_m))
            .then_some(Conflict { key: "reference_m", wanted: "a number from `lower_m` to `upper_m`" })
    }

    fn initial(&self, start: &Start<Option<Coordinate>>) -> State {
        let position = start.seen.map_or(self.p.initial_m, |joint| joint.position);
        State {
            doing: Doing::Off,
            set: Point { way: position, velocity: 0.0 },
            axis: Travel { position, velocity: 0.0 },
            integral_n: 0.0,
            tuned_kg: None,
            encoder_m: position,
            zero_m: position,
            homed: false,
            force_n: 0.0,
            target_m: None,
            before: [false; 3],
        }
    }

    fn drive(&self, state: &mut State, inputs: &Inputs, turn: &Turn<Option<Coordinate>>) {
        self.decide(state, inputs, turn);
        if turn.seen.is_some() {
            return;
        }
        let (count, dt_s) = substeps(turn.dt_s, self.longest_s);
        for _ in 0..count {
            self.substep(state, turn, dt_s);
        }
    }

    fn longest_s(&self) -> f64 {
        self.longest_s
    }

    fn stops(&self) -> Option<[f64; 2]> {
        Some([self.p.lower_m, self.p.upper_m])
    }

    fn advance(
        &self,
        state: &mut State,
        _: &Inputs,
        turn: &Turn<Option<Coordinate>>,
        motion: Motion,
        dt_s: f64,
    ) -> Effort {
        let p = &self.p;
        let Motion { position, velocity, mass, exerted } = motion;
        state.axis = Travel { position, velocity };
        state.force_n = exerted;
        if !turn.failed.has(Failure::EncoderFrozen) {
            state.encoder_m = position;
        }
        if turn.failed.has(Failure::Blocked) {
            self.set(state, dt_s);
            return Effort::BLOCKED;
        }
        if !state.held() {
            state.integral_n = 0.0;
            self.set(state, dt_s);
            // the brake takes hold, as strong as the motor
            return Effort { dry: p.friction_n + p.force_max_n, ..Effort::of(-p.load_n) };
        }
        // while the engine moves it, the mass is not known
        let seen_kg = if mass.is_finite() { mass } else { p.moving_kg };
        let tuned_kg = *state.tuned_kg.get_or_insert(seen_kg.max(p.moving_kg));
        let gain = tuned_kg / p.velocity_loop_s.max(dt_s);
        let off = self.asked(state) - velocity;
        // at its greatest force the integral waits
        if (gain * off + state.integral_n).abs() < p.force_max_n {
            state.integral_n += gain * off * dt_s / (INTEGRAL_LOOPS * p.velocity_loop_s.max(dt_s));
        }
        self.set(state, dt_s);
        let force = gain * off + state.integral_n;
        Effort { slope: gain, most: p.force_max_n, dry: p.friction_n, ..Effort::of(force) }
    }

    fn sense(&self, state: &mut State, _: &Inputs, turn: &Turn<Option<Coordinate>>) -> Outputs {
        let near = state.target_m.is_some_and(|target| (target - state.encoder_m).abs() <= self.p.window_m);
        Outputs {
            ready: !matches!(state.doing, Doing::Off | Doing::Error),
            busy: matches!(state.doing, Doing::Moving { .. } | Doing::Velocity { .. }),
            in_position: near && state.doing == Doing::Standing,
            homed: state.homed,
            error: state.doing == Doing::Error,
            position_m: state.encoder_m - state.zero_m,
            velocity_m_s: state.axis.velocity,
            following_m: state.set.way - state.encoder_m,
            force_n: state.force_n,
            reference: self.reference(state, turn),
        }
    }
}

#[cfg(test)]
#[path = "servo_axis_tests.rs"]
mod tests;
