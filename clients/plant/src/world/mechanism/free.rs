//! Steps of a mechanism that only smooth forces move: the classical Runge-Kutta method of order 4.

use super::dynamics::{normalise, rates};
use super::{Mechanism, Surroundings, matrix};

impl Mechanism {
    /// Moves by a step; false, and unmoved, if it comes to a stop or its equations cannot be solved.
    pub(super) fn step_freely(&mut self, dt_s: f64, around: &Surroundings<'_>) -> bool {
        let n = self.tree.velocities;
        let positions = self.tree.positions;
        let room = &mut self.room;
        room.force.resize(n, 0.0);
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
            matrix::solve(&self.moving.mass, n, &mut room.force);
            room.accelerations[stage].copy_from_slice(&room.force);
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
        true
    }
}

fn add(sum: &mut [f64], factor: f64, more: &[f64]) {
    for (sum, more) in sum.iter_mut().zip(more) {
        *sum += factor * more;
    }
}
