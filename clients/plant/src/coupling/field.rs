//! A field that bodies are in: how many, and where the first of them lies in it.

use onescan_server::client::ClientFault;

use super::touch::{Touched, in_words, keys};
use super::{BindingKey, Targets, Tie, Unbound, Which, target, without_effect};
use crate::model::Bound;
use crate::model::Mechanics;
use crate::pose::to_rpy_deg;
use crate::world::World;
use crate::world::coordinate::Measured;

/// A body, or one shape of it, that is a field and that others of any kind are in.
pub(crate) struct Field(Touched);

/// What is in a field.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct InField {
    pub(crate) targets: Targets,
    /// Where the origin of the first of them is, along the axes of the field's body.
    pub(crate) position_m: [f64; 3],
    /// How far it is turned about the z axis of the field's body.
    pub(crate) turned_deg: f64,
}

impl Tie for Field {
    const NAME: &'static str = "field";
    const KEYS: &'static [BindingKey] = &keys(Which::Any);
    type Seen = InField;
    without_effect!();

    fn bind(bound: &Bound, _: &Mechanics, world: &mut World) -> Result<Self, Unbound> {
        Touched::bind(bound, world).map(Self)
    }

    fn see(&self, _: Measured<'_>, world: &World) -> InField {
        let targets = self.0.see(world);
        let Some(Ok(first)) = targets.first.map(|first| target(self.0.targets.handles(), first)) else {
            return InField { targets, ..InField::default() };
        };
        let between = world.body(self.0.surface.body).position().inv_mul(world.body(first).position());
        let [_, _, turned_deg] = to_rpy_deg(between.rotation);
        InField { targets, position_m: between.translation.to_array(), turned_deg }
    }

    fn in_words(bound: &Bound, scene: &Mechanics) -> String {
        in_words(bound, scene)
    }
}
