//! A joint that a component moves, or that it measures.

use onescan_server::client::ClientFault;

use super::{BindingKey, DrivenJoint, Names, Tie, Unbound, needed, optional, wanted, without_effect};
use crate::effort::{Mark, Path};
use crate::model::Mechanics;
use crate::model::{Bound, Driven, JointKind};
use crate::setpoint::Setpoint;
use crate::world::World;
use crate::world::actuator::Motor;
use crate::world::coordinate::Measured;

/// Coordinate of a joint and its velocity, in m or rad and per second.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Coordinate {
    pub(crate) position: f64,
    pub(crate) velocity: f64,
}

impl Coordinate {
    fn initial(joint: usize, scene: &Mechanics) -> Self {
        Self { position: scene.joints[joint].initial, velocity: 0.0 }
    }

    fn measured(joint: usize, measured: Measured<'_>) -> Self {
        let Mark { position, velocity } = measured.motions[joint];
        Self { position, velocity }
    }
}

/// Moves the joint along a path, with an effort up to the greatest, N or N·m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Follow {
    pub(crate) from: Setpoint,
    pub(crate) to: Setpoint,
    pub(crate) effort_max: f64,
}

/// A joint that a component moves and measures; without one it moves by itself.
struct Moves(Option<(Motor, Coordinate)>);

impl Moves {
    fn bind(bound: &Bound, scene: &Mechanics, world: &mut World) -> Result<Self, Unbound> {
        match bound.drives {
            None => Ok(Self(None)),
            Some(Driven::Joint(joint)) => {
                let motor = Motor::bind(joint, None, scene, world);
                Ok(Self(Some((motor, Coordinate::initial(joint, scene)))))
            }
            Some(Driven::Belt(_)) => Err(Unbound("joint")),
        }
    }

    /// As [`bind`](Self::bind), for a component that drives by its own equations.
    fn bind_law(bound: &Bound, scene: &Mechanics, world: &mut World) -> Result<Self, Unbound> {
        let bound = Self::bind(bound, scene, world)?;
        if let Some((motor, _)) = &bound.0 {
            motor.obey(world);
        }
        Ok(bound)
    }

    fn at_start(&self) -> Option<Coordinate> {
        self.0.as_ref().map(|(_, initial)| *initial)
    }

    fn see(&self, measured: Measured<'_>) -> Option<Coordinate> {
        self.0.as_ref().map(|(motor, _)| Coordinate::measured(motor.joint(), measured))
    }

    fn driven(&self) -> Option<DrivenJoint> {
        self.0.as_ref().map(|(motor, _)| DrivenJoint { joint: motor.joint(), drive: motor.number() })
    }
}

pub(super) fn drives_in_words(bound: &Bound, scene: &Mechanics) -> String {
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
            without_effect!();

            fn bind(bound: &Bound, scene: &Mechanics, world: &mut World) -> Result<Self, Unbound> {
                Moves::bind_law(bound, scene, world).map(Self)
            }

            fn at_start(&self) -> Option<Coordinate> {
                self.0.at_start()
            }

            fn see(&self, measured: Measured<'_>, _: &World) -> Option<Coordinate> {
                self.0.see(measured)
            }

            fn driven(&self) -> Option<DrivenJoint> {
                self.0.driven()
            }

            fn in_words(bound: &Bound, scene: &Mechanics) -> String {
                drives_in_words(bound, scene)
            }
        }
    };
}

moves! {
    /// A prismatic joint that a component moves by its equations, or nothing: then it moves by itself.
    Slides, "slides", JointKind::Prismatic, "prismatic joint that it moves; by itself if absent"
}

moves! {
    /// A revolute joint that a component turns by its equations, or nothing: then it turns by itself.
    Turns, "turns", JointKind::Revolute, "revolute joint that it turns; by itself if absent"
}

/// A revolute joint that a component turns along a path, or nothing: then it turns by itself.
pub(crate) struct Indexes(Moves);

impl Tie for Indexes {
    const NAME: &'static str = "turns";
    const KEYS: &'static [BindingKey] = Turns::KEYS;
    type Seen = Option<Coordinate>;
    type Effect = Follow;
    type Memory = ();

    fn bind(bound: &Bound, scene: &Mechanics, world: &mut World) -> Result<Self, Unbound> {
        Moves::bind(bound, scene, world).map(Self)
    }

    fn at_start(&self) -> Option<Coordinate> {
        self.0.at_start()
    }

    fn see(&self, measured: Measured<'_>, _: &World) -> Option<Coordinate> {
        self.0.see(measured)
    }

    fn apply(&mut self, effect: Follow, _: Measured<'_>, dt_s: f64, world: &mut World) -> Result<(), ClientFault> {
        let Follow { from, to, effort_max } = effect;
        match &self.0.0 {
            None => Ok(()),
            Some((motor, _)) => motor.follow(Path { from, to, turn_s: dt_s }, Some(effort_max), world),
        }
    }

    fn memory(&self) {}

    fn restore(&mut self, (): ()) {}

    fn in_words(bound: &Bound, scene: &Mechanics) -> String {
        drives_in_words(bound, scene)
    }
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

    fn bind(bound: &Bound, scene: &Mechanics, _: &mut World) -> Result<Self, Unbound> {
        let joint = wanted(bound.measures, "joint")?;
        Ok(Self { joint, initial: Coordinate::initial(joint, scene) })
    }

    fn at_start(&self) -> Coordinate {
        self.initial
    }

    fn see(&self, measured: Measured<'_>, _: &World) -> Coordinate {
        Coordinate::measured(self.joint, measured)
    }

    fn in_words(bound: &Bound, scene: &Mechanics) -> String {
        bound.measures.map_or_else(String::new, |joint| format!("measures joint {}", scene.joints[joint].name))
    }
}
