//! Steps of a mechanism with drives, friction and stops.
//!
//! # Method
//! The step is cut in parts of at most [`PART_S`]. In each, mass matrix and bias are taken at half way;
//! over such a part they change little. Each part is cut again, as short as the drives' own equations
//! want it: in such a sub-step every drive moves its state with its joint and says what it exerts, and
//! velocities follow from momentum with all rows within their bounds ([`super::rows`]). So a stiff drive
//! meets the real mass of its joint, and a stop or a friction holds exactly.

use nalgebra::DVectorViewMut;

use super::closure::Closed;
use super::dynamics::{normalise, rates};
use super::rows::Row;
use super::{Coordinates, Mechanism, Room, Surroundings};
use crate::effort::Motion;
use crate::effort::substeps;
use crate::fitting::Fitting;
use crate::world::actuator::{Acts, Actuator, CORRECTED_A_TURN};

/// Longest part of a step with one mass matrix, s.
const PART_S: f64 = 1e-3;
/// The most that anything turns in a part, rad, and the most parts that each of the longest is cut in for that.
const PART_RAD: f64 = 0.02;
const PARTS: f64 = 64.0;
/// In a part, a loop that a drive leads goes no farther than this, m or rad.
const FAR: f64 = 0.5;
/// Parts are cut so often, by halves, where a step gains energy.
const FINER: f64 = 64.0;
/// Viscous friction that takes less than this part of a velocity in a sub-step is taken as a force.
const EXPLICIT_MAX: f64 = 0.05;
/// A stop is looked at from this near on, m or rad.
const NEAR: f64 = 1e-6;

impl Mechanism {
    /// Moves by a step; false, and unmoved, if its equations cannot be solved.
    pub(super) fn step_driven(&mut self, dt_s: f64, around: &mut Surroundings<'_>) -> bool {
        let n = self.tree.velocities;
        if n == 0 {
            return true;
        }
        let own: Vec<(usize, usize)> = self.own_actuators(around.actuators);
        self.find_springs(around.fittings);
        self.room.driven.clear();
        self.room.driven.resize(n, false);
        for (axis, actuator) in &own {
            self.room.driven[*axis] = true;
            around.actuators[*actuator].impulse = 0.0;
        }
        let longest = own.iter().map(|(_, actuator)| match around.actuators[*actuator].acts {
            Acts::Law { drive } => around.drives.longest_s(drive),
            Acts::Along(_) => PART_S,
        });
        let longest_s = longest.fold(PART_S, f64::min);
        let before = if own.is_empty() { self.energy(around) } else { None };
        self.room.start.clone_from(&self.now);
        let mut cut = self.longest_part_s();
        let mut moved = self.parts(dt_s, [cut, longest_s], &own, around);
        let finest_s = cut / FINER;
        while moved && cut > finest_s && self.has_gained(before, dt_s, around) {
            self.now.clone_from(&self.room.start);
            cut *= 0.5;
            moved = self.parts(dt_s, [cut, longest_s], &own, around);
        }
        for (_, actuator) in &own {
            let actuator = &mut around.actuators[*actuator];
            actuator.effort = actuator.impulse / dt_s;
        }
        moved
    }

    /// Moves by a step, in parts and sub-steps that are no longer than these; false if its equations cannot be solved.
    fn parts(
        &mut self,
        dt_s: f64,
        [longest_part_s, longest_s]: [f64; 2],
        own: &[(usize, usize)],
        around: &mut Surroundings<'_>,
    ) -> bool {
        let (count, part_s) = substeps(dt_s, longest_part_s);
        let (finer, finer_s) = substeps(part_s, longest_s);
        let led = led(own, around.actuators);
        for index in 0..count {
            let before = if self.has_loops() && !led.is_empty() { Some(self.now.q.clone()) } else { None };
            if !self.prepare(part_s, around) {
                return false;
            }
            self.foresee(part_s, around);
            for inner in 0..finer {
                let whole = f64::from(count * finer);
                let [from, to] = around.part;
                let at = |step: u32| from + (to - from) * f64::from(step) / whole;
                let step = index * finer + inner;
                self.substep(finer_s, [at(step), at(step + 1)], own, around);
            }
            let held = self.held(&led, around.fittings);
            if let Some(before) = &before {
                self.begin_near(before, &held);
            }
            match self.close(around.gravity, &held) {
                Closed::Shut => {}
                Closed::Forced => self.jam(before, &led, own, around),
                Closed::Unsolved => return false,
            }
        }
        true
    }

    /// Its axes that have actuators, and these.
    pub(super) fn own_actuators(&self, actuators: &[Actuator]) -> Vec<(usize, usize)> {
        let axis = |joint: usize| self.axes.iter().position(|(_, own)| *own == Some(joint));
        let each = actuators.iter().enumerate();
        each.filter_map(|(index, actuator)| axis(actuator.joint).map(|axis| (axis, index))).collect()
    }

    /// Lets all but what is held begin where it was before a part, for its loops to be closed from there, if it went so far
    /// as a loop has it do that is driven away from a dead centre.
    fn begin_near(&mut self, before: &[f64], held: &[usize]) {
        let far = self.axes.iter().any(|(position, _)| (self.now.q[*position] - before[*position]).abs() > FAR);
        if far {
            let kept: Vec<_> = held.iter().map(|axis| (self.axes[*axis].0, self.now.q[self.axes[*axis].0])).collect();
            self.now.q.copy_from_slice(before);
            for (position, q) in kept {
                self.now.q[position] = q;
            }
        }
    }

    /// The axes that stay as loops are closed: those that are led, and those at their stops, else closing takes them over
    /// these again and again, and lifts what hangs on the loop.
    pub(super) fn held(&self, led: &[usize], fittings: &[Fitting]) -> Vec<usize> {
        let stopped = |axis: &usize| {
            let (position, joint) = self.axes[*axis];
            joint.is_some_and(|joint| fittings[joint].stops(self.now.q[position]))
        };
        if !self.has_loops() {
            return Vec::new();
        }
        let others = (0..self.axes.len()).filter(|axis| !led.contains(axis) && stopped(axis));
        led.iter().copied().chain(others).collect()
    }

    /// Stops it where it was before a part of a step in which a drive that nothing is too much for would have pushed its
    /// loops beyond a dead centre: what the loops leave of that way would be any.
    fn jam(&mut self, before: Option<Vec<f64>>, led: &[usize], own: &[(usize, usize)], around: &Surroundings<'_>) {
        let endless =
            |(axis, index): &(usize, usize)| led.contains(axis) && around.actuators[*index].most.is_infinite();
        if let Some(before) = before.filter(|_| own.iter().any(endless)) {
            self.now.q = before;
            self.now.v.fill(0.0);
        }
    }

    /// The longest part of a step: one in which nothing turns far, where what turns moves what hangs on it, too, and is
    /// not driven.
    fn longest_part_s(&self) -> f64 {
        if !self.is_foreseen() {
            return PART_S;
        }
        (PART_RAD / self.turning()).clamp(PART_S / PARTS, PART_S)
    }

    /// Whether centrifugal and Coriolis forces act on it that do not follow from its drives.
    fn is_foreseen(&self) -> bool {
        self.tree.velocities > 1 && self.lumps.turns() && !self.room.driven.iter().all(|driven| *driven)
    }

    /// No body of it turns faster than this, rad/s.
    pub(super) fn turning(&self) -> f64 {
        let each = self.lumps.members.iter().filter(|member| member.freedom.turns());
        let speeds = each.flat_map(|member| {
            let first = member.first[1];
            self.now.v[first..first + member.freedom.velocities()].iter().map(|v| v.abs())
        });
        speeds.sum()
    }

    /// The equations half way through a part, and the inverse of their matrix.
    pub(super) fn prepare(&mut self, part_s: f64, around: &Surroundings<'_>) -> bool {
        let room = &mut self.room;
        room.q.clone_from(&self.now.q);
        room.rates[0].resize(self.tree.positions, 0.0);
        rates(&self.lumps, &self.now.q, &self.now.v, &mut room.rates[0]);
        for (q, rate) in room.q.iter_mut().zip(&room.rates[0]) {
            *q += 0.5 * part_s * rate;
        }
        normalise(&self.lumps, &mut room.q);
        self.moving.evaluate(&self.lumps, &room.q, &self.now.v, around.gravity);
        if !self.moving.factor(&self.lumps) {
            return false;
        }
        self.moving.factored.inverse(&mut room.inverse);
        self.hold_loops(around.gravity);
        true
    }

    /// Takes the bias at the velocities half way through a part, as far as they can be known without its drives: what is
    /// driven goes on as it goes. At those of its beginning, centrifugal and Coriolis forces would do
    /// work that is wrong by the change of velocity, and give the mechanism energy.
    fn foresee(&mut self, part_s: f64, around: &Surroundings<'_>) {
        if !self.is_foreseen() {
            return;
        }
        self.begin(part_s, around.fittings);
        for axis in 0..self.tree.velocities {
            if self.room.driven[axis] {
                self.rows.all.push(Row::rigid(axis, self.now.v[axis], f64::INFINITY));
            }
        }
        self.couple(part_s);
        self.push(part_s, around.fittings);
        if self.stop(part_s, around.fittings) {
            self.push(part_s, around.fittings);
        }
        self.rows.solve(&self.room.stiff, &mut self.room.v);
        for (v, before) in self.room.v.iter_mut().zip(&self.now.v) {
            *v = 0.5 * (*v + before);
        }
        self.moving.bias_at(&self.lumps, &self.room.v, around.gravity);
        self.bend_loops(around.gravity);
    }

    /// Begins a sub-step: the forces on all axes, and the rows of their friction.
    fn begin(&mut self, dt_s: f64, fittings: &[Fitting]) {
        let n = self.tree.velocities;
        self.rows.all.clear();
        self.room.exact.clone_from(&self.room.driven);
        self.room.force.copy_from(&self.moving.bias);
        self.room.force.neg_mut();
        self.room.viscous.clear();
        self.room.viscous.resize(n, 0.0);
        for k in 0..n {
            if let Some(fitting) = self.axes[k].1.map(|joint| &fittings[joint]) {
                self.room.force[k] += fitting.force(self.spring_at(k, dt_s));
                self.resist(k, fitting.dry(self.now.v[k]), fitting.damping, dt_s);
            }
        }
    }

    fn substep(&mut self, dt_s: f64, part: [f64; 2], own: &[(usize, usize)], around: &mut Surroundings<'_>) {
        self.begin(dt_s, around.fittings);
        for (axis, index) in own {
            self.act(*axis, *index, dt_s, part, around);
        }
        self.couple(dt_s);
        self.push(dt_s, around.fittings);
        if self.stop(dt_s, around.fittings) {
            self.push(dt_s, around.fittings);
        }
        self.rows.solve(&self.room.stiff, &mut self.room.v);
        for row in &self.rows.all {
            if let Some(index) = row.actuator {
                let actuator = &mut around.actuators[index];
                actuator.exerted = row.impulse / dt_s;
                actuator.impulse += row.impulse;
            }
        }
        self.go(dt_s, around.fittings);
    }

    /// The velocities that all forces together lead to, before the rows hold what they hold.
    pub(super) fn push(&mut self, dt_s: f64, fittings: &[Fitting]) {
        let n = self.tree.velocities;
        self.stiffen(dt_s, fittings);
        let Room { v, stiff, force, bends, added, .. } = &mut self.room;
        v.clone_from(&self.now.v);
        let mut v = DVectorViewMut::from_slice(v, n);
        v.gemv_tr(dt_s, stiff, force, 1.0);
        if bends.is_empty() {
            return;
        }
        v.axpy(dt_s, bends, 1.0);
        for (axis, added) in added.iter().enumerate().filter(|(_, added)| **added != 0.0) {
            // a spring resists what its loop asks of it, too
            v.axpy(-dt_s * added * bends[axis], &stiff.column(axis), 1.0);
        }
    }

    /// Dry and viscous friction of an axis.
    pub(super) fn resist(&mut self, axis: usize, dry: f64, viscous: f64, dt_s: f64) {
        if dry > 0.0 {
            self.rows.all.push(Row::rigid(axis, 0.0, dry * dt_s));
        }
        let part = viscous * dt_s * self.room.inverse[(axis, axis)];
        if part > EXPLICIT_MAX {
            self.rows.all.push(Row { softness: 1.0 / (viscous * dt_s), ..Row::rigid(axis, 0.0, f64::INFINITY) });
        } else if part > 0.0 {
            self.room.force[axis] -= viscous * self.now.v[axis];
            self.room.viscous[axis] += viscous;
        }
    }

    /// What an actuator does to its axis in a sub-step.
    fn act(&mut self, axis: usize, index: usize, dt_s: f64, [from, to]: [f64; 2], around: &mut Surroundings<'_>) {
        let position = self.now.q[self.axes[axis].0];
        let actuator = &mut around.actuators[index];
        let fitting = &around.fittings[actuator.joint];
        let coordinate = fitting.initial + position;
        let drive = match actuator.acts {
            Acts::Along(path) => {
                let missing = path.at(from) - coordinate;
                let wanted = (path.at(to) - path.at(from)) / dt_s + CORRECTED_A_TURN * missing / path.turn_s;
                let wanted = wanted.clamp((fitting.lower - position) / dt_s, (fitting.upper - position) / dt_s);
                Row::rigid(axis, wanted, actuator.most * dt_s)
            }
            Acts::Law { drive } => {
                let velocity = self.now.v[axis];
                let mass = 1.0 / self.room.inverse[(axis, axis)];
                let motion = Motion { position: coordinate, velocity, mass, exerted: actuator.exerted };
                let effort = around.drives.advance(drive, motion, dt_s);
                self.resist(axis, effort.dry, effort.viscous, dt_s);
                let most = effort.most * dt_s;
                if let Some(sought) = effort.sought {
                    Row::rigid(axis, sought, most)
                } else if effort.slope > 0.0 {
                    let (wanted, softness) = (velocity + effort.force / effort.slope, 1.0 / (effort.slope * dt_s));
                    Row { softness, ..Row::rigid(axis, wanted, most) }
                } else {
                    let force = effort.force.clamp(-effort.most, effort.most);
                    self.room.force[axis] += force;
                    actuator.exerted = force;
                    actuator.impulse += force * dt_s;
                    // a mere force has nowhere to be
                    self.room.exact[axis] &= !self.room.sprung[axis];
                    return;
                }
            }
        };
        self.rows.all.push(Row { actuator: Some(index), ..drive });
    }

    /// The rows of the stops that axes may come to in a sub-step; true if an axis with a spring comes near.
    pub(super) fn stop(&mut self, dt_s: f64, fittings: &[Fitting]) -> bool {
        let mut sprung = false;
        for (axis, (position, joint)) in self.axes.iter().enumerate() {
            let Some(fitting) = joint.map(|joint| &fittings[joint]) else { continue };
            let q = self.now.q[*position];
            let reach = 2.0 * dt_s * (self.now.v[axis].abs() + self.room.v[axis].abs()) + NEAR;
            let was_exact = self.room.exact[axis];
            if q - fitting.lower < reach {
                let wanted = (fitting.lower - q) / dt_s;
                self.rows.all.push(Row { least: 0.0, ..Row::rigid(axis, wanted, f64::INFINITY) });
                self.room.exact[axis] = true;
            }
            if fitting.upper - q < reach {
                let wanted = (fitting.upper - q) / dt_s;
                self.rows.all.push(Row { most: 0.0, ..Row::rigid(axis, wanted, f64::INFINITY) });
                self.room.exact[axis] = true;
            }
            sprung |= self.room.sprung[axis] && self.room.exact[axis] && !was_exact;
        }
        sprung
    }

    /// Takes the new velocities, and goes on with them.
    ///
    /// What is driven or stopped goes on with its new velocity, by which it comes to where it is to be;
    /// the rest with the mean of old and new, which is of second order.
    ///
    /// A rounding beyond a stop is taken back. The velocity that is left at the stop goes in the next sub-step, by
    /// the row of that stop, so that all that hangs on the joint feels it go; where nothing else moves, it goes at
    /// once.
    fn go(&mut self, dt_s: f64, fittings: &[Fitting]) {
        for k in 0..self.tree.velocities {
            let [before, after] = [self.now.v[k], self.room.v[k]];
            self.now.v[k] = match self.axes[k].1 {
                _ if self.room.exact[k] => after,
                Some(joint) => self.through(k, [before, after], dt_s, &fittings[joint]),
                None => 0.5 * (before + after),
            };
        }
        self.travel(dt_s);
        self.now.v.copy_from_slice(&self.room.v);
        keep_within(&mut self.now, &self.axes, fittings);
    }

    /// Goes by the velocities that it has.
    pub(super) fn travel(&mut self, dt_s: f64) {
        let Self { lumps, now, room, .. } = self;
        room.rates[0].resize(lumps.positions, 0.0);
        rates(lumps, &now.q, &now.v, &mut room.rates[0]);
        for (q, rate) in now.q.iter_mut().zip(&room.rates[0]) {
            *q += dt_s * rate;
        }
        normalise(lumps, &mut now.q);
    }
}

/// Of the axes that have actuators, and these, the axes that go along paths.
pub(super) fn led(own: &[(usize, usize)], actuators: &[Actuator]) -> Vec<usize> {
    own.iter().filter(|(_, index)| matches!(actuators[*index].acts, Acts::Along(_))).map(|(axis, _)| *axis).collect()
}

/// Takes coordinates back to the stops that they went beyond. Their velocity is left to the row of the stop, which shows it to
/// all that hangs on the joint; where nothing else moves, it goes at once.
pub(super) fn keep_within(now: &mut Coordinates, axes: &[(usize, Option<usize>)], fittings: &[Fitting]) {
    let is_alone = now.v.len() == 1;
    for ((position, joint), v) in axes.iter().zip(&mut now.v) {
        let Some(fitting) = joint.map(|joint| &fittings[joint]) else { continue };
        let q = &mut now.q[*position];
        let inside = q.clamp(fitting.lower, fitting.upper);
        if inside != *q && is_alone {
            *v = if *q < inside { v.max(0.0) } else { v.min(0.0) };
        }
        *q = inside;
    }
}
