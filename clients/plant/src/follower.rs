//! A joint that follows another, as the fingers of a gripper follow the one that is driven: `factor` times
//! the other's coordinate, and `offset`. In a mechanism the two are coupled, and what holds one holds the
//! other. Where the engine moves the joints, as in a loop or on a base that floats, a motor leads the
//! follower: what holds it does not hold its leader then.

use onescan_server::client::ClientFault;

use super::effort::{Mark, Path};
use super::model::Follows;
use super::model::Mechanics;
use super::setpoint::Setpoint;
use super::world::World;
use super::world::actuator::Motor;
use super::world::coordinate::Measured;

/// A joint that follows another.
pub(super) struct Follower {
    motor: Motor,
    follows: Follows,
}

impl Follower {
    /// The joints of a scene that follow others; their motors hold them where they are.
    pub(super) fn all(scene: &Mechanics, world: &mut World) -> Vec<Self> {
        let follows =
            scene.joints.iter().enumerate().filter_map(|(joint, described)| Some((joint, described.follows?)));
        follows.map(|(joint, follows)| Self { motor: Motor::bind(joint, None, scene, world), follows }).collect()
    }

    /// Follows for a period, with the velocity that the other joint has at its beginning.
    ///
    /// # Errors
    /// A joint that the world does not have, which no checked scene causes.
    pub(super) fn drive(&self, measured: Measured<'_>, dt_s: f64, world: &mut World) -> Result<(), ClientFault> {
        let Follows { joint, factor, offset } = self.follows;
        let Mark { position, velocity } = measured.motions[joint];
        let (position, velocity) = (factor * position + offset, factor * velocity);
        let from = Setpoint { position, velocity };
        let to = Setpoint { position: position + velocity * dt_s, velocity };
        let most = if world.keeps(self.motor.joint()) { 0.0 } else { f64::INFINITY };
        self.motor.follow(Path { from, to, turn_s: dt_s }, Some(most), world)
    }
}
