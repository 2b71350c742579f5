//! Bodies that may meet each other.

use onescan_server::client::ClientFault;
use rapier3d::prelude::RigidBodyHandle;

use super::{BindingKey, Names, Tie, Unbound, Which, handles, optional, without_effect};
use crate::model::Bound;
use crate::model::Mechanics;
use crate::world::World;
use crate::world::coordinate::Measured;

/// Bodies that may meet each other; what is seen is how many pairs of them do.
pub(crate) struct Meet {
    /// In rising order of their handles, as the world counts pairs.
    targets: Vec<RigidBodyHandle>,
}

impl Tie for Meet {
    const NAME: &'static str = "meet";
    const KEYS: &'static [BindingKey] = &[optional(
        "targets",
        Names::Bodies { named: Which::Any, absent: Which::Dynamic },
        "bodies that count, of any kind, though two that are not dynamic do not meet; all dynamic ones if absent",
    )];
    type Seen = u32;
    without_effect!();

    fn bind(bound: &Bound, _: &Mechanics, world: &mut World) -> Result<Self, Unbound> {
        let mut targets = handles(world, &bound.targets);
        targets.sort_unstable_by_key(|target| target.0);
        targets.dedup();
        if !targets.iter().all(|target| world.body(*target).is_dynamic()) {
            world.watch(&targets);
        }
        Ok(Self { targets })
    }

    fn see(&self, _: Measured<'_>, world: &World) -> u32 {
        world.contacts_among(&self.targets)
    }

    fn in_words(bound: &Bound, _: &Mechanics) -> String {
        let mut targets = bound.targets.clone();
        targets.sort_unstable();
        targets.dedup();
        format!("{} bodies among each other", targets.len())
    }
}
