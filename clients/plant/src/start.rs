//! The world as a scene begins, for what is asked of it before anything moves.

use onescan_server::time::TimeSpan;

use crate::model::{Driven, Moved};
use crate::scene::Scene;
use crate::world::World;
use crate::world::actuator::Motor;

/// For what does not depend on how long a turn is.
pub(crate) const ANY_PERIOD: TimeSpan = TimeSpan::from_millis(1).expect("not zero");

impl Scene {
    /// The joints that its axes and components drive.
    fn driven_joints(&self) -> impl Iterator<Item = usize> {
        let axes = self.axes.iter().filter_map(|axis| match axis.moved {
            Moved::Joint(joint) => Some(joint),
            Moved::Belt { .. } => None,
        });
        let components = self.components.iter().flat_map(|component| component.bound.driven());
        axes.chain(components.filter_map(Driven::joint))
    }

    /// The bodies that are out of the world at the start, by their places: workpieces that wait for their source.
    pub fn waiting(&self) -> impl Iterator<Item = usize> + '_ {
        let waits = self.components.iter().filter(|component| component.kind.coupling.targets_wait());
        waits.flat_map(|component| component.bound.targets.iter().copied())
    }
}

impl World {
    /// The world of a scene with its mechanisms: joints that something drives have a motor, and workpieces that wait are
    /// out of it.
    pub(crate) fn at_the_start(scene: &Scene, period: TimeSpan) -> Self {
        let mut world = Self::build(scene, period);
        for joint in scene.driven_joints() {
            Motor::bind(joint, None, scene, &mut world);
        }
        for body in scene.waiting() {
            world.leave_out(body);
        }
        world.find_mechanisms();
        world
    }
}
