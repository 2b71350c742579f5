//! A rack feeder: a storage and retrieval machine with travel, lift and a fork to both sides.
//!
//! # Equations
//! - on a rising `execute` travel and lift go to column and row at once, each by a trapezoid of velocity: it takes the
//!   longer of `d/v + v/a`, or `2 √(d/a)` where the speed is not reached;
//! - the fork goes out to a side, and back, while both stand: by a trapezoid, too;
//! - a following error above `following_max_m` stops all axes, as do a target outside of the rack and an `execute` with
//!   the fork out; a rising `quit` acknowledges it.
//!
//! # Source
//! FEM 9.851:2003 (cycle times of storage and retrieval machines); L. Biagiotti, C. Melchiorri, *Trajectory Planning*,
//! Springer 2008, 3.2 (trapezoid).

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::{is_over, rising};
use crate::component::profile::{Limits, Profile};
use crate::coupling::{Carried, Follow, Stores};
use crate::setpoint::Setpoint;

parameters! {
    /// A rack and its machine.
    Parameters {
        /// columns of the rack
        columns: u32 = 20 => 1.0, 10000.0;
        /// rows of the rack
        rows: u32 = 8 => 1.0, 1000.0;
        /// where the first column is, on the way of the travel
        first_column_m: f64 = 0.0 => -1000.0, 1000.0;
        /// from one column to the next
        column_m: f64 = 0.5 => 0.001, 100.0;
        /// where the first row is, on the way of the lift
        first_row_m: f64 = 0.0 => -1000.0, 1000.0;
        /// from one row to the next
        row_m: f64 = 0.4 => 0.001, 100.0;
        /// speed of the travel
        travel_m_s: f64 = 2.0 => 1e-6, 100.0;
        /// acceleration of the travel
        travel_m_s2: f64 = 0.5 => 1e-6, 1000.0;
        /// speed of the lift
        lift_m_s: f64 = 0.8 => 1e-6, 100.0;
        /// acceleration of the lift
        lift_m_s2: f64 = 0.8 => 1e-6, 1000.0;
        /// way of the fork to either side
        fork_stroke_m: f64 = 1.2 => 0.001, 100.0;
        /// speed of the fork
        fork_m_s: f64 = 0.6 => 1e-6, 100.0;
        /// acceleration of the fork
        fork_m_s2: f64 = 1.0 => 1e-6, 1000.0;
        /// greatest force of each axis on its joint
        force_n: f64 = 50000.0 => 0.1, 1e8;
        /// in position within this
        window_m: f64 = 0.002 => 1e-9, 1.0;
        /// a greater following error is an error of the machine
        following_max_m: f64 = 0.05 => 1e-6, 100.0;
    }
}

signals! {
    /// What the PLC asks for.
    Inputs {
        /// column, from 0
        target_x: i32,
        /// row, from 0
        target_y: i32,
        /// rising: to column and row
        execute: bool,
        /// the fork goes out to the left, up its coordinate
        fork_left: bool,
        /// the fork goes out to the right; to the middle with both or none
        fork_right: bool,
        /// rising: acknowledges an error
        quit: bool,
    }
}

signals! {
    /// Feedback of the machine.
    Outputs {
        /// at the last target
        in_position: bool,
        /// an axis moves because it was ordered to
        busy: bool,
        /// an error has stopped it
        error: bool,
        /// the fork is in the middle
        fork_centred: bool,
        /// the fork is out to the left
        fork_left_out: bool,
        /// the fork is out to the right
        fork_right_out: bool,
        /// measured way of the travel
        x_m: f64,
        /// measured way of the lift
        y_m: f64,
        /// measured way of the fork
        fork_m: f64,
    }
}

failures! {
    /// What holds an axis, or hides where it is.
    Failure {
        /// the travel cannot move
        TravelBlocked = "travel_blocked",
        /// the fork cannot move
        ForkStuck = "fork_stuck",
        /// the encoder of the travel is lost: an error as long as it lasts
        PositionLost = "position_lost",
    }
}

/// The axes, in the order of their joints.
const TRAVEL: usize = 0;
const LIFT: usize = 1;
const FORK: usize = 2;

/// A motion that goes on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Run {
    profile: Profile,
    start_m: f64,
    since_s: f64,
}

/// One axis: what it was ordered, and its way in the period that begins, m.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Axis {
    /// Where the machine wants it.
    set: Setpoint,
    /// From where to where it goes in the period that begins.
    path: [Setpoint; 2],
    run: Option<Run>,
}

impl Axis {
    fn at(position: f64) -> Self {
        let set = Setpoint { position, velocity: 0.0 };
        Self { set, path: [set; 2], run: None }
    }

    fn go(&mut self, to_m: f64, limits: &Limits) {
        let start_m = self.set.position;
        if to_m != start_m {
            self.run = Some(Run { profile: Profile::plan(to_m - start_m, limits), start_m, since_s: 0.0 });
        }
    }

    /// Moves the set point by a period; one that is blocked stays where it really is.
    fn advance(&mut self, blocked_m: Option<f64>, dt_s: f64) {
        let before = self.set;
        if let Some(run) = &mut self.run {
            run.since_s += dt_s;
            let point = run.profile.at(run.since_s);
            self.set = Setpoint { position: run.start_m + point.way, velocity: point.velocity };
            if is_over(run.since_s, run.profile.duration_s()) {
                let end_m = run.start_m + run.profile.at(f64::INFINITY).way;
                (self.set, self.run) = (Setpoint { position: end_m, velocity: 0.0 }, None);
            }
        }
        let stays = |position: f64| [Setpoint { position, velocity: 0.0 }; 2];
        self.path = blocked_m.map_or([before, self.set], stays);
    }
}

/// Axes, the order and its target in m, and an error, which stands until `quit`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    axes: [Axis; 3],
    /// Where the axes are.
    real_m: [f64; 3],
    target_m: Option<[f64; 2]>,
    error: bool,
    /// `execute` and `quit` of the last period.
    before: [bool; 2],
}

impl State {
    /// Whether travel and lift have ended what they were ordered to.
    fn stands(&self) -> bool {
        [TRAVEL, LIFT].iter().all(|axis| self.axes[*axis].run.is_none())
    }
}

/// A rack feeder, by its parameters.
pub(crate) struct RackFeeder {
    p: Parameters,
    limits: [Limits; 3],
}

impl RackFeeder {
    /// Where a column and a row are; nowhere outside of the rack.
    fn place_m(&self, inputs: &Inputs) -> Option<[f64; 2]> {
        let p = &self.p;
        let inside = |index: i32, count: u32| u32::try_from(index).ok().filter(|index| *index < count).map(f64::from);
        let [column, row] = [inside(inputs.target_x, p.columns)?, inside(inputs.target_y, p.rows)?];
        Some([p.first_column_m + column * p.column_m, p.first_row_m + row * p.row_m])
    }

    fn fork_is_at(&self, state: &State, place_m: f64) -> bool {
        state.axes[FORK].run.is_none() && (state.real_m[FORK] - place_m).abs() <= self.p.window_m
    }

    /// What the inputs make of what it is doing. Errors come before all commands.
    fn decide(&self, state: &mut State, inputs: &Inputs, lost: bool) {
        let [execute, quit] = rising(&mut state.before, [inputs.execute, inputs.quit]);
        state.error &= !quit;
        let off_m = |axis: usize| (state.axes[axis].set.position - state.real_m[axis]).abs();
        let behind = [TRAVEL, LIFT, FORK].into_iter().any(|axis| off_m(axis) > self.p.following_max_m);
        let stands = state.stands();
        if execute && !state.error && stands {
            state.target_m = self.place_m(inputs).filter(|_| self.fork_is_at(state, 0.0));
            state.error = state.target_m.is_none();
        }
        if lost || behind || state.error {
            (state.error, state.axes) = (true, state.real_m.map(Axis::at));
            return;
        }
        if let Some(place_m) = state.target_m.filter(|_| execute && stands) {
            for axis in [TRAVEL, LIFT] {
                state.axes[axis].go(place_m[axis], &self.limits[axis]);
            }
            return;
        }
        let side = f64::from(i8::from(inputs.fork_left) - i8::from(inputs.fork_right));
        if stands && state.axes[FORK].run.is_none() {
            state.axes[FORK].go(side * self.p.fork_stroke_m, &self.limits[FORK]);
        }
    }
}

impl Component for RackFeeder {
    const NAME: &'static str = "rack_feeder";
    const SUMMARY: &'static str = "rack feeder: travel, lift and fork of a storage and retrieval machine";
    const FORMULA: &'static [&'static str] = &[
        "t = d/v + v/a, or 2 √(d/a) below d = v²/a, of the slower of travel and lift",
        "the fork moves while both stand",
    ];
    const SOURCE: &'static str = "FEM 9.851:2003; Biagiotti, Melchiorri, Trajectory Planning, 2008, 3.2";
    own_types!(moves Stores);

    fn new(p: Parameters) -> Self {
        let axes = [(p.travel_m_s, p.travel_m_s2), (p.lift_m_s, p.lift_m_s2), (p.fork_m_s, p.fork_m_s2)];
        let limits = axes.map(|(speed, acceleration)| Limits { speed, acceleration, jerk: None });
        Self { p, limits }
    }

    fn initial(&self, start: &Start<Option<[Carried; 3]>>) -> State {
        let real_m = start.seen.map_or([0.0; 3], |joints| joints.map(|joint| joint.position));
        State { axes: real_m.map(Axis::at), real_m, ..State::default() }
    }

    fn drive(&self, state: &mut State, inputs: &Inputs, turn: &Turn<Option<[Carried; 3]>>) {
        if let Some(joints) = turn.seen {
            state.real_m = joints.map(|joint| joint.position);
        }
        self.decide(state, inputs, turn.failed.has(Failure::PositionLost));
        let mut blocked = [false; 3];
        blocked[TRAVEL] = turn.failed.has(Failure::TravelBlocked);
        blocked[FORK] = turn.failed.has(Failure::ForkStuck);
        for (axis, blocked) in blocked.into_iter().enumerate() {
            let real_m = state.real_m[axis];
            state.axes[axis].advance(blocked.then_some(real_m), turn.dt_s);
            state.real_m[axis] = state.axes[axis].path[1].position;
        }
    }

    fn effect(&self, state: &State) -> [Follow; 3] {
        state.axes.map(|Axis { path: [from, to], .. }| Follow { from, to, effort_max: self.p.force_n })
    }

    fn sense(&self, state: &mut State, _: &Inputs, turn: &Turn<Option<[Carried; 3]>>) -> Outputs {
        if let Some(joints) = turn.seen {
            state.real_m = joints.map(|joint| joint.position);
        }
        let [x_m, y_m, fork_m] = state.real_m;
        let busy = state.axes.iter().any(|axis| axis.run.is_some());
        let near = |[column_m, row_m]: [f64; 2]| {
            (x_m - column_m).abs() <= self.p.window_m && (y_m - row_m).abs() <= self.p.window_m
        };
        Outputs {
            in_position: state.stands() && !state.error && state.target_m.is_some_and(near),
            busy,
            error: state.error,
            fork_centred: self.fork_is_at(state, 0.0),
            fork_left_out: self.fork_is_at(state, self.p.fork_stroke_m),
            fork_right_out: self.fork_is_at(state, -self.p.fork_stroke_m),
            x_m,
            y_m,
            fork_m,
        }
    }
}

#[cfg(test)]
#[path = "rack_feeder_tests.rs"]
mod tests;
