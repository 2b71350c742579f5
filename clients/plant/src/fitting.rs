//! What is fitted to a joint beside its drive: stops, spring, damper, counterweight, friction, brake.

use super::model::Mechanics;

/// The fittings of a joint. Coordinates are counted from the scene's pose, as the engine counts them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fitting {
    /// The joint's coordinate in the scene's pose.
    pub(crate) initial: f64,
    pub(crate) lower: f64,
    pub(crate) upper: f64,
    /// Viscous friction, N·s/m or N·m·s.
    pub(crate) damping: f64,
    /// N/m or N·m/rad, and the coordinate at which the spring is at rest.
    pub(crate) spring: f64,
    pub(crate) rest: f64,
    /// A constant force up the coordinate.
    pub(crate) balance: f64,
    /// Dry friction while it moves, and what comes on top at rest.
    friction: f64,
    breakaway: f64,
    stribeck: f64,
    /// What the brake holds in this turn.
    pub(crate) brake: f64,
    brake_most: f64,
}

impl Fitting {
    /// The fittings that a scene gives the joint of an index.
    pub(crate) fn new(scene: &Mechanics, joint: usize) -> Self {
        let described = &scene.joints[joint];
        let initial = described.initial;
        let mut fitting = Self {
            initial,
            lower: described.lower.map_or(f64::NEG_INFINITY, |lower| lower - initial),
            upper: described.upper.map_or(f64::INFINITY, |upper| upper - initial),
            damping: 0.0,
            spring: 0.0,
            rest: 0.0,
            balance: 0.0,
            friction: 0.0,
            breakaway: 0.0,
            stribeck: 1.0,
            brake: 0.0,
            brake_most: 0.0,
        };
        if let Some(fitted) = scene.fittings.iter().find(|fitted| fitted.joint == joint) {
            fitting.damping = fitted.damping;
            (fitting.spring, fitting.rest) = (fitted.spring, fitted.rest - initial);
            fitting.balance = fitted.balance;
            (fitting.friction, fitting.breakaway) = (fitted.friction, fitted.stiction - fitted.friction);
            fitting.stribeck = fitted.stribeck;
            fitting.brake_most = fitted.brake.as_ref().map_or(0.0, |brake| brake.most);
            fitting.brake = fitting.brake_most;
        }
        fitting
    }

    /// Applies the brake, or releases it.
    pub(crate) fn set_brake(&mut self, released: bool) {
        self.brake = if released { 0.0 } else { self.brake_most };
    }

    /// True if all of its forces are smooth in coordinate and velocity; a stop is looked after apart.
    pub(crate) fn is_smooth(&self) -> bool {
        self.friction + self.breakaway + self.brake_most == 0.0
    }

    /// True if nothing is fitted to the joint, not even a stop.
    pub(crate) fn is_plain(&self) -> bool {
        let stops = self.lower.is_finite() || self.upper.is_finite();
        self.is_smooth() && !self.pushes() && !stops
    }

    /// True if it has forces other than dry friction.
    pub(crate) fn pushes(&self) -> bool {
        self.damping != 0.0 || self.spring != 0.0 || self.balance != 0.0
    }

    /// The energy of spring and counterweight at a coordinate, from the scene's pose: what the one has, and what the other
    /// has given.
    pub(crate) fn energy(&self, position: f64) -> (f64, f64) {
        let stretched = position - self.rest;
        (0.5 * self.spring * stretched * stretched, self.balance * position)
    }

    /// The force of spring and counterweight at a coordinate.
    pub(crate) fn force(&self, position: f64) -> f64 {
        self.balance - self.spring * (position - self.rest)
    }

    /// Dry friction at a velocity, N or N·m, by Stribeck: `F_c + (F_s - F_c) exp(-(v/v_s)²)`; and the
    /// brake's.
    pub(crate) fn dry(&self, velocity: f64) -> f64 {
        let related = velocity / self.stribeck;
        let breakaway = if self.breakaway > 0.0 { self.breakaway * libm::exp(-related * related) } else { 0.0 };
        self.friction + breakaway + self.brake
    }

    /// True if the coordinate is at a stop or beyond.
    pub(crate) fn stops(&self, position: f64) -> bool {
        position <= self.lower || position >= self.upper
    }
}
