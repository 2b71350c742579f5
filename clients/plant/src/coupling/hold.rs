//! A body, or one shape of it, that holds one of the bodies that touch it, and the load that this is.
//!
//! # Load
//! Holding a body of mass m takes the force `F = m (a - g)`: a is the acceleration of its centre of mass,
//! from its velocity over a period, smoothed by the time constant of pads and lips: a blow that is shorter does
//! not tear them apart. What else carries the body is not
//! taken off: a load that rests on a table counts as if it hung.

use onescan_server::client::ClientFault;
use rapier3d::math::Vector;
use rapier3d::prelude::{ImpulseJointHandle, RigidBodyHandle};
use serde::{Deserialize, Serialize};

use super::touch::{Touched, in_words, keys};
use super::{BindingKey, Names, Targets, Tie, Unbound, Which, optional, target};
use crate::model::Bound;
use crate::model::Mechanics;
use crate::world::World;
use crate::world::coordinate::Measured;

const TOUCHED: [BindingKey; 3] = keys(Which::Dynamic);

/// A body that dynamic bodies touch, or one shape of it, and that holds one of them.
pub(crate) struct Holds {
    touched: Touched,
    /// As the holder sees them.
    direction: Option<Vector>,
    point: Option<Vector>,
    held: Option<Held>,
}

/// What a holder sees.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Grasp {
    /// What it holds; what touches it, if it holds nothing.
    pub(crate) targets: Targets,
    /// What the held body asks for, or the first that touches it if none is held.
    pub(crate) load: Load,
}

/// The force that holding a body takes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Load {
    pub(crate) force_n: f64,
    /// Of it, what pulls the body away along the holder's direction, negative if it presses; none
    /// without a direction.
    pub(crate) pull_n: Option<f64>,
    /// How far beside the holder's point the centre of mass is, across its direction; 0 without both.
    pub(crate) beside_m: f64,
}

impl Load {
    /// What is across the direction, or all of it without one.
    pub(crate) fn aside_n(self) -> f64 {
        let pull_n = self.pull_n.unwrap_or(0.0);
        (self.force_n * self.force_n - pull_n * pull_n).max(0.0).sqrt()
    }
}

/// Holds a target fast, by its place among the targets; releases any other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hold {
    pub(crate) target: Option<u32>,
    /// Time constant of what lies between holder and part.
    pub(crate) yield_s: f64,
}

/// A body that is held, by which joint, and how it moves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Held {
    target: u32,
    joint: ImpulseJointHandle,
    /// When the period began.
    velocity_m_s: [f64; 3],
    /// Of the period before, smoothed.
    acceleration_m_s2: [f64; 3],
    /// How long the period is.
    dt_s: f64,
    yield_s: f64,
}

impl Held {
    /// The acceleration until now, smoothed.
    fn acceleration(&self, world: &World, body: RigidBodyHandle) -> Vector {
        let before = Vector::from_array(self.acceleration_m_s2);
        if self.dt_s <= 0.0 {
            return before;
        }
        let now = (world.body(body).linvel() - Vector::from_array(self.velocity_m_s)) / self.dt_s;
        now + (before - now) * libm::exp(-self.dt_s / self.yield_s)
    }
}

impl Holds {
    fn load(&self, place: u32, acceleration: Vector, world: &World) -> Load {
        let Ok(handle) = target(self.touched.targets.handles(), place) else { return Load::default() };
        let (body, holder) = (world.body(handle), world.body(self.touched.surface.body));
        let force = (acceleration - world.gravity()) * body.mass();
        let Some(direction) = self.direction.map(|direction| holder.rotation() * direction) else {
            return Load { force_n: force.length(), pull_n: None, beside_m: 0.0 };
        };
        let beside = self.point.map_or(Vector::ZERO, |point| body.center_of_mass() - *holder.position() * point);
        let across = beside - direction * beside.dot(direction);
        Load { force_n: force.length(), pull_n: Some(-force.dot(direction)), beside_m: across.length() }
    }
}

impl Tie for Holds {
    const NAME: &'static str = "holds";
    const KEYS: &'static [BindingKey] = &[
        TOUCHED[0],
        TOUCHED[1],
        TOUCHED[2],
        optional(
            "direction",
            Names::Direction,
            "from it to what it holds, or along which its jaws close; if absent, forces count alike in all directions",
        ),
        optional(
            "point_m",
            Names::Point,
            "where it holds, in world coordinates of the scene's pose; moments count only with it and `direction`",
        ),
    ];
    type Seen = Grasp;
    type Effect = Hold;
    type Memory = Option<Held>;

    fn bind(bound: &Bound, _: &Mechanics, world: &mut World) -> Result<Self, Unbound> {
        let touched = Touched::bind(bound, world)?;
        let pose = world.body(touched.surface.body).position();
        let direction = bound.direction.map(|direction| pose.inverse_transform_vector(Vector::from_array(direction)));
        let point = bound.point_m.map(|point| pose.inverse_transform_point(Vector::from_array(point)));
        Ok(Self { touched, direction, point, held: None })
    }

    fn see(&self, _: Measured<'_>, world: &World) -> Grasp {
        if let Some(held) = self.held {
            let body = target(self.touched.targets.handles(), held.target);
            let acceleration = body.map_or(Vector::ZERO, |body| held.acceleration(world, body));
            let targets = Targets { first: Some(held.target), count: 1 };
            return Grasp { targets, load: self.load(held.target, acceleration, world) };
        }
        let targets = self.touched.see(world);
        let load = targets.first.map_or_else(Load::default, |first| self.load(first, Vector::ZERO, world));
        Grasp { targets, load }
    }

    fn apply(&mut self, hold: Hold, _: Measured<'_>, dt_s: f64, world: &mut World) -> Result<(), ClientFault> {
        let Hold { target: wanted, yield_s } = hold;
        if let Some(held) = self.held.take_if(|held| Some(held.target) != wanted) {
            world.let_go(held.joint)?;
        }
        let Some(place) = wanted else { return Ok(()) };
        let body = target(self.touched.targets.handles(), place)?;
        let velocity_m_s = world.body(body).linvel().to_array();
        let holder = world.body(self.touched.surface.body);
        // what is caught is at rest on its holder at once, and is not lost by that
        let caught_m_s = holder.velocity_at_point(world.body(body).center_of_mass()).to_array();
        self.held = Some(if let Some(held) = self.held {
            let acceleration_m_s2 = held.acceleration(world, body).to_array();
            Held { velocity_m_s, acceleration_m_s2, dt_s, yield_s, ..held }
        } else {
            let joint = world.hold(self.touched.surface.body, body);
            Held { target: place, joint, velocity_m_s: caught_m_s, acceleration_m_s2: [0.0; 3], dt_s, yield_s }
        });
        Ok(())
    }

    fn memory(&self) -> Option<Held> {
        self.held
    }

    fn restore(&mut self, held: Option<Held>) {
        self.held = held;
    }

    fn in_words(bound: &Bound, scene: &Mechanics) -> String {
        in_words(bound, scene)
    }
}
