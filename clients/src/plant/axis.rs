//! A driven axis: command, setpoint, what it moves, feedback.
//!
//! The drive of a joint is a cascade as in a real one. A setpoint generator gives position and
//! velocity; a position loop adds a correction to the velocity; a velocity loop, the engine's motor,
//! exerts what force it takes up to its greatest. Where that force does not suffice the setpoint
//! waits, so that a freed axis does not jump.
//!
//! The drive of a belt has no loops: nothing that lies on a belt can slow it.

use onescan_server::client::ClientFault;
use onescan_server::signal::{PortLayout, SignalName, SlotError};
use rapier3d::prelude::*;

use super::command::{Command, NumberSlot};
use super::coordinate::Gauge;
use super::scene::Scene;
use super::scene::model::{self, Moved};
use super::setpoint::{Bounds, Setpoint};
use super::world::{World, measured_axis};

/// The part of the position error that one period corrects. Below 1 the loop settles without
/// overshoot; the smaller, the gentler after a blocked axis comes free.
const CORRECTED_A_PERIOD: f64 = 0.25;
/// The motor's gain per second, so high that only its greatest force limits it.
const MOTOR_GAIN_PER_S: f64 = 1e12;

/// What an axis moves.
enum Mover {
    Joint { joint: usize, motor: ImpulseJointHandle, along: JointAxis },
    Belt { body: RigidBodyHandle, direction: Vector },
}

/// A driven axis, bound to what it moves and to its signals.
pub(super) struct Axis {
    mover: Mover,
    command: Command,
    bounds: Bounds,
    position: Option<NumberSlot>,
    velocity: Option<NumberSlot>,
}

/// The joints as they were measured last, in the scene's order.
#[derive(Clone, Copy)]
pub(super) struct Measured<'m> {
    pub(super) gauges: &'m [Gauge],
    pub(super) positions: &'m [f64],
}

impl Axis {
    /// Binds an axis; the motor of a joint then holds it where it is.
    pub(super) fn build(
        axis: &model::Axis,
        scene: &Scene,
        world: &mut World,
        [reads, writes]: [&PortLayout; 2],
    ) -> Result<Self, SlotError> {
        let feedback = |name: &Option<SignalName>| {
            name.as_ref().map(|name| NumberSlot::find(writes, name, axis.number)).transpose()
        };
        let mut bounds = Bounds::unlimited(axis.speed, axis.acceleration);
        let mover = match axis.moved {
            Moved::Joint(joint) => {
                let described = &scene.joints[joint];
                bounds.lower = described.lower.unwrap_or(f64::NEG_INFINITY);
                bounds.upper = described.upper.unwrap_or(f64::INFINITY);
                let (motor, along) = (world.joint(joint), measured_axis(described.kind));
                arm(world, motor, along, axis.effort_max);
                Mover::Joint { joint, motor, along }
            }
            Moved::Belt { body, direction } => {
                let body = world.handle(Some(body));
                world.keep_in_place(body);
                Mover::Belt { body, direction: Vector::from_array(direction) }
            }
        };
        Ok(Self {
            mover,
            command: Command::find(reads, &axis.drive, axis.number)?,
            bounds,
            position: feedback(&axis.position)?,
            velocity: feedback(&axis.velocity)?,
        })
    }

    /// Where the axis rests before the first turn.
    pub(super) fn rest(&self, scene: &Scene) -> Setpoint {
        let position = match self.mover {
            Mover::Joint { joint, .. } => scene.joints[joint].initial,
            Mover::Belt { .. } => 0.0,
        };
        Setpoint { position, velocity: 0.0 }
    }

    /// Reads the command and moves setpoint and world by one period; `name` is the axis in faults.
    ///
    /// # Errors
    /// A commanded number that is not finite.
    pub(super) fn drive(
        &self,
        name: &str,
        setpoint: &mut Setpoint,
        measured: Measured<'_>,
        dt_s: f64,
        inputs: &[u8],
        world: &mut World,
    ) -> Result<(), ClientFault> {
        match self.mover {
            Mover::Joint { joint, motor, along } => {
                let speed = self.bounds.speed;
                let position = measured.positions[joint];
                let velocity = || measured.gauges[joint].velocity(world).clamp(-speed, speed);
                let from = setpoint.near(position, speed * dt_s, velocity);
                let to = self.command.advance(name, from, &self.bounds, dt_s, inputs)?;
                let correction = CORRECTED_A_PERIOD * (from.position - position);
                let velocity = (to.position - from.position + correction) / dt_s;
                if let Some(joint) = world.physics.impulse_joints.get_mut(motor, true) {
                    joint.data.set_motor_velocity(along, velocity, MOTOR_GAIN_PER_S);
                }
                *setpoint = to;
            }
            Mover::Belt { body, direction } => {
                let to = self.command.advance(name, *setpoint, &self.bounds, dt_s, inputs)?;
                let velocity = (to.position - setpoint.position) / dt_s;
                if let Some(body) = world.physics.bodies.get_mut(body) {
                    body.set_linvel(direction * velocity, true);
                }
                *setpoint = to;
            }
        }
        Ok(())
    }

    /// Writes where the axis is and how fast.
    pub(super) fn feed_back(&self, setpoint: Setpoint, measured: Measured<'_>, world: &World, outputs: &mut [u8]) {
        if let Some(slot) = self.position {
            let position = match self.mover {
                Mover::Joint { joint, .. } => measured.positions[joint],
                Mover::Belt { .. } => setpoint.position,
            };
            slot.set(outputs, position);
        }
        if let Some(slot) = self.velocity {
            let velocity = match self.mover {
                Mover::Joint { joint, .. } => measured.gauges[joint].velocity(world),
                Mover::Belt { body, direction } => world.body(body).linvel().dot(direction),
            };
            slot.set(outputs, velocity);
        }
    }
}

/// Makes a joint's motor hold it where it is.
pub(super) fn arm(world: &mut World, motor: ImpulseJointHandle, along: JointAxis, effort_max: Option<f64>) {
    if let Some(joint) = world.physics.impulse_joints.get_mut(motor, true) {
        joint.data.set_motor_model(along, MotorModel::AccelerationBased);
        joint.data.set_motor_velocity(along, 0.0, MOTOR_GAIN_PER_S);
        joint.data.set_motor_max_force(along, effort_max.unwrap_or(Real::MAX));
    }
}
