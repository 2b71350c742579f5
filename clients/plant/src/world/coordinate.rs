//! Where a joint stands, measured from the poses of its two bodies.
//!
//! A coordinate is what the scene calls `initial_m` or `initial_rad` in the scene's pose. It grows
//! along the joint's axis for a prismatic joint, along its slide for a slot, and with rotation about
//! its axis by the right hand for a revolute joint, of which it counts the turns.

use std::f64::consts::{PI, TAU};

use rapier3d::math::Pose;
use rapier3d::prelude::{RigidBodyHandle, RigidBodySet};

use super::{World, local_frames};
use crate::effort::Mark;
use crate::model::{Joint, JointKind};

/// The joints as they were measured last, in the scene's order.
#[derive(Clone, Copy)]
pub(crate) struct Measured<'m> {
    pub(crate) motions: &'m [Mark],
}

/// How a joint is measured.
pub(crate) struct Gauge {
    kind: JointKind,
    parent: RigidBodyHandle,
    child: RigidBodyHandle,
    parent_frame: Pose,
    child_frame: Pose,
    initial: f64,
}

impl Gauge {
    /// The gauge of a joint in a world that still stands in the scene's pose.
    pub(crate) fn new(world: &World, joint: &Joint) -> Self {
        let (parent, child) = (world.handle(joint.parent), world.handle(Some(joint.child)));
        let [parent_frame, child_frame] = local_frames(&world.physics, joint, parent, child);
        Self { kind: joint.kind, parent, child, parent_frame, child_frame, initial: joint.initial }
    }

    /// The joint's coordinate in m or rad; `last` is the one measured a period ago, which distinguishes a
    /// turn from the next. Zero for a joint without a coordinate.
    pub(crate) fn position(&self, bodies: &RigidBodySet, last: f64) -> f64 {
        let parent = *bodies[self.parent].position() * self.parent_frame;
        let child = *bodies[self.child].position() * self.child_frame;
        let between = parent.inv_mul(&child);
        match self.kind {
            JointKind::Prismatic => self.initial + between.translation.x,
            JointKind::Slot => self.initial + between.translation.y,
            JointKind::Revolute => {
                let turned = 2.0 * libm::atan2(between.rotation.x, between.rotation.w);
                nearest_turn(self.initial + turned, last)
            }
            JointKind::Fixed | JointKind::Ball => 0.0,
        }
    }

    /// The velocity of the joint's coordinate in m/s or rad/s.
    pub(crate) fn velocity(&self, bodies: &RigidBodySet) -> f64 {
        let (parent, child) = (&bodies[self.parent], &bodies[self.child]);
        let frame = *parent.position() * self.parent_frame;
        let point = (*child.position() * self.child_frame).translation;
        let linear = || child.velocity_at_point(point) - parent.velocity_at_point(point);
        match self.kind {
            JointKind::Prismatic => linear().dot(frame.rotation * rapier3d::math::Vector::X),
            JointKind::Slot => linear().dot(frame.rotation * rapier3d::math::Vector::Y),
            JointKind::Revolute => (child.angvel() - parent.angvel()).dot(frame.rotation * rapier3d::math::Vector::X),
            JointKind::Fixed | JointKind::Ball => 0.0,
        }
    }
}

/// The angle that is `angle` except for whole turns and lies within half a turn of `last`.
pub(crate) fn nearest_turn(angle: f64, last: f64) -> f64 {
    let apart = angle - last;
    if apart.abs() <= PI { angle } else { angle - TAU * (apart / TAU).round() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_are_counted() {
        assert_eq!(nearest_turn(0.5, 0.4), 0.5);
        assert!((nearest_turn(-3.1, 3.1) - (TAU - 3.1)).abs() < 1e-12);
        assert!((nearest_turn(0.1, 20.0 * TAU) - (20.0 * TAU + 0.1)).abs() < 1e-12);
        assert!((nearest_turn(3.1, -20.0 * TAU - 3.1) - (-21.0 * TAU + 3.1)).abs() < 1e-12);
    }
}
