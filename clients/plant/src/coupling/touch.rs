//! A body, or one shape of it, that other bodies touch.

use onescan_server::client::ClientFault;

use super::{
    BindingKey, Names, Targets, Tie, Unbound, Which, needed, optional, others, sought, wanted, without_effect,
};
use crate::model::Bound;
use crate::model::Mechanics;
use crate::world::coordinate::Measured;
use crate::world::{Sought, Surface, World};

pub(super) const fn keys(named: Which) -> [BindingKey; 3] {
    [
        needed("body", Names::TouchedBody, "body with a shape, which the targets touch"),
        optional("shape", Names::ShapeOfBody, "the one of its `[[shape]]`s that counts; all of it if absent"),
        optional(
            "targets",
            Names::Bodies { named, absent: Which::Dynamic },
            "bodies that count; all dynamic ones but itself if absent",
        ),
    ]
}

const DYNAMIC: [BindingKey; 3] = keys(Which::Dynamic);
const ANY: [BindingKey; 3] = keys(Which::Any);

/// The body that a component names, or the one of its shapes.
pub(super) fn surface(bound: &Bound, world: &mut World) -> Result<Surface, Unbound> {
    let body = world.handle(Some(wanted(bound.body, "body")?));
    Ok(world.surface(body, bound.shape.map(|shape| world.shape(shape))))
}

/// What is touched, and by what.
pub(super) struct Touched {
    pub(super) surface: Surface,
    pub(super) targets: Sought,
}

impl Touched {
    pub(super) fn bind(bound: &Bound, world: &mut World) -> Result<Self, Unbound> {
        Ok(Self { surface: surface(bound, world)?, targets: sought(world, &bound.targets) })
    }

    pub(super) fn see(&self, world: &World) -> Targets {
        Targets::touching(world, self.surface, &self.targets, |_| true)
    }
}

pub(super) fn in_words(bound: &Bound, scene: &Mechanics) -> String {
    let body = bound.body.map(|body| &scene.bodies[body].name);
    let name = bound.shape.map(|shape| &scene.shapes[shape].name).or(body);
    name.map_or_else(String::new, |name| format!("{name} and {}", others(bound)))
}

macro_rules! senses {
    ($(#[$doc:meta])* $tie:ident, $name:literal, $keys:expr) => {
        $(#[$doc])*
        pub(crate) struct $tie(Touched);

        impl Tie for $tie {
            const NAME: &'static str = $name;
            const KEYS: &'static [BindingKey] = &$keys;
            type Seen = Targets;
            without_effect!();

            fn bind(bound: &Bound, _: &Mechanics, world: &mut World) -> Result<Self, Unbound> {
                Touched::bind(bound, world).map(Self)
            }

            fn see(&self, _: Measured<'_>, world: &World) -> Targets {
                self.0.see(world)
            }

            fn in_words(bound: &Bound, scene: &Mechanics) -> String {
                in_words(bound, scene)
            }
        }
    };
}

senses! {
    /// A body that dynamic bodies touch, or one shape of it.
    Touch, "touch", DYNAMIC
}

senses! {
    /// A body that other bodies of any kind touch, or one shape of it.
    Contact, "contact", ANY
}
