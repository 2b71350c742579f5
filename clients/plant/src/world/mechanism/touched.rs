//! What a mechanism is to others that it touches: velocities, what holds at its joints, and what moves a point of it.
//!
//! In such a step it moves with the velocities at its end, as all that touches. Drives are lines of force over velocity,
//! as for the engine (see [`crate::world::actuator`]); their own state follows afterwards.

use nalgebra::{DVectorView, DVectorViewMut, Vector3};
use rapier3d::prelude::*;

use super::driven::{keep_within, led};
use super::rows::Row;
use super::{Mechanism, Surroundings};
use crate::effort::Motion;
use crate::world::actuator::Acts;

/// What a drive that follows its path whatever it takes gives way, as a part of what it moves: a wall that it
/// presses upon gives way less.
const YIELDS: f64 = 1e-6;

/// What holds at a joint, as a row over the mechanism's coordinates.
pub(in crate::world) struct Tie {
    pub(in crate::world) parts: Vec<(usize, f64)>,
    pub(in crate::world) wanted: f64,
    pub(in crate::world) softness: f64,
    pub(in crate::world) least: f64,
    pub(in crate::world) most: f64,
}

impl Mechanism {
    /// Finds its velocities after a step of `dt_s` under all forces, and what holds at its joints; false if its
    /// equations cannot be solved.
    pub(crate) fn aim(&mut self, dt_s: f64, around: &mut Surroundings<'_>) -> bool {
        let n = self.tree.velocities;
        self.find_springs(around.fittings);
        if !self.prepare(dt_s, around) {
            return false;
        }
        self.equations.place(&self.tree, &self.now.q);
        self.rows.all.clear();
        // all goes on with its new velocity
        self.room.exact.clear();
        self.room.exact.resize(n, true);
        self.room.viscous.clear();
        self.room.viscous.resize(n, 0.0);
        self.room.force.copy_from(&self.moving.bias);
        self.room.force.neg_mut();
        for k in 0..n {
            if let Some(fitting) = self.axes[k].1.map(|joint| &around.fittings[joint]) {
                self.room.force[k] += fitting.force(self.spring_at(k, dt_s));
                self.resist(k, fitting.dry(self.now.v[k]), fitting.damping, dt_s);
            }
        }
        for (axis, index) in self.own_actuators(around.actuators) {
            self.drive(axis, index, dt_s, around);
        }
        self.couple(dt_s);
        self.push(dt_s, around.fittings);
        self.stop(dt_s, around.fittings);
        true
    }

    /// The row of an actuator.
    fn drive(&mut self, axis: usize, index: usize, dt_s: f64, around: &Surroundings<'_>) {
        let position = self.now.q[self.axes[axis].0];
        let actuator = &around.actuators[index];
        let fitting = &around.fittings[actuator.joint];
        let coordinate = fitting.initial + position;
        let (velocity, exerted) = (self.now.v[axis], actuator.exerted);
        let motion = Motion { position: coordinate, velocity, mass: f64::INFINITY, exerted };
        let line = actuator.line(motion, around.part, dt_s, around.drives);
        let wanted = match actuator.acts {
            Acts::Along(_) => line.velocity.clamp((fitting.lower - position) / dt_s, (fitting.upper - position) / dt_s),
            Acts::Law { .. } => line.velocity,
        };
        let moves = self.room.inverse[(axis, axis)];
        let softness = if line.slope.is_finite() { 1.0 / (line.slope * dt_s) } else { YIELDS * moves };
        self.resist(axis, line.dry, 0.0, dt_s);
        self.rows.all.push(Row { softness, actuator: Some(index), ..Row::rigid(axis, wanted, line.most * dt_s) });
    }

    /// The velocities that it aims at without what holds and touches.
    pub(crate) fn aimed(&self) -> &[f64] {
        &self.room.v
    }

    /// What holds at its joints.
    pub(in crate::world) fn ties(&self) -> impl Iterator<Item = Tie> {
        self.rows.all.iter().map(|row| {
            let Row { wanted, softness, least, most, .. } = *row;
            Tie { parts: row.parts().collect(), wanted, softness, least, most }
        })
    }

    /// What an impulse along each coordinate adds to its velocities.
    pub(crate) fn answers(&self, along: &[f64], answer: &mut [f64]) {
        let n = self.tree.velocities;
        let along = DVectorView::from_slice(along, n);
        DVectorViewMut::from_slice(answer, n).gemv_tr(1.0, &self.room.stiff, &along, 0.0);
    }

    /// Adds how fast a point of a body moves in a direction with each velocity.
    pub(crate) fn lever(&self, body: RigidBodyHandle, point: Vector, direction: Vector, along: &mut [f64]) {
        let mut at = self.tree.members.iter().position(|member| member.body == Some(body));
        let (arm, direction) = (Vector3::from(point - self.equations.about), Vector3::from(direction));
        while let Some(member) = at.map(|index| &self.tree.members[index]) {
            let span = member.first[1]..member.first[1] + member.freedom.velocities();
            for (along, axis) in along[span.clone()].iter_mut().zip(&self.equations.axes[span]) {
                *along += axis.at(arm).dot(&direction);
            }
            at = member.on;
        }
    }

    /// How fast a point of a body moves in a direction now.
    pub(crate) fn approach(&self, body: RigidBodyHandle, point: Vector, direction: Vector) -> f64 {
        let mut along = vec![0.0; self.tree.velocities];
        self.lever(body, point, direction, &mut along);
        along.iter().zip(&self.now.v).map(|(along, v)| along * v).sum()
    }

    /// Goes through a step of `dt_s` with these velocities at its end and those that correct its position, and what
    /// held at its joints.
    pub(crate) fn arrive(
        &mut self,
        dt_s: f64,
        [velocities, corrections]: [&[f64]; 2],
        impulses: impl Iterator<Item = f64>,
        around: &mut Surroundings<'_>,
    ) {
        for (row, impulse) in self.rows.all.iter_mut().zip(impulses) {
            row.impulse = impulse;
            if let Some(actuator) = row.actuator.and_then(|index| around.actuators.get_mut(index)) {
                actuator.exerted = impulse / dt_s;
                actuator.effort = actuator.exerted;
            }
        }
        for ((v, velocity), correction) in self.now.v.iter_mut().zip(velocities).zip(corrections) {
            *v = velocity + correction;
        }
        self.travel(dt_s);
        self.now.v.copy_from_slice(velocities);
        keep_within(&mut self.now, &self.axes, around.fittings);
        let held = self.held(&led(&self.own_actuators(around.actuators), around.actuators), around.fittings);
        self.close(around.gravity, &held);
    }
}
