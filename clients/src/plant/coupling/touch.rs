//! A body, or one shape of it, that other bodies touch; a component may hold one of them fast.

use onescan_server::client::ClientFault;
use rapier3d::prelude::{ImpulseJointHandle, RigidBodyHandle};
use serde::{Deserialize, Serialize};

use super::{
    BindingKey, Names, Targets, Tie, Unbound, Which, handles, needed, optional, target, wanted, without_effect,
};
use crate::plant::coordinate::Measured;
use crate::plant::scene::Scene;
use crate::plant::scene::model::Bound;
use crate::plant::world::{Surface, World};

const fn keys(named: Which) -> [BindingKey; 3] {
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

/// What is touched, and by what.
struct Touched {
    surface: Surface,
    targets: Vec<RigidBodyHandle>,
}

impl Touched {
    fn bind(bound: &Bound, world: &World) -> Result<Self, Unbound> {
        let body = world.handle(Some(wanted(bound.body, "body")?));
        let surface = Surface { body, shape: bound.shape.map(|shape| world.shape(shape)) };
        Ok(Self { surface, targets: handles(world, &bound.targets) })
    }

    fn see(&self, world: &World) -> Targets {
        Targets::see(&self.targets, |target| world.touch(self.surface, target))
    }
}

fn in_words(bound: &Bound, scene: &Scene) -> String {
    let body = bound.body.map(|body| &scene.bodies[body].name);
    let name = bound.shape.map(|shape| &scene.shapes[shape].name).or(body);
    name.map_or_else(String::new, |name| format!("{name} and {} others", bound.targets.len()))
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

            fn bind(bound: &Bound, _: &Scene, world: &mut World) -> Result<Self, Unbound> {
                Touched::bind(bound, world).map(Self)
            }

            fn see(&self, _: Measured<'_>, world: &World) -> Targets {
                self.0.see(world)
            }

            fn in_words(bound: &Bound, scene: &Scene) -> String {
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

/// A body that dynamic bodies touch, or one shape of it, and that holds one of them.
pub(crate) struct Holds {
    touched: Touched,
    held: Option<Held>,
}

/// Holds a target fast, by its place among the targets; releases any other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Hold(pub(crate) Option<u32>);

/// A body that is held, and by which joint.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Held {
    target: u32,
    joint: ImpulseJointHandle,
}

impl Tie for Holds {
    const NAME: &'static str = "touch";
    const KEYS: &'static [BindingKey] = &DYNAMIC;
    type Seen = Targets;
    type Effect = Hold;
    type Memory = Option<Held>;

    fn bind(bound: &Bound, _: &Scene, world: &mut World) -> Result<Self, Unbound> {
        Ok(Self { touched: Touched::bind(bound, world)?, held: None })
    }

    fn see(&self, _: Measured<'_>, world: &World) -> Targets {
        self.touched.see(world)
    }

    fn apply(&mut self, Hold(wanted): Hold, _: Measured<'_>, _: f64, world: &mut World) -> Result<(), ClientFault> {
        if self.held.map(|held| held.target) == wanted {
            return Ok(());
        }
        if let Some(held) = self.held.take() {
            world.let_go(held.joint)?;
        }
        if let Some(place) = wanted {
            let joint = world.hold(self.touched.surface.body, target(&self.touched.targets, place)?);
            self.held = Some(Held { target: place, joint });
        }
        Ok(())
    }

    fn memory(&self) -> Option<Held> {
        self.held
    }

    fn restore(&mut self, held: Option<Held>) {
        self.held = held;
    }

    fn in_words(bound: &Bound, scene: &Scene) -> String {
        in_words(bound, scene)
    }
}
