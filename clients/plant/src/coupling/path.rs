//! Prismatic joints that a component moves along paths, and the force that each of them takes.

use onescan_server::client::ClientFault;

use super::joint::drives_in_words;
use super::{BindingKey, Follow, Names, Slides, Tie, Unbound, needed, wanted};
use crate::effort::{Mark, Path};
use crate::model::Mechanics;
use crate::model::{Bound, Driven, JointKind};
use crate::world::World;
use crate::world::actuator::Motor;
use crate::world::coordinate::Measured;

/// Where a joint is, and the force on it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Carried {
    /// m
    pub(crate) position: f64,
    /// What moving or holding it took in the last step, N, along the coordinate.
    pub(crate) force_n: f64,
}

/// A joint that follows a path.
struct Guide {
    motor: Motor,
    initial: f64,
}

impl Guide {
    fn bind(joint: usize, scene: &Mechanics, world: &mut World) -> Self {
        Self { motor: Motor::bind(joint, None, scene, world), initial: scene.joints[joint].initial }
    }

    fn at_start(&self) -> Carried {
        Carried { position: self.initial, force_n: 0.0 }
    }

    fn see(&self, measured: Measured<'_>, world: &World) -> Carried {
        let Mark { position, .. } = measured.motions[self.motor.joint()];
        Carried { position, force_n: self.motor.effort(world) }
    }

    fn follow(
        &self,
        Follow { from, to, effort_max }: Follow,
        turn_s: f64,
        world: &mut World,
    ) -> Result<(), ClientFault> {
        self.motor.follow(Path { from, to, turn_s }, Some(effort_max), world)
    }
}

/// A prismatic joint that a component moves along a path, or nothing: then it moves by itself.
pub(crate) struct Lifts(Option<Guide>);

impl Tie for Lifts {
    const NAME: &'static str = "slides";
    const KEYS: &'static [BindingKey] = Slides::KEYS;
    type Seen = Option<Carried>;
    type Effect = Follow;
    type Memory = ();

    fn bind(bound: &Bound, scene: &Mechanics, world: &mut World) -> Result<Self, Unbound> {
        match bound.drives {
            None => Ok(Self(None)),
            Some(Driven::Joint(joint)) => Ok(Self(Some(Guide::bind(joint, scene, world)))),
            Some(Driven::Belt(_)) => Err(Unbound("joint")),
        }
    }

    fn at_start(&self) -> Option<Carried> {
        self.0.as_ref().map(Guide::at_start)
    }

    fn see(&self, measured: Measured<'_>, world: &World) -> Option<Carried> {
        self.0.as_ref().map(|guide| guide.see(measured, world))
    }

    fn driven(&self) -> Option<super::DrivenJoint> {
        let motor = &self.0.as_ref()?.motor;
        Some(super::DrivenJoint { joint: motor.joint(), drive: motor.number() })
    }

    fn apply(&mut self, effect: Follow, _: Measured<'_>, dt_s: f64, world: &mut World) -> Result<(), ClientFault> {
        self.0.as_ref().map_or(Ok(()), |guide| guide.follow(effect, dt_s, world))
    }

    fn memory(&self) {}

    fn restore(&mut self, (): ()) {}

    fn in_words(bound: &Bound, scene: &Mechanics) -> String {
        drives_in_words(bound, scene)
    }
}

/// The three axes of a machine that stores: travel, lift and fork.
pub(crate) struct Stores([Guide; 3]);

impl Tie for Stores {
    const NAME: &'static str = "stores";
    const KEYS: &'static [BindingKey] = &[
        needed("travel", Names::DrivenJoint(JointKind::Prismatic), "prismatic joint of the machine along its aisle"),
        needed("lift", Names::DrivenBeside(JointKind::Prismatic), "prismatic joint of its carriage, up"),
        needed("fork", Names::DrivenBeside(JointKind::Prismatic), "prismatic joint of its fork, 0 in the middle"),
    ];
    type Seen = Option<[Carried; 3]>;
    type Effect = [Follow; 3];
    type Memory = ();

    fn bind(bound: &Bound, scene: &Mechanics, world: &mut World) -> Result<Self, Unbound> {
        let mut joints = bound.driven().filter_map(Driven::joint);
        let mut next = || wanted(joints.next(), "three joints");
        let [travel, lift, fork] = [next()?, next()?, next()?];
        Ok(Self([travel, lift, fork].map(|joint| Guide::bind(joint, scene, world))))
    }

    fn at_start(&self) -> Option<[Carried; 3]> {
        Some(self.0.each_ref().map(Guide::at_start))
    }

    fn see(&self, measured: Measured<'_>, world: &World) -> Option<[Carried; 3]> {
        Some(self.0.each_ref().map(|guide| guide.see(measured, world)))
    }

    fn apply(&mut self, paths: [Follow; 3], _: Measured<'_>, dt_s: f64, world: &mut World) -> Result<(), ClientFault> {
        self.0.iter().zip(paths).try_for_each(|(guide, path)| guide.follow(path, dt_s, world))
    }

    fn memory(&self) {}

    fn restore(&mut self, (): ()) {}

    fn in_words(bound: &Bound, scene: &Mechanics) -> String {
        let joints = bound.driven().filter_map(Driven::joint);
        let names: Vec<&str> = joints.map(|joint| scene.joints[joint].name.as_str()).collect();
        if names.is_empty() { String::new() } else { format!("drives joints {}", names.join(", ")) }
    }
}
