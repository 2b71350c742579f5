//! A field in which the radio tags of bodies are read and written. The memory of a tag belongs to its body: every head
//! that the body comes to finds what another has written.

use onescan_server::client::ClientFault;

use super::touch::{Touched, in_words, keys};
use super::{BindingKey, Targets, Tie, Unbound, Which, target};
use crate::model::Bound;
use crate::model::Mechanics;
use crate::world::World;
use crate::world::coordinate::Measured;

/// A body, or one shape of it, that is the field of a head.
pub(crate) struct Tags(Touched);

/// The tags in a field.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct InTags {
    pub(crate) targets: Targets,
    /// What the tag of the first of them holds.
    pub(crate) data: i32,
}

/// Writes the tag of a target, by its place among the targets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct WriteTag(pub(crate) Option<(u32, i32)>);

impl Tie for Tags {
    const NAME: &'static str = "tags";
    const KEYS: &'static [BindingKey] = &keys(Which::Any);
    type Seen = InTags;
    type Effect = WriteTag;
    type Memory = ();

    fn bind(bound: &Bound, _: &Mechanics, world: &mut World) -> Result<Self, Unbound> {
        Touched::bind(bound, world).map(Self)
    }

    fn see(&self, _: Measured<'_>, world: &World) -> InTags {
        let targets = self.0.see(world);
        let first = targets.first.and_then(|first| self.0.targets.handles().get(first as usize));
        InTags { targets, data: first.map_or(0, |first| world.tag(*first)) }
    }

    fn apply(
        &mut self,
        WriteTag(written): WriteTag,
        _: Measured<'_>,
        _: f64,
        world: &mut World,
    ) -> Result<(), ClientFault> {
        match written {
            None => Ok(()),
            Some((place, data)) => world.write_tag(target(self.0.targets.handles(), place)?, data),
        }
    }

    fn memory(&self) {}

    fn restore(&mut self, (): ()) {}

    fn in_words(bound: &Bound, scene: &Mechanics) -> String {
        in_words(bound, scene)
    }
}
