//! A body at whose place other bodies appear.

use onescan_server::client::ClientFault;

use super::{BindingKey, Names, Targets, Tie, Unbound, Which, needed, sought, target, wanted};
use crate::model::Bound;
use crate::model::Mechanics;
use crate::world::coordinate::Measured;
use crate::world::{Sought, Surface, World};

/// A body, and what appears at its place. What is seen is how many wait out of the world; the first
/// of them only while no target is in the way.
pub(crate) struct Place {
    surface: Surface,
    targets: Sought,
}

/// Puts a target into the world, by its place among the targets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Put(pub(crate) Option<u32>);

impl Tie for Place {
    const NAME: &'static str = "place";
    const KEYS: &'static [BindingKey] = &[
        needed(
            "body",
            Names::Body,
            "body at whose place the targets appear; if it has a shape, only when nothing is in it",
        ),
        needed(
            "targets",
            Names::Bodies { named: Which::Dynamic, absent: Which::Dynamic },
            "dynamic bodies with a shape, out of the world until they appear",
        ),
    ];
    const TARGETS_WAIT: bool = true;
    type Seen = Targets;
    type Effect = Put;
    type Memory = ();

    fn bind(bound: &Bound, _: &Mechanics, world: &mut World) -> Result<Self, Unbound> {
        let body = world.handle(Some(wanted(bound.body, "body")?));
        let targets = sought(world, &bound.targets);
        for target in targets.handles() {
            world.take_out(*target).map_err(|_| Unbound("target in the world"))?;
        }
        Ok(Self { surface: world.surface(body, None), targets })
    }

    fn see(&self, _: Measured<'_>, world: &World) -> Targets {
        let mut seen = Targets::default();
        for (place, target) in (0_u32..).zip(self.targets.handles()) {
            if !world.body(*target).is_enabled() {
                seen.note(place);
            }
        }
        let in_the_way = Targets::touching(world, self.surface, &self.targets, |_| true);
        Targets { first: seen.first.filter(|_| in_the_way.count == 0), ..seen }
    }

    fn apply(&mut self, Put(placed): Put, _: Measured<'_>, _: f64, world: &mut World) -> Result<(), ClientFault> {
        match placed {
            None => Ok(()),
            Some(place) => world.put_in(target(self.targets.handles(), place)?, self.surface.body),
        }
    }

    fn memory(&self) {}

    fn restore(&mut self, (): ()) {}

    fn in_words(bound: &Bound, scene: &Mechanics) -> String {
        let name = bound.body.map(|body| &scene.bodies[body].name);
        name.map_or_else(String::new, |name| format!("{} bodies at {name}", bound.targets.len()))
    }
}
