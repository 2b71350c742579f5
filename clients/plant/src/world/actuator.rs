//! What drives a joint: along a path that a drive sets, or by the law of a component's equations.
//!
//! While the joint's mechanism touches nothing, the mechanism itself takes the actuator's force into its
//! equations. Where it touches, the engine computes the step, and the actuator is one of the engine's
//! motors: a law is then a line, force over velocity, that the component foresees for the end of the
//! step. The line is part of the engine's own equations, so that a stiff drive and a stiff contact do
//! not fight whatever the step; afterwards the component's state follows the joint's real motion.

use onescan_server::client::ClientFault;
use rapier3d::prelude::*;

use super::{World, measured_axis};
use crate::effort::{Drives, Effort, Motion, Path};
use crate::fitting::Fitting;
use crate::model::Mechanics;

/// Of a deviation from its path, a drive makes up this part in a turn. Below 1 the loop settles
/// without overshoot; the smaller, the gentler after a blocked joint comes free.
pub(crate) const CORRECTED_A_TURN: f64 = 0.25;

/// The gain of an engine's motor, so high that only its greatest force limits it.
const RIGID_PER_S: f64 = 1e12;
/// By how much a velocity is changed to see how a drive's force answers, m/s or rad/s.
const PROBE: f64 = 1e-3;
/// A slope for forces that do not depend on the velocity: a line of the engine's must have one.
const FLAT: f64 = 1e-9;

/// How an actuator acts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Acts {
    /// Along a path, in this turn.
    Along(Path),
    /// By the equations of the drive of this number.
    Law { drive: usize },
}

/// The actuator of a prismatic or revolute joint.
pub(crate) struct Actuator {
    /// Index of the joint in the scene.
    pub(crate) joint: usize,
    pub(crate) acts: Acts,
    /// The greatest force of one that follows a path, N or N·m.
    pub(crate) most: f64,
    /// What it has exerted in the step so far, N·s or N·m·s.
    pub(crate) impulse: f64,
    /// What it exerted in the last sub-step, N or N·m.
    pub(crate) exerted: f64,
    /// What it exerted in the last step, in the mean.
    pub(crate) effort: f64,
    handle: ImpulseJointHandle,
    along: JointAxis,
}

/// A joint of the engine's that leaves all free and brakes as dry friction does.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Friction {
    pub(crate) handle: ImpulseJointHandle,
    along: JointAxis,
}

impl Friction {
    /// Puts one beside a joint of the scene.
    pub(crate) fn beside(joint: ImpulseJointHandle, along: JointAxis, physics: &mut PhysicsWorld) -> Option<Self> {
        let (mut brake, [one, other]) = free_beside(joint, physics)?;
        brake.set_motor_model(along, MotorModel::AccelerationBased);
        brake.set_motor_velocity(along, 0.0, RIGID_PER_S);
        brake.set_motor_max_force(along, 0.0);
        Some(Self { handle: physics.insert_impulse_joint(one, other, brake), along })
    }

    /// How much it brakes in the step that begins.
    pub(crate) fn brake(&self, most: f64, joints: &mut ImpulseJointSet) {
        if let Some(joint) = joints.get_mut(self.handle, false) {
            joint.data.set_motor_max_force(self.along, most.min(Real::MAX));
        }
    }
}

/// Puts spring, damper and counterweight beside a joint of the scene, for the engine.
///
/// A counterweight beside a spring is a place of rest further up. Not so of an angle: beyond half a turn it is another
/// angle for the engine, so there the counterweight is a motor of its own.
pub(crate) fn springs_beside(
    joint: ImpulseJointHandle,
    along: JointAxis,
    fitting: &Fitting,
    physics: &mut PhysicsWorld,
) -> Vec<ImpulseJointHandle> {
    let Some((mut spring, [one, other])) = free_beside(joint, physics) else { return Vec::new() };
    spring.set_motor_model(along, MotorModel::ForceBased);
    let mut weight = spring;
    let is_apart = fitting.spring > 0.0 && fitting.balance != 0.0 && along == JointAxis::AngX;
    if fitting.spring > 0.0 {
        let further = if is_apart { 0.0 } else { fitting.balance / fitting.spring };
        spring.set_motor(along, fitting.rest + further, 0.0, fitting.spring, fitting.damping);
    } else {
        let slope = fitting.damping.max(FLAT);
        spring.set_motor_velocity(along, fitting.balance / slope, slope);
    }
    let mut put = vec![physics.insert_impulse_joint(one, other, spring)];
    if is_apart {
        weight.set_motor_velocity(along, fitting.balance / FLAT, FLAT);
        put.push(physics.insert_impulse_joint(one, other, weight));
    }
    put
}

/// A joint between the bodies of another that leaves all free.
fn free_beside(joint: ImpulseJointHandle, physics: &PhysicsWorld) -> Option<(GenericJoint, [RigidBodyHandle; 2])> {
    let beside = physics.impulse_joints.get(joint)?;
    let free = GenericJointBuilder::new(JointAxesMask::empty())
        .local_frame1(beside.data.local_frame1)
        .local_frame2(beside.data.local_frame2)
        .contacts_enabled(beside.data.contacts_enabled())
        .build();
    Some((free, [beside.body1(), beside.body2()]))
}

impl Actuator {
    /// Makes it a motor of the engine for a step, whose part of the turn this is, from where the joint is.
    ///
    /// What it gives back is its dry friction.
    pub(crate) fn arm(
        &self,
        motion: Motion,
        [from, to]: [f64; 2],
        dt_s: f64,
        drives: &dyn Drives,
        joints: &mut ImpulseJointSet,
    ) -> f64 {
        let line = self.line(motion, [from, to], dt_s, drives);
        if let Some(joint) = joints.get_mut(self.handle, false) {
            let rigid = line.slope == f64::INFINITY;
            let (model, gain) =
                if rigid { (MotorModel::AccelerationBased, RIGID_PER_S) } else { (MotorModel::ForceBased, line.slope) };
            joint.data.set_motor_model(self.along, model);
            joint.data.set_motor_velocity(self.along, line.velocity, gain);
            joint.data.set_motor_max_force(self.along, line.most.min(Real::MAX));
        }
        line.dry
    }

    /// Its force over the velocity at the end of a step, whose part of the turn this is, from where the joint is.
    pub(super) fn line(&self, motion: Motion, [from, to]: [f64; 2], dt_s: f64, drives: &dyn Drives) -> Line {
        match self.acts {
            Acts::Along(path) => {
                let missing = path.at(from) - motion.position;
                let velocity = (path.at(to) - path.at(from)) / dt_s + CORRECTED_A_TURN * missing / path.turn_s;
                Line { velocity, slope: f64::INFINITY, most: self.most, dry: 0.0 }
            }
            Acts::Law { drive } => Line::of(|motion| drives.foresee(drive, motion, dt_s), motion),
        }
    }

    /// What the engine's motor exerted in its last iteration, of which there are so many in a step; it counts
    /// its impulse on the parent.
    pub(crate) fn read(&mut self, joints: &ImpulseJointSet, dt_s: f64, iterations: usize) {
        let motor = joints.get(self.handle).and_then(|joint| joint.data.motor(self.along).copied());
        self.exerted = motor.map_or(0.0, |motor| -motor.impulse * iterations as f64 / dt_s);
        self.effort = self.exerted;
    }
}

/// A force that falls in a straight line over the velocity, and dry friction beside it.
pub(super) struct Line {
    /// Where the force is 0.
    pub(super) velocity: f64,
    pub(super) slope: f64,
    pub(super) most: f64,
    pub(super) dry: f64,
}

impl Line {
    /// The line through what is foreseen for this motion and for one that is as good as stopped.
    fn of(foresee: impl Fn(Motion) -> Effort, motion: Motion) -> Self {
        let effort = foresee(motion);
        if let Some(velocity) = effort.sought {
            return Self { velocity, slope: f64::INFINITY, most: effort.most, dry: effort.dry };
        }
        let force = |effort: &Effort, velocity: f64| effort.force - effort.viscous * velocity;
        let apart = if motion.velocity.abs() > PROBE { 0.0 } else { motion.velocity + PROBE };
        let probed = foresee(Motion { velocity: apart, ..motion });
        let fall = force(&effort, motion.velocity) - force(&probed, apart);
        let slope = (fall / (apart - motion.velocity)).max(FLAT);
        let velocity = motion.velocity + force(&effort, motion.velocity) / slope;
        Self { velocity, slope, most: effort.most, dry: effort.dry }
    }
}

/// A handle on the actuator of a joint, as axes and components drive it.
pub(crate) struct Motor {
    joint: usize,
    actuator: usize,
}

impl Motor {
    /// Binds the joint of an index to what follows paths, which from now on holds it where it is, with an
    /// effort up to the greatest, N or N·m, or with as much as it takes.
    pub(crate) fn bind(joint: usize, effort_max: Option<f64>, scene: &Mechanics, world: &mut World) -> Self {
        let along = measured_axis(scene.joints[joint].kind);
        let actuator = Actuator {
            joint,
            acts: Acts::Along(Path::at_rest(scene.joints[joint].initial)),
            most: effort_max.unwrap_or(f64::INFINITY),
            impulse: 0.0,
            exerted: 0.0,
            effort: 0.0,
            handle: world.joint(joint),
            along,
        };
        if let Some(joint) = world.physics.impulse_joints.get_mut(actuator.handle, true) {
            joint.data.set_motor_model(along, MotorModel::AccelerationBased);
            joint.data.set_motor_velocity(along, 0.0, RIGID_PER_S);
            joint.data.set_motor_max_force(along, actuator.most.min(Real::MAX));
        }
        world.actuators.push(actuator);
        Self { joint, actuator: world.actuators.len() - 1 }
    }

    /// From now on the joint is driven by the equations of a component.
    pub(crate) fn obey(&self, world: &mut World) {
        let Actuator { acts, joint, .. } = &mut world.actuators[self.actuator];
        *acts = Acts::Law { drive: self.actuator };
        let joint = *joint;
        world.add_friction(joint);
    }

    /// Index of the joint in the scene.
    pub(crate) fn joint(&self) -> usize {
        self.joint
    }

    /// Its number among the actuators, by which its drive is known.
    pub(crate) fn number(&self) -> usize {
        self.actuator
    }

    /// What it exerted in the last step, N or N·m.
    pub(crate) fn effort(&self, world: &World) -> f64 {
        world.actuators[self.actuator].effort
    }

    /// Whether it exerted all that it can in the last sub-step, to within rounding.
    pub(crate) fn is_at_its_limit(&self, world: &World) -> bool {
        let actuator = &world.actuators[self.actuator];
        actuator.exerted.abs() >= actuator.most * (1.0 - 1e-9)
    }

    /// Moves the joint along a path in the turn that begins, with a new greatest effort if there is one.
    ///
    /// # Errors
    /// An actuator that the world does not have, which no checked scene causes.
    pub(crate) fn follow(&self, path: Path, effort_max: Option<f64>, world: &mut World) -> Result<(), ClientFault> {
        let actuator = world.actuators.get_mut(self.actuator);
        let actuator = actuator.ok_or_else(|| ClientFault::new("a driven joint is not in the world"))?;
        actuator.acts = Acts::Along(path);
        if let Some(effort_max) = effort_max {
            actuator.most = effort_max;
        }
        Ok(())
    }
}
