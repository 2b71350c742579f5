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

use crate::plant::component::behaviour::{Component, Conflict, Start, Turn};
use crate::plant::component::declare::{failures, own_types, parameters, signals};
use crate::plant::component::dynamics::{Resistance, Travel, ramp, substeps};
use crate::plant::component::kind::Dependence;
use crate::plant::component::profile::{Limits, Point, Profile};
use crate::plant::coupling::{Coordinate, Move, Slides};

/// Longest sub-step.
const LONGEST_S: f64 = 0.25e-3;
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
        /// all that moves
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
        /// it moves because it was told to
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
    Moving { profile: Profile, start_m: f64, since_s: f64 },
    /// At a velocity: jogging, homing; 0 to stop.
    Velocity { wanted_m_s: f64, homing: bool },
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
    /// Where the axis was as the period began.
    from_m: f64,
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

    fn substep(&self, state: &mut State, turn: &Turn<Option<Coordinate>>, dt_s: f64) {
        let p = &self.p;
        let held = !matches!(state.doing, Doing::Off | Doing::Error);
        let most = OVERSPEED * p.speed_m_s;
        let wanted = p.feed_forward_ratio * state.set.velocity + p.gain_1_s * (state.set.way - state.encoder_m);
        let velocity = wanted.clamp(-most, most);
        // without the drive a brake takes hold, as strong as the motor
        let asked = if held { velocity } else { 0.0 };
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
    own_types!(moves Slides);

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
        (!inside(p.reference_m)).then_some(Conflict { key: "reference_m", wanted: "a number from `lower_m` to `upper_m`" })
    }

    fn initial(&self, start: &Start<Option<Coordinate>>) -> State {
        let position = start.seen.map_or(self.p.initial_m, |joint| joint.position);
        State {
            doing: Doing::Off,
            set: Point { way: position, velocity: 0.0 },
            axis: Travel { position, velocity: 0.0 },
            from_m: position,
            encoder_m: position,
            zero_m: position,
            homed: false,
            force_n: 0.0,
            target_m: None,
            before: [false; 3],
        }
    }

    fn drive(&self, state: &mut State, inputs: &Inputs, turn: &Turn<Option<Coordinate>>) {
        state.axis.yield_to(turn.seen, state.axis.velocity.abs() * turn.dt_s + 1e-4);
        state.from_m = state.axis.position;
        self.decide(state, inputs, turn);
        let (count, dt_s) = substeps(turn.dt_s, self.longest_s);
        for _ in 0..count {
            self.substep(state, turn, dt_s);
        }
    }

    fn effect(&self, state: &State) -> Move {
        Move { from: state.from_m, to: state.axis.position, effort_max: self.p.force_max_n }
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
mod tests {
    use super::*;
    use crate::plant::component::tests::Rig;

    const ON: Inputs = Inputs {
        enable: true,
        execute: false,
        target_m: 0.0,
        speed_m_s: 0.0,
        home: false,
        jog_forward: false,
        jog_reverse: false,
        halt: false,
        reset: false,
    };

    fn go(target_m: f64) -> Inputs {
        Inputs { execute: true, target_m, ..ON }
    }

    fn free() -> Parameters {
        Parameters { friction_n: 0.0, needs_homing: false, initial_m: 0.0, ..Parameters::default() }
    }

    /// An axis that is switched on.
    fn rig(p: Parameters) -> Rig<ServoAxis> {
        let mut rig = Rig::new(ServoAxis::new(p));
        rig.run(ON, 0.01, 2);
        rig
    }

    #[test]
    fn the_following_error_is_speed_over_gain() {
        for jerk_m_s3 in [0.0, 20.0] {
            let mut rig = rig(Parameters { jerk_m_s3, ..free() });
            let out = rig.run(go(0.9), 0.001, 1000);
            // 0.5 m/s by 50 1/s; the loops have settled to rounding of positions near 1
            assert!((out.following_m - 0.01).abs() < 1e-9 && out.busy, "{out:?}");
            assert!((out.velocity_m_s - 0.5).abs() < 1e-9);
        }
        let mut fed = rig(Parameters { feed_forward_ratio: 1.0, ..free() });
        assert!(fed.run(go(0.9), 0.001, 1000).following_m.abs() < 1e-9, "nothing is left to the loop");
    }

    #[test]
    fn a_move_ends_in_its_time_at_its_target() {
        let mut rig = rig(free());
        // 0.8/0.5 + 0.5/2 + 2/20 = 1.95 s of set motion
        assert!(rig.run(go(0.8), 0.01, 194).busy);
        assert!(!rig.run(go(0.8), 0.01, 2).busy);
        let out = rig.run(go(0.8), 0.01, 30);
        assert!(out.in_position && (out.position_m - 0.8).abs() < 1e-6, "{out:?}");
    }

    #[test]
    fn halving_the_step_halves_the_error() {
        let reached = |longest_s: f64| {
            let mut rig = Rig::new(ServoAxis::new(free()));
            rig.component.longest_s = longest_s;
            rig.run(ON, 0.01, 2);
            rig.run(go(0.9), 0.01, 20).position_m
        };
        let finest = reached(1e-6);
        let errors: Vec<_> = [0.4e-3, 0.2e-3, 0.1e-3].iter().map(|h| (reached(*h) - finest).abs()).collect();
        for pair in errors.windows(2) {
            assert!((pair[0] / pair[1] - 2.0).abs() < 0.3, "{errors:?}");
        }
    }

    #[test]
    fn homing_finds_the_switch_and_makes_it_zero() {
        let p = Parameters { reference_m: 0.02, initial_m: 0.3, ..Parameters::default() };
        let mut rig = rig(p);
        assert!(rig.run(go(0.1), 0.01, 2).error, "no target before homing");
        rig.run(Inputs { reset: true, ..ON }, 0.01, 3);
        let out = rig.run(Inputs { home: true, ..ON }, 0.01, 800);
        assert!(out.homed && !out.busy && !out.error, "{out:?}");
        let out = rig.run(go(0.25), 0.01, 300);
        assert!(out.in_position && (rig.state.axis.position - 0.27).abs() < 1e-4, "{out:?} {:?}", rig.state.axis);
    }

    #[test]
    fn jogging_and_halting() {
        let mut rig = rig(free());
        let jog = Inputs { jog_forward: true, speed_m_s: 0.1, ..ON };
        assert!((rig.run(jog, 0.01, 100).velocity_m_s - 0.1).abs() < 1e-6);
        let out = rig.run(ON, 0.01, 100);
        assert!(!out.busy && out.velocity_m_s.abs() < 1e-9);
        rig.run(go(0.9), 0.01, 40);
        let out = rig.run(Inputs { halt: true, ..go(0.9) }, 0.01, 100);
        assert!(!out.busy && !out.in_position && out.velocity_m_s.abs() < 1e-9, "{out:?}");
    }

    #[test]
    fn a_load_beyond_the_force_is_a_following_error() {
        let mut rig = rig(Parameters { force_max_n: 30.0, acceleration_m_s2: 10.0, ..free() });
        assert!(rig.run(go(0.9), 0.01, 100).error);
    }

    #[test]
    fn targets_beyond_the_ends_are_refused() {
        assert!(rig(free()).run(go(1.5), 0.01, 2).error);
    }

    #[test]
    fn each_failure_has_its_effect() {
        let after = |mode: Failure| rig(free()).failing(mode).run(go(0.5), 0.01, 100);
        assert!(after(Failure::DriveFault).error);
        assert!(after(Failure::Blocked).error, "it does not follow");
        assert!(after(Failure::EncoderFrozen).error, "it seems not to follow");
        let mut blind = rig(Parameters { initial_m: 0.1, ..free() }).failing(Failure::ReferenceDead);
        let out = blind.run(Inputs { home: true, ..ON }, 0.01, 1000);
        assert!(out.error && !out.homed, "it runs into the stop: {out:?}");
    }
}
