//! A joint that a component moves, or that it measures.

use onescan_server::client::ClientFault;

use super::{BindingKey, Names, Tie, Unbound, needed, optional, wanted, without_effect};
use crate::plant::coordinate::Measured;
use crate::plant::motor::Motor;
use crate::plant::scene::Scene;
use crate::plant::scene::model::{Bound, Driven, JointKind};
use crate::plant::world::World;

/// Coordinate of a joint and its velocity, in m or rad and per second.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Coordinate {
    pub(crate) position: f64,
    pub(crate) velocity: f64,
}

impl Coordinate {
    fn initial(joint: usize, scene: &Scene) -> Self {
        Self { position: scene.joints[joint].initial, velocity: 0.0 }
    }

    fn measured(joint: usize, measured: Measured<'_>, world: &World) -> Self {
        Self { position: measured.positions[joint], velocity: measured.gauges[joint].velocity(world) }
    }
}

/// Moves the joint from one coordinate to another, with an effort up to the greatest, N or N·m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Move {
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) effort_max: f64,
}

/// A joint that a component moves and measures; without one it moves by itself.
struct Moves(Option<(Motor, Coordinate)>);

impl Moves {
    fn bind(bound: &Bound, scene: &Scene, world: &mut World) -> Result<Self, Unbound> {
        match bound.drives {
            None => Ok(Self(None)),
            Some(Driven::Joint(joint)) => {
                let motor = Motor::bind(joint, None, scene, world);
                Ok(Self(Some((motor, Coordinate::initial(joint, scene)))))
            }
            Some(Driven::Belt(_)) => Err(Unbound("joint")),
        }
    }

    fn see(&self, measured: Measured<'_>, world: &World) -> Option<Coordinate> {
        self.0.as_ref().map(|(motor, _)| Coordinate::measured(motor.joint(), measured, world))
    }

    fn apply(
        &self,
        Move { from, to, effort_max }: Move,
        measured: Measured<'_>,
        dt_s: f64,
        world: &mut World,
    ) -> Result<(), ClientFault> {
        match &self.0 {
            None => Ok(()),
            Some((motor, _)) => motor.follow([from, to], measured, dt_s, Some(effort_max), world),
        }
    }
}

fn drives_in_words(bound: &Bound, scene: &Scene) -> String {
    match bound.drives {
        Some(Driven::Joint(joint)) => format!("drives joint {}", scene.joints[joint].name),
        Some(Driven::Belt(_)) | None => String::new(),
    }
}

macro_rules! moves {
    ($(#[$doc:meta])* $tie:ident, $name:literal, $kind:expr, $about:literal) => {
        $(#[$doc])*
        pub(crate) struct $tie(Moves);

        impl Tie for $tie {
            const NAME: &'static str = $name;
            const KEYS: &'static [BindingKey] = &[optional("joint", Names::DrivenJoint($kind), $about)];
            type Seen = Option<Coordinate>;
            type Effect = Move;
            type Memory = ();

            fn bind(bound: &Bound, scene: &Scene, world: &mut World) -> Result<Self, Unbound> {
                Moves::bind(bound, scene, world).map(Self)
            }

            fn at_start(&self) -> Option<Coordinate> {
                self.0.0.as_ref().map(|(_, initial)| *initial)
            }

            fn see(&self, measured: Measured<'_>, world: &World) -> Option<Coordinate> {
                self.0.see(measured, world)
            }

            fn apply(
                &mut self,
                effect: Move,
                measured: Measured<'_>,
                dt_s: f64,
                world: &mut World,
            ) -> Result<(), ClientFault> {
                self.0.apply(effect, measured, dt_s, world)
            }

            fn memory(&self) {}

            fn restore(&mut self, (): ()) {}

            fn in_words(bound: &Bound, scene: &Scene) -> String {
                drives_in_words(bound, scene)
            }
        }
    };
}

moves! {
    /// A prismatic joint that a component moves, or nothing: then it moves by itself.
    Slides, "slides", JointKind::Prismatic, "prismatic joint that it moves; by itself if absent"
}

moves! {
    /// A revolute joint that a component turns, or nothing: then it turns by itself.
    Turns, "turns", JointKind::Revolute, "revolute joint that it turns; by itself if absent"
}

/// A joint that a component measures.
pub(crate) struct Measures {
    joint: usize,
    initial: Coordinate,
}

impl Tie for Measures {
    const NAME: &'static str = "measures";
    const KEYS: &'static [BindingKey] =
        &[needed("joint", Names::MeasuredJoint, "prismatic, revolute or slot joint that it measures")];
    type Seen = Coordinate;
    without_effect!();

    fn bind(bound: &Bound, scene: &Scene, _: &mut World) -> Result<Self, Unbound> {
        let joint = wanted(bound.measures, "joint")?;
        Ok(Self { joint, initial: Coordinate::initial(joint, scene) })
    }

    fn at_start(&self) -> Coordinate {
        self.initial
    }

    fn see(&self, measured: Measured<'_>, world: &World) -> Coordinate {
        Coordinate::measured(self.joint, measured, world)
    }

    fn in_words(bound: &Bound, scene: &Scene) -> String {
        bound.measures.map_or_else(String::new, |joint| format!("measures joint {}", scene.joints[joint].name))
    }
}
