//! Steps that give a mechanism energy that nothing gave it: they are taken again in finer parts.
//!
//! The methods of steps are of finite order. Where something turns far in a step, or a light link hangs on a heavy one, a
//! step may add energy, and more in the next, without end. A step at whose end there is too much of it is not kept.

use super::{Mechanism, Surroundings};

/// What a mechanism may gain in a second, as a part of its energy.
const GAIN_PER_S: f64 = 1e-4;

/// The energy of a mechanism, J.
#[derive(Clone, Copy, Debug)]
pub(super) struct Energy {
    all: f64,
    /// How much there is of each part of it; of weights, over a metre.
    amount: f64,
}

impl Energy {
    /// Whether this is more than `before`, a step of `dt_s` ago, for no reason.
    pub(super) fn is_gained(self, before: Self, dt_s: f64) -> bool {
        let gain = self.all - before.all;
        // what is not a number is nobody's energy
        gain.is_nan() || gain > GAIN_PER_S * dt_s * self.amount.max(before.amount)
    }
}

impl Mechanism {
    /// The energy of one that no actuator moves, if its masses are others in each pose.
    pub(super) fn energy(&mut self, around: &Surroundings<'_>) -> Option<Energy> {
        if !self.lumps.turns() {
            return None;
        }
        let (kinetic, height, weight) = self.moving.energy(&self.lumps, [&self.now.q, &self.now.v], around.gravity);
        let mut energy = Energy { all: kinetic + height, amount: kinetic + weight };
        for (position, joint) in &self.axes {
            if let Some(fitting) = joint.map(|joint| &around.fittings[joint]) {
                let (spring, balance) = fitting.energy(self.now.q[*position]);
                energy.all += spring - balance;
                energy.amount += spring + balance.abs();
            }
        }
        Some(energy)
    }

    /// Whether it has gained energy for no reason since it had so much, a step of `dt_s` ago.
    pub(super) fn has_gained(&mut self, before: Option<Energy>, dt_s: f64, around: &Surroundings<'_>) -> bool {
        let now = before.and_then(|_| self.energy(around));
        before.zip(now).is_some_and(|(before, now)| now.is_gained(before, dt_s))
    }
}
