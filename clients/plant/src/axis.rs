//! A driven axis: command, setpoint, what it moves, feedback.
//!
//! The drive of a joint is a cascade as in a real one. A setpoint generator gives position and
//! velocity; a position loop adds a correction to the velocity; a velocity loop, the engine's motor,
//! exerts what force it takes up to its greatest. Where that force does not suffice the setpoint
//! waits, so that a freed axis does not jump.
//!
//! The drive of a belt has no loops: nothing that lies on a belt can slow it.

use onescan_server::client::ClientFault;
use onescan_server::signal::{PortLayout, SignalName, Slot, SlotError};
use rapier3d::prelude::*;

use super::command::{Command, NumberSlot};
use super::effort::{Mark, Path};
use super::model::Mechanics;
use super::model::{self, Moved};
use super::setpoint::{Bounds, Setpoint};
use super::world::World;
use super::world::actuator::Motor;
use super::world::coordinate::Measured;

/// What an axis moves.
enum Mover {
    Joint(Motor),
    Belt { body: RigidBodyHandle, direction: Vector },
}

/// A driven axis, bound to what it moves and to its signals.
pub(super) struct Axis {
    mover: Mover,
    command: Command,
    bounds: Bounds,
    position: Option<NumberSlot>,
    velocity: Option<NumberSlot>,
    effort: Option<NumberSlot>,
    limit: Option<Slot<bool>>,
}

impl Axis {
    /// Binds an axis; the motor of a joint then holds it where it is.
    pub(super) fn build(
        axis: &model::Axis,
        scene: &Mechanics,
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
                Mover::Joint(Motor::bind(joint, axis.effort_max, scene, world))
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
            effort: feedback(&axis.effort)?,
            limit: axis.limit.as_ref().map(|name| writes.slot(name.as_str())).transpose()?,
        })
    }

    /// Where the axis rests before the first turn.
    pub(super) fn rest(&self, scene: &Mechanics) -> Setpoint {
        let position = match &self.mover {
            Mover::Joint(motor) => scene.joints[motor.joint()].initial,
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
        match &self.mover {
            Mover::Joint(motor) => {
                let (joint, speed) = (motor.joint(), self.bounds.speed);
                let Mark { position, velocity } = measured.motions[joint];
                let velocity = || velocity.clamp(-speed, speed);
                let from = setpoint.near(position, speed * dt_s, velocity);
                // what has come to a stop against something holds where it is, and does not go on to press
                let holds = from.velocity == 0.0 && self.command.stands(inputs) && motor.is_at_its_limit(world);
                let from = if holds { Setpoint { position, ..from } } else { from };
                let to = self.command.advance(name, from, &self.bounds, dt_s, inputs)?;
                motor.follow(Path { from, to, turn_s: dt_s }, None, world)?;
                *setpoint = to;
            }
            Mover::Belt { body, direction } => {
                let to = self.command.advance(name, *setpoint, &self.bounds, dt_s, inputs)?;
                let velocity = (to.position - setpoint.position) / dt_s;
                world.run(*body, *direction * velocity)?;
                *setpoint = to;
            }
        }
        Ok(())
    }

    /// Writes where the axis is and how fast.
    pub(super) fn feed_back(&self, setpoint: Setpoint, measured: Measured<'_>, world: &World, outputs: &mut [u8]) {
        if let Some(slot) = self.position {
            let position = match &self.mover {
                Mover::Joint(motor) => measured.motions[motor.joint()].position,
                Mover::Belt { .. } => setpoint.position,
            };
            slot.set(outputs, position);
        }
        if let Some(slot) = self.velocity {
            let velocity = match &self.mover {
                Mover::Joint(motor) => measured.motions[motor.joint()].velocity,
                Mover::Belt { body, direction } => world.body(*body).linvel().dot(*direction),
            };
            slot.set(outputs, velocity);
        }
        let Mover::Joint(motor) = &self.mover else { return };
        if let Some(slot) = self.effort {
            slot.set(outputs, motor.effort(world));
        }
        if let Some(slot) = self.limit {
            slot.set(outputs, motor.is_at_its_limit(world));
        }
    }
}
