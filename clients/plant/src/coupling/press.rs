//! A body, or one shape of it, on which other bodies press.

use onescan_server::client::ClientFault;
use rapier3d::prelude::RigidBodyHandle;

use super::touch::{in_words, keys, surface};
use super::{BindingKey, Tie, Unbound, Which, handles, without_effect};
use crate::model::Bound;
use crate::model::Mechanics;
use crate::world::coordinate::Measured;
use crate::world::{Surface, World};

/// What is pressed on, and by what.
pub(crate) struct Weighs {
    surface: Surface,
    /// In rising order of their handles, as the world looks for them.
    targets: Vec<RigidBodyHandle>,
}

/// How much presses.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Pressing {
    /// The mass whose weight it is.
    pub(crate) kg: f64,
}

impl Tie for Weighs {
    const NAME: &'static str = "weighs";
    const KEYS: &'static [BindingKey] = &keys(Which::Dynamic);
    type Seen = Pressing;
    without_effect!();

    fn bind(bound: &Bound, _: &Mechanics, world: &mut World) -> Result<Self, Unbound> {
        let surface = surface(bound, world)?;
        let mut targets = handles(world, &bound.targets);
        targets.sort_unstable_by_key(|target| target.0);
        targets.dedup();
        // one that sleeps does not press
        world.watch(&targets);
        Ok(Self { surface, targets })
    }

    fn see(&self, _: Measured<'_>, world: &World) -> Pressing {
        Pressing { kg: world.pressed_kg(self.surface, &self.targets) }
    }

    fn in_words(bound: &Bound, scene: &Mechanics) -> String {
        in_words(bound, scene)
    }
}
