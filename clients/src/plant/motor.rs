//! The motor of a joint, as axes and components drive it.

use onescan_server::client::ClientFault;
use rapier3d::prelude::*;

use super::coordinate::Measured;
use super::scene::Scene;
use super::world::{World, measured_axis};

/// The part of the position error that one period corrects. Below 1 the loop settles without
/// overshoot; the smaller, the gentler after a blocked joint comes free.
const CORRECTED_A_PERIOD: f64 = 0.25;
/// The motor's gain per second, so high that only its greatest force limits it.
const MOTOR_GAIN_PER_S: f64 = 1e12;

/// The motor of a prismatic or revolute joint.
pub(super) struct Motor {
    joint: usize,
    handle: ImpulseJointHandle,
    along: JointAxis,
}

impl Motor {
    /// The motor of the joint of an index, which from now on holds it where it is, with an effort up
    /// to the greatest, N or N·m, or with as much as it takes.
    pub(super) fn bind(joint: usize, effort_max: Option<f64>, scene: &Scene, world: &mut World) -> Self {
        let (handle, along) = (world.joint(joint), measured_axis(scene.joints[joint].kind));
        if let Some(joint) = world.physics.impulse_joints.get_mut(handle, true) {
            joint.data.set_motor_model(along, MotorModel::AccelerationBased);
            joint.data.set_motor_velocity(along, 0.0, MOTOR_GAIN_PER_S);
            joint.data.set_motor_max_force(along, effort_max.unwrap_or(Real::MAX));
        }
        Self { joint, handle, along }
    }

    /// Index of the joint in the scene.
    pub(super) fn joint(&self) -> usize {
        self.joint
    }

    /// Moves the joint from one coordinate to another in a period of `dt_s`, and a part of the way
    /// from where it is to where it should be; with a new greatest effort, if there is one.
    ///
    /// # Errors
    /// A joint that the world does not have, which no checked scene causes.
    pub(super) fn follow(
        &self,
        [from, to]: [f64; 2],
        measured: Measured<'_>,
        dt_s: f64,
        effort_max: Option<f64>,
        world: &mut World,
    ) -> Result<(), ClientFault> {
        let correction = CORRECTED_A_PERIOD * (from - measured.positions[self.joint]);
        let velocity = (to - from + correction) / dt_s;
        let joint = world.physics.impulse_joints.get_mut(self.handle, true);
        let joint = joint.ok_or_else(|| ClientFault::new("a driven joint is not in the world"))?;
        joint.data.set_motor_velocity(self.along, velocity, MOTOR_GAIN_PER_S);
        if let Some(effort_max) = effort_max {
            joint.data.set_motor_max_force(self.along, effort_max);
        }
        Ok(())
    }
}
