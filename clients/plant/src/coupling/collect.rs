//! A body that takes out of the world what touches it and is not held.

use onescan_server::client::ClientFault;

use super::{BindingKey, Names, Targets, Tie, Unbound, Which, needed, optional, others, sought, target, wanted};
use crate::model::Bound;
use crate::model::Mechanics;
use crate::world::coordinate::Measured;
use crate::world::{Sought, Surface, World};

/// A body, and what it may take; what hangs on a joint is not seen, since somebody still holds it.
pub(crate) struct Collect {
    surface: Surface,
    targets: Sought,
}

/// Takes a target out of the world, by its place among the targets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Remove(pub(crate) Option<u32>);

impl Tie for Collect {
    const NAME: &'static str = "collect";
    const KEYS: &'static [BindingKey] = &[
        needed("body", Names::TouchedBody, "body with a shape, which the targets touch"),
        optional(
            "targets",
            Names::Bodies { named: Which::Dynamic, absent: Which::Dynamic },
            "bodies that count; all dynamic ones but itself if absent",
        ),
    ];
    type Seen = Targets;
    type Effect = Remove;
    type Memory = ();

    fn bind(bound: &Bound, _: &Mechanics, world: &mut World) -> Result<Self, Unbound> {
        let body = world.handle(Some(wanted(bound.body, "body")?));
        Ok(Self { surface: world.surface(body, None), targets: sought(world, &bound.targets) })
    }

    fn see(&self, _: Measured<'_>, world: &World) -> Targets {
        Targets::touching(world, self.surface, &self.targets, |target| !world.hangs(target))
    }

    fn apply(&mut self, Remove(taken): Remove, _: Measured<'_>, _: f64, world: &mut World) -> Result<(), ClientFault> {
        match taken {
            None => Ok(()),
            Some(place) => world.take_out(target(self.targets.handles(), place)?),
        }
    }

    fn memory(&self) {}

    fn restore(&mut self, (): ()) {}

    fn in_words(bound: &Bound, scene: &Mechanics) -> String {
        let name = bound.body.map(|body| &scene.bodies[body].name);
        name.map_or_else(String::new, |name| format!("body {name} takes {}", others(bound)))
    }
}
