//! Rays beside each other, carried by a body, that other bodies interrupt.

use onescan_server::client::ClientFault;
use rapier3d::math::{Pose, Vector};
use rapier3d::prelude::RigidBodyHandle;

use super::{BindingKey, Names, Ray, Tie, Unbound, needed, optional, sought, wanted, without_effect};
use crate::model::Bound;
use crate::model::Mechanics;
use crate::world::coordinate::Measured;
use crate::world::{Sought, World};

/// Beams as their carrier sees the first of them.
pub(crate) struct Curtain {
    carrier: RigidBodyHandle,
    point: Vector,
    direction: Vector,
    along: Vector,
    targets: Sought,
    beams: Beams,
}

/// How many beams there are, and how they lie.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Beams {
    /// At most 64.
    pub(crate) count: u32,
    /// From the middle of one to that of the next.
    pub(crate) pitch_m: f64,
    /// How wide each of them is: it is dark when all of it is covered.
    pub(crate) wide_m: f64,
    pub(crate) range_m: f64,
}

/// Which beams are dark, a bit each, the first in the lowest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Interrupted(pub(crate) u64);

impl Curtain {
    /// From now on it has these beams.
    pub(crate) fn set(&mut self, beams: Beams) {
        self.beams = beams;
    }

    fn is_dark(&self, beam: u32, pose: &Pose, world: &World) -> bool {
        let Beams { pitch_m, wide_m, range_m, .. } = self.beams;
        // both edges and the middle; of one without a width the middle alone
        let parts: &[f64] = if wide_m > 0.0 { &[-0.5, 0.0, 0.5] } else { &[0.0] };
        parts.iter().all(|part| {
            let begins = self.point + self.along * (f64::from(beam) * pitch_m + part * wide_m);
            let ray = rapier3d::prelude::Ray::new(*pose * begins, pose.rotation * self.direction);
            world.any_hit(&ray, range_m, &self.targets)
        })
    }
}

impl Tie for Curtain {
    const NAME: &'static str = "curtain";
    const KEYS: &'static [BindingKey] = &[
        Ray::KEYS[0],
        needed("point_m", Names::Point, "where the first beam begins, in world coordinates of the scene's pose"),
        needed("direction", Names::Direction, "of the beams, of any length"),
        optional(
            "along",
            Names::Along,
            "from the first beam to the last, across `direction`; upwards if absent, along x for upright beams",
        ),
        Ray::KEYS[3],
    ];
    type Seen = Interrupted;
    without_effect!();

    fn bind(bound: &Bound, _: &Mechanics, world: &mut World) -> Result<Self, Unbound> {
        let carrier = world.handle(bound.body);
        let targets = sought(world, &bound.targets);
        let point = Vector::from_array(wanted(bound.point_m, "point")?);
        let direction = Vector::from_array(wanted(bound.direction, "direction")?);
        let upwards = || (Vector::Z - direction * direction.dot(Vector::Z)).normalize_or(Vector::X);
        let along = bound.along.map_or_else(upwards, Vector::from_array);
        let pose = world.body(carrier).position();
        Ok(Self {
            carrier,
            point: pose.inverse_transform_point(point),
            direction: pose.inverse_transform_vector(direction),
            along: pose.inverse_transform_vector(along),
            targets,
            beams: Beams::default(),
        })
    }

    fn see(&self, _: Measured<'_>, world: &World) -> Interrupted {
        let pose = *world.body(self.carrier).position();
        let dark = (0..self.beams.count).filter(|beam| self.is_dark(*beam, &pose, world));
        Interrupted(dark.fold(0, |bits, beam| bits | 1 << beam))
    }

    fn in_words(bound: &Bound, _: &Mechanics) -> String {
        format!("beams at {} bodies", bound.targets.len())
    }
}
