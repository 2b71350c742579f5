//! A body whose surface a component runs, while the body stays in place.

use onescan_server::client::ClientFault;
use rapier3d::math::Vector;
use rapier3d::prelude::RigidBodyHandle;

use super::{BindingKey, Names, Tie, Unbound, needed, wanted};
use crate::model::Mechanics;
use crate::model::{Bound, Driven};
use crate::world::World;
use crate::world::coordinate::Measured;

/// A kinematic body whose surface a component runs.
pub(crate) struct Belt {
    body: RigidBodyHandle,
    direction: Vector,
}

/// Runs the surface along the belt's direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Run {
    pub(crate) velocity_m_s: f64,
}

fn belt(bound: &Bound) -> Option<usize> {
    match bound.drives {
        Some(Driven::Belt(body)) => Some(body),
        Some(Driven::Joint(_)) | None => None,
    }
}

impl Tie for Belt {
    const NAME: &'static str = "belt";
    const KEYS: &'static [BindingKey] = &[
        needed("belt", Names::Belt, "kinematic body whose surface runs, while it stays in place itself"),
        needed("direction", Names::Direction, "along which the surface runs, of any length"),
    ];
    type Seen = ();
    type Effect = Run;
    type Memory = ();

    fn bind(bound: &Bound, _: &Mechanics, world: &mut World) -> Result<Self, Unbound> {
        let body = world.handle(Some(wanted(belt(bound), "belt")?));
        let direction = Vector::from_array(wanted(bound.direction, "direction")?);
        world.keep_in_place(body);
        Ok(Self { body, direction })
    }

    fn see(&self, _: Measured<'_>, _: &World) {}

    fn apply(&mut self, effect: Run, _: Measured<'_>, _: f64, world: &mut World) -> Result<(), ClientFault> {
        world.run(self.body, self.direction * effect.velocity_m_s)
    }

    fn memory(&self) {}

    fn restore(&mut self, (): ()) {}

    fn in_words(bound: &Bound, scene: &Mechanics) -> String {
        belt(bound).map_or_else(String::new, |body| format!("belt {}", scene.bodies[body].name))
    }
}
