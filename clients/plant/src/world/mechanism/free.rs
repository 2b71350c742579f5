//! Steps of a mechanism that only smooth forces move: the classical Runge-Kutta method of order 4.
//!
//! The method is stable, and so gives no energy, where a step is short beside the swings of springs
//! (`ω h < 2.8`). A step that is not is cut in parts; where that takes too many, it is left to
//! [`driven`](super::driven), which is stable at any step and less exact.

use super::closure::Closed;
use super::dynamics::{normalise, rates};
use super::{Mechanism, Surroundings};
use crate::fitting::Fitting;

/// The longest part, in radians of the fastest swing: it takes 2e-6 of an amplitude.
const PART_RAD: f64 = 0.25;
/// The most parts of a step.
const PARTS: f64 = 64.0;

impl Mechanism {
    /// Moves by a step; false, and unmoved, if it comes to a stop, is too stiff or its equations cannot be
    /// solved.
    pub(super) fn step_freely(&mut self, dt_s: f64, around: &Surroundings<'_>) -> bool {
        let Some(stiffness) = self.stiffness(around) else { return false };
        let rate = stiffness + if self.tree.velocities > 1 { self.turning() } else { 0.0 };
        // a whole number of parts is not one more for a rounding
        let mut count = (dt_s * rate / PART_RAD - 1e-9).ceil().max(1.0);
        let before = self.energy(around);
        self.room.start.clone_from(&self.now);
        while count <= PARTS {
            let moved = (0..count as u32).all(|_| self.part_freely(dt_s / count, around));
            let is_finest = 2.0 * count > PARTS;
            if moved && (is_finest || !self.has_gained(before, dt_s, around)) {
                return true;
            }
            self.now.clone_from(&self.room.start);
            if !moved {
                return false;
            }
            count *= 2.0;
        }
        false
    }

    /// No mode of its springs and dampers is faster than this, 1/s: `√ tr(M⁻¹K) + tr(M⁻¹C)`. None if its
    /// equations cannot be solved.
    fn stiffness(&mut self, around: &Surroundings<'_>) -> Option<f64> {
        let fitted = |joint: Option<usize>| joint.map(|joint| &around.fittings[joint]);
        let gives = |fitting: &Fitting| fitting.spring != 0.0 || fitting.damping != 0.0;
        if !self.axes.iter().any(|(_, joint)| fitted(*joint).is_some_and(gives)) {
            return Some(0.0);
        }
        self.moving.evaluate(&self.lumps, &self.now.q, &self.now.v, around.gravity);
        if !self.moving.factor(&self.lumps) {
            return None;
        }
        self.moving.factored.inverse(&mut self.room.inverse);
        let (mut swings, mut fades) = (0.0, 0.0);
        for (axis, (_, joint)) in self.axes.iter().enumerate() {
            let Some(fitting) = fitted(*joint) else { continue };
            let light = self.room.inverse[(axis, axis)];
            swings += light * fitting.spring;
            fades += light * fitting.damping;
        }
        Some(swings.sqrt() + fades)
    }

    /// Moves by a part of a step; false, and unmoved, as above.
    fn part_freely(&mut self, dt_s: f64, around: &Surroundings<'_>) -> bool {
        let n = self.tree.velocities;
        let positions = self.tree.positions;
        let room = &mut self.room;
        for stage in 0..4 {
            room.rates[stage].resize(positions, 0.0);
            room.accelerations[stage].resize(n, 0.0);
            let way = match stage {
                0 => 0.0,
                1 | 2 => 0.5 * dt_s,
                _ => dt_s,
            };
            room.q.clone_from(&self.now.q);
            room.v.clone_from(&self.now.v);
            if stage > 0 {
                add(&mut room.q, way, &room.rates[stage - 1]);
                add(&mut room.v, way, &room.accelerations[stage - 1]);
            }
            rates(&self.lumps, &room.q, &room.v, &mut room.rates[stage]);
            self.moving.evaluate(&self.lumps, &room.q, &room.v, around.gravity);
            if !self.moving.factor(&self.lumps) {
                return false;
            }
            for k in 0..n {
                let (position, joint) = self.axes[k];
                let fitted = joint.map_or(0.0, |joint| {
                    let fitting = &around.fittings[joint];
                    fitting.force(room.q[position]) - fitting.damping * room.v[k]
                });
                room.force[k] = fitted - self.moving.bias[k];
            }
            self.moving.factored.solve(&mut room.force);
            if !self.lumps.closures.is_empty() {
                self.basis.find(&self.lumps, &self.moving, around.gravity);
                self.basis.bend(&mut room.force);
            }
            room.accelerations[stage].copy_from_slice(room.force.as_slice());
        }
        room.q.clone_from(&self.now.q);
        room.v.clone_from(&self.now.v);
        for (stage, weight) in [1.0, 2.0, 2.0, 1.0].into_iter().enumerate() {
            add(&mut room.q, weight * dt_s / 6.0, &room.rates[stage]);
            add(&mut room.v, weight * dt_s / 6.0, &room.accelerations[stage]);
        }
        normalise(&self.lumps, &mut room.q);
        let stopped = |(position, joint): &(usize, Option<usize>)| {
            joint.is_some_and(|joint| around.fittings[joint].stops(room.q[*position]))
        };
        if self.axes.iter().any(stopped) || !room.q.iter().chain(&room.v).all(|value| value.is_finite()) {
            return false;
        }
        std::mem::swap(&mut self.now.q, &mut room.q);
        std::mem::swap(&mut self.now.v, &mut room.v);
        self.close(around.gravity, &[]) != Closed::Unsolved
    }
}

fn add(sum: &mut [f64], factor: f64, more: &[f64]) {
    for (sum, more) in sum.iter_mut().zip(more) {
        *sum += factor * more;
    }
}
