//! The temperature of a body's surface: one component gives it, others look at it.

use onescan_server::client::ClientFault;

use super::{BindingKey, Names, Tie, Unbound, needed, wanted, without_effect};
use crate::model::Bound;
use crate::model::Mechanics;
use crate::temperature_field::TemperatureField;
use crate::world::World;
use crate::world::coordinate::Measured;

/// Gives the temperature of a body's surface.
pub(crate) struct Heats {
    body: usize,
}

/// Sees the temperature of a body's surface; of a body that nothing heats, that of a room.
pub(crate) struct SeesHeat {
    body: usize,
}

fn in_words(bound: &Bound, scene: &Mechanics) -> String {
    bound.body.map_or_else(String::new, |body| format!("surface of body {}", scene.bodies[body].name))
}

impl Tie for Heats {
    const NAME: &'static str = "heated surface";
    const KEYS: &'static [BindingKey] =
        &[needed("body", Names::Body, "body whose surface it heats; one component a body")];
    type Seen = ();
    type Effect = TemperatureField;
    type Memory = ();

    fn bind(bound: &Bound, _: &Mechanics, _: &mut World) -> Result<Self, Unbound> {
        Ok(Self { body: wanted(bound.body, "body")? })
    }

    fn see(&self, _: Measured<'_>, _: &World) {}

    fn apply(
        &mut self,
        field: TemperatureField,
        _: Measured<'_>,
        _: f64,
        world: &mut World,
    ) -> Result<(), ClientFault> {
        world.heat(self.body, &field);
        Ok(())
    }

    fn memory(&self) {}

    fn restore(&mut self, (): ()) {}

    fn in_words(bound: &Bound, scene: &Mechanics) -> String {
        in_words(bound, scene)
    }
}

impl Tie for SeesHeat {
    const NAME: &'static str = "sight of a surface";
    const KEYS: &'static [BindingKey] = &[needed("body", Names::Body, "body whose surface it looks at")];
    type Seen = TemperatureField;
    without_effect!();

    fn bind(bound: &Bound, _: &Mechanics, _: &mut World) -> Result<Self, Unbound> {
        Ok(Self { body: wanted(bound.body, "body")? })
    }

    fn see(&self, _: Measured<'_>, world: &World) -> TemperatureField {
        world.heat_of(self.body)
    }

    fn in_words(bound: &Bound, scene: &Mechanics) -> String {
        in_words(bound, scene)
    }
}
