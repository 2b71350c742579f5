//! The surface of a body: one component gives its temperature, another says how it is bent, others look at it.

use onescan_server::client::ClientFault;

use super::{BindingKey, Names, Tie, Unbound, needed, optional, wanted, without_effect};
use crate::bend::Bend;
use crate::model::Bound;
use crate::model::Mechanics;
use crate::temperature_field::TemperatureField;
use crate::world::World;
use crate::world::coordinate::Measured;

/// Gives the temperature of a body's surface.
pub(crate) struct Heats {
    body: usize,
}

/// Says how a body's surface is bent, if it names a body.
pub(crate) struct Bends {
    body: Option<usize>,
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

impl Tie for Bends {
    const NAME: &'static str = "bent surface";
    const KEYS: &'static [BindingKey] = &[optional(
        "body",
        Names::Body,
        "body whose surface is bent; if absent, nobody who looks at a surface sees the bend",
    )];
    type Seen = ();
    type Effect = Bend;
    type Memory = ();

    fn bind(bound: &Bound, _: &Mechanics, _: &mut World) -> Result<Self, Unbound> {
        Ok(Self { body: bound.body })
    }

    fn see(&self, _: Measured<'_>, _: &World) {}

    fn apply(&mut self, bend: Bend, _: Measured<'_>, _: f64, world: &mut World) -> Result<(), ClientFault> {
        if let Some(body) = self.body {
            world.bend(body, bend);
        }
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
