//! What drives with a force or a torque command have in common.

use serde::{Deserialize, Serialize};

use crate::component::dynamics::{Resistance, Travel, lag, substeps};
use crate::effort::{Effort, Motion};

/// Longest sub-step.
pub(crate) const LONGEST_S: f64 = 0.25e-3;

/// Limits of a drive: N or N·m, m/s or rad/s, and the time constant of its current loop.
pub(crate) struct Limits {
    pub(crate) effort: f64,
    pub(crate) speed: f64,
    pub(crate) lag_s: f64,
}

/// What a drive without a joint moves: N or N·m of load against the way up; kg or kg·m² with friction in N or N·m, within
/// a range in m or rad.
pub(crate) struct OwnMass {
    pub(crate) load: f64,
    pub(crate) resistance: Resistance,
}

/// What a drive is asked for in a turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Order {
    /// Nothing at all.
    Off,
    /// What it was asked for before.
    AsBefore,
    /// So much.
    Effort(f64),
}

/// A command on its way to a force or a torque.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Commanded {
    wanted: f64,
    effort: f64,
    /// What it exerts: all of `effort` below its greatest speed.
    exerted: f64,
    beyond: bool,
    fast: bool,
}

impl Commanded {
    pub(crate) fn take(&mut self, order: Order, limits: &Limits) {
        match order {
            Order::Off => (self.wanted, self.beyond) = (0.0, false),
            Order::AsBefore => {}
            Order::Effort(asked) => {
                let asked = if asked.is_finite() { asked } else { 0.0 };
                self.wanted = asked.clamp(-limits.effort, limits.effort);
                self.beyond = asked.abs() > limits.effort;
            }
        }
    }

    /// A sub-step in which it stands.
    pub(crate) fn settle(&mut self, limits: &Limits, dt_s: f64) {
        self.effort = lag(self.effort, self.wanted, limits.lag_s, dt_s);
        (self.exerted, self.fast) = (self.effort, false);
    }

    /// The velocity that its force would take it beyond, against a load.
    fn limit(&self, limits: &Limits, motion: &Motion, load: f64, dt_s: f64) -> Option<f64> {
        let most = limits.speed.copysign(self.effort);
        let next = motion.velocity + (self.effort - load) * dt_s / motion.mass;
        (self.effort != 0.0 && next * self.effort.signum() > limits.speed).then_some(most)
    }

    /// A turn in which it moves a mass of its own against a load; a jammed one stands.
    pub(crate) fn turn(&mut self, travel: &mut Travel, limits: &Limits, own: &OwnMass, turn: (f64, bool)) {
        let ((turn_s, jammed), resistance) = (turn, &own.resistance);
        let (count, dt_s) = substeps(turn_s, LONGEST_S);
        for _ in 0..count {
            if jammed {
                self.settle(limits, dt_s);
                travel.velocity = 0.0;
                continue;
            }
            let Travel { position, velocity } = *travel;
            let motion = Motion { position, velocity, mass: resistance.mass, exerted: 0.0 };
            let effort = self.by_itself(limits, &motion, (own.load, resistance.range), dt_s);
            travel.push(effort - own.load, resistance, dt_s);
        }
    }

    /// What it exerts on a mass of its own in a sub-step, which moves within a range.
    fn by_itself(&mut self, limits: &Limits, motion: &Motion, (load, range): (f64, (f64, f64)), dt_s: f64) -> f64 {
        self.settle(limits, dt_s);
        let net = self.effort - load;
        let presses = net > 0.0 && motion.position >= range.1 || net < 0.0 && motion.position <= range.0;
        if presses {
            // The stop takes the force, and the mass does not come to a speed.
            return self.exerted;
        }
        if let Some(most) = self.limit(limits, motion, load, dt_s) {
            let keeps = load + motion.mass * (most - motion.velocity) / dt_s;
            self.exerted = keeps.clamp(-self.effort.abs(), self.effort.abs());
            self.fast = true;
        }
        self.exerted
    }

    /// What it does to its joint in a sub-step, which resists with a load and dry friction.
    pub(crate) fn on_joint(&mut self, limits: &Limits, motion: &Motion, (load, dry): (f64, f64), dt_s: f64) -> Effort {
        self.settle(limits, dt_s);
        let sought = self.limit(limits, motion, load, dt_s);
        if let Some(most) = sought {
            self.fast = true;
            self.exerted = motion.exerted.clamp(-self.effort.abs(), self.effort.abs());
            return Effort { sought: Some(most), most: (self.effort - load).abs(), dry, ..Effort::of(0.0) };
        }
        Effort { dry, ..Effort::of(self.effort - load) }
    }

    pub(crate) fn exerted(&self) -> f64 {
        self.exerted
    }

    pub(crate) fn is_limited(&self) -> bool {
        self.beyond || self.fast
    }
}
