//! What is fitted to a joint beside its drive: stops, spring, damper, friction.

use super::scene::model::Joint;

/// The fittings of a joint. Coordinates are counted from the scene's pose, as the engine counts them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fitting {
    /// The joint's coordinate in the scene's pose.
    pub(crate) initial: f64,
    /// Hard stops.
    pub(crate) lower: f64,
    pub(crate) upper: f64,
    /// Viscous friction, N·s/m or N·m·s.
    pub(crate) damping: f64,
}

impl Fitting {
    /// The fittings that a scene gives a joint.
    pub(crate) fn new(joint: &Joint) -> Self {
        Self {
            initial: joint.initial,
            lower: joint.lower.map_or(f64::NEG_INFINITY, |lower| lower - joint.initial),
            upper: joint.upper.map_or(f64::INFINITY, |upper| upper - joint.initial),
            damping: 0.0,
        }
    }

    /// True if all of its forces are smooth in coordinate and velocity; a stop is looked after apart.
    pub(crate) const fn is_smooth(&self) -> bool {
        true
    }

    /// The smooth force at a coordinate and a velocity.
    pub(crate) const fn force(&self, _position: f64, _velocity: f64) -> f64 {
        0.0
    }

    /// Dry friction at a velocity, N or N·m.
    pub(crate) const fn dry(&self, _velocity: f64) -> f64 {
        0.0
    }

    /// True if the coordinate is at a stop or beyond.
    pub(crate) fn stops(&self, position: f64) -> bool {
        position <= self.lower || position >= self.upper
    }
}
