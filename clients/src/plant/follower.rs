//! A joint that follows another, as the fingers of a gripper follow the one that is driven: `factor` times
//! the other's coordinate, and `offset`. It is led and does not lead: what holds the follower does not
//! hold its leader.

use onescan_server::client::ClientFault;

use super::coordinate::Measured;
use super::motor::Motor;
use super::scene::Scene;
use super::scene::model::Follows;
use super::world::World;

/// A joint that follows another.
pub(super) struct Follower {
    motor: Motor,
    follows: Follows,
}

impl Follower {
    /// The joints of a scene that follow others; their motors hold them where they are.
    pub(super) fn all(scene: &Scene, world: &mut World) -> Vec<Self> {
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
        let from = factor * measured.positions[joint] + offset;
        let to = from + factor * measured.gauges[joint].velocity(world) * dt_s;
        self.motor.follow([from, to], measured, dt_s, None, world)
    }
}
