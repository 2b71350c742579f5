//! A ray, carried by a body, that meets other bodies.

use onescan_server::client::ClientFault;
use rapier3d::math::Vector;
use rapier3d::prelude::RigidBodyHandle;

use super::{BindingKey, Names, Tie, Unbound, Which, needed, optional, sought, wanted, without_effect};
use crate::model::Bound;
use crate::model::Mechanics;
use crate::world::coordinate::Measured;
use crate::world::{Sought, World};

/// A ray as its carrier sees it.
pub(crate) struct Ray {
    carrier: RigidBodyHandle,
    point: Vector,
    direction: Vector,
    targets: Sought,
}

/// What the ray meets first.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Hit {
    /// How far away, m; none if it meets nothing.
    pub(crate) hit_m: Option<f64>,
}

impl Tie for Ray {
    const NAME: &'static str = "ray";
    const KEYS: &'static [BindingKey] = &[
        optional("body", Names::Carrier, "body that carries it; the ground if absent"),
        needed("point_m", Names::Point, "where the ray begins, in world coordinates of the scene's pose"),
        needed("direction", Names::Direction, "of the ray, of any length"),
        optional(
            "targets",
            Names::Bodies { named: Which::Any, absent: Which::Any },
            "bodies that are detected; all but the carrier if absent",
        ),
    ];
    type Seen = Hit;
    without_effect!();

    fn bind(bound: &Bound, _: &Mechanics, world: &mut World) -> Result<Self, Unbound> {
        let carrier = world.handle(bound.body);
        let targets = sought(world, &bound.targets);
        let (point, direction) = (wanted(bound.point_m, "point")?, wanted(bound.direction, "direction")?);
        let pose = world.body(carrier).position();
        Ok(Self {
            carrier,
            point: pose.inverse_transform_point(Vector::from_array(point)),
            direction: pose.inverse_transform_vector(Vector::from_array(direction)),
            targets,
        })
    }

    fn see(&self, _: Measured<'_>, world: &World) -> Hit {
        let pose = *world.body(self.carrier).position();
        let ray = rapier3d::prelude::Ray::new(pose * self.point, pose.rotation * self.direction);
        Hit { hit_m: world.first_hit(&ray, &self.targets) }
    }

    fn in_words(bound: &Bound, _: &Mechanics) -> String {
        format!("a ray at {} bodies", bound.targets.len())
    }
}
