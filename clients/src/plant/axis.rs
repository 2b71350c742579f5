//! A driven axis: command, setpoint, motor, feedback.
//!
//! The drive is a cascade as in a real one. A setpoint generator gives position and velocity; a
//! position loop adds a correction to the velocity; a velocity loop, the engine's motor, exerts what
//! force it takes up to its greatest. Where that force does not suffice the setpoint waits, so that
//! a freed axis does not jump.

use onescan_server::client::ClientFault;
use onescan_server::signal::{PortLayout, SignalName, Slot, SlotError};
use rapier3d::prelude::*;

use super::coordinate::Gauge;
use super::scene::model::{self, NumberType};
use super::setpoint::{Bounds, Setpoint};
use super::world::{World, measured_axis};

/// The part of the position error that one period corrects. Below 1 the loop settles without
/// overshoot; the smaller, the gentler after a blocked axis comes free.
const CORRECTED_A_PERIOD: f64 = 0.25;
/// The motor's gain per second, so high that only its greatest force limits it.
const MOTOR_GAIN_PER_S: f64 = 1e12;

/// A REAL or an LREAL in a port.
#[derive(Clone, Copy)]
pub(super) enum NumberSlot {
    Real(Slot<f32>),
    Lreal(Slot<f64>),
}

impl NumberSlot {
    fn find(layout: &PortLayout, name: &SignalName, number: NumberType) -> Result<Self, SlotError> {
        match number {
            NumberType::Real => layout.slot(name.as_str()).map(Self::Real),
            NumberType::Lreal => layout.slot(name.as_str()).map(Self::Lreal),
        }
    }

    fn get(self, port: &[u8]) -> f64 {
        match self {
            Self::Real(slot) => f64::from(slot.get(port)),
            Self::Lreal(slot) => slot.get(port),
        }
    }

    fn set(self, port: &mut [u8], value: f64) {
        match self {
            Self::Real(slot) => slot.set(port, value as f32),
            Self::Lreal(slot) => slot.set(port, value),
        }
    }
}

/// Where the command of an axis lies in the plant's inputs.
enum Command {
    Bidirectional { forward: Slot<bool>, reverse: Slot<bool> },
    Velocity(NumberSlot),
    Position(NumberSlot),
}

/// How an axis's joint is measured, and where it was at the last look.
#[derive(Clone, Copy)]
pub(super) struct Measured<'m> {
    pub(super) position: f64,
    pub(super) gauge: &'m Gauge,
}

/// A driven axis, bound to its joint and its signals.
pub(super) struct Axis {
    joint: usize,
    motor: ImpulseJointHandle,
    along: JointAxis,
    command: Command,
    bounds: Bounds,
    limits: [f64; 2],
    position: Option<NumberSlot>,
    velocity: Option<NumberSlot>,
}

impl Axis {
    /// Binds an axis and arms its motor, which then holds the joint where it is.
    pub(super) fn build(
        axis: &model::Axis,
        joint: &model::Joint,
        world: &mut World,
        [reads, writes]: [&PortLayout; 2],
    ) -> Result<Self, SlotError> {
        let command = match &axis.drive {
            model::Drive::Bidirectional { forward, reverse } => Command::Bidirectional {
                forward: reads.slot(forward.as_str())?,
                reverse: reads.slot(reverse.as_str())?,
            },
            model::Drive::Velocity { command } => Command::Velocity(NumberSlot::find(reads, command, axis.number)?),
            model::Drive::Position { command } => Command::Position(NumberSlot::find(reads, command, axis.number)?),
        };
        let feedback = |name: &Option<SignalName>| {
            name.as_ref().map(|name| NumberSlot::find(writes, name, axis.number)).transpose()
        };
        let bound = Self {
            joint: axis.joint,
            motor: world.joint(axis.joint),
            along: measured_axis(joint.kind),
            command,
            bounds: Bounds { speed: axis.speed, acceleration: axis.acceleration },
            limits: [joint.lower.unwrap_or(f64::NEG_INFINITY), joint.upper.unwrap_or(f64::INFINITY)],
            position: feedback(&axis.position)?,
            velocity: feedback(&axis.velocity)?,
        };
        bound.arm(world, axis.effort_max);
        Ok(bound)
    }

    fn arm(&self, world: &mut World, effort_max: Option<f64>) {
        if let Some(joint) = world.physics.impulse_joints.get_mut(self.motor, true) {
            joint.data.set_motor_model(self.along, MotorModel::AccelerationBased);
            joint.data.set_motor_velocity(self.along, 0.0, MOTOR_GAIN_PER_S);
            joint.data.set_motor_max_force(self.along, effort_max.unwrap_or(Real::MAX));
        }
    }

    /// Index of the joint that the axis drives.
    pub(super) fn joint(&self) -> usize {
        self.joint
    }

    /// Reads the command and moves setpoint and motor by one period.
    ///
    /// # Errors
    /// A commanded number that is not finite; `name` is the axis in the message.
    pub(super) fn drive(
        &self,
        name: &str,
        setpoint: &mut Setpoint,
        measured: Measured<'_>,
        dt_s: f64,
        inputs: &[u8],
        world: &mut World,
    ) -> Result<(), ClientFault> {
        let Measured { position, gauge } = measured;
        let speed = self.bounds.speed;
        let velocity = || gauge.velocity(world).clamp(-speed, speed);
        let from = setpoint.near(position, speed * dt_s, velocity);
        let to = match self.command {
            Command::Bidirectional { forward, reverse } => {
                let speed = match (forward.get(inputs), reverse.get(inputs)) {
                    (true, false) => self.bounds.speed,
                    (false, true) => -self.bounds.speed,
                    (true, true) | (false, false) => 0.0,
                };
                from.towards_velocity(speed, self.bounds, dt_s)
            }
            Command::Velocity(slot) => from.towards_velocity(finite(name, slot, inputs)?, self.bounds, dt_s),
            Command::Position(slot) => {
                let [lower, upper] = self.limits;
                let wanted = finite(name, slot, inputs)?.clamp(lower, upper);
                from.towards_position(wanted, self.bounds, dt_s)
            }
        };
        let correction = CORRECTED_A_PERIOD * (from.position - position);
        let velocity = (to.position - from.position + correction) / dt_s;
        if let Some(joint) = world.physics.impulse_joints.get_mut(self.motor, true) {
            joint.data.set_motor_velocity(self.along, velocity, MOTOR_GAIN_PER_S);
        }
        *setpoint = to;
        Ok(())
    }

    /// Writes where the axis is and how fast.
    pub(super) fn feed_back(&self, position: f64, velocity: impl FnOnce() -> f64, outputs: &mut [u8]) {
        if let Some(slot) = self.position {
            slot.set(outputs, position);
        }
        if let Some(slot) = self.velocity {
            slot.set(outputs, velocity());
        }
    }
}

fn finite(name: &str, slot: NumberSlot, inputs: &[u8]) -> Result<f64, ClientFault> {
    let value = slot.get(inputs);
    if value.is_finite() {
        return Ok(value);
    }
    Err(ClientFault::new(format!("axis `{name}` is commanded {value}, which is not a finite number")))
}
