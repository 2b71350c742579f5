//! A whole plant in motion: world, axes and sensors, one turn at a time.

use onescan_server::client::ClientFault;
use onescan_server::signal::{PortLayout, SlotError};
use onescan_server::time::TimeSpan;
use serde::{Deserialize, Serialize};

use super::axis::{Axis, Measured};
use super::coordinate::Gauge;
use super::scene::Scene;
use super::sensor::Sensor;
use super::setpoint::Setpoint;
use super::world::World;

/// What the plant remembers between two turns, beside the state of its world.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Memory {
    /// Coordinate of every joint.
    positions: Vec<f64>,
    /// Setpoint of every axis.
    setpoints: Vec<Setpoint>,
    /// What every sensor sees.
    detected: Vec<bool>,
}

impl Memory {
    /// True if both are memories of plants with the same numbers of things.
    pub(super) fn fits(&self, other: &Self) -> bool {
        self.positions.len() == other.positions.len()
            && self.setpoints.len() == other.setpoints.len()
            && self.detected.len() == other.detected.len()
    }
}

/// A plant in motion.
pub(super) struct Machine {
    pub(super) world: World,
    pub(super) memory: Memory,
    gauges: Vec<Gauge>,
    axes: Vec<Axis>,
    sensors: Vec<Sensor>,
    dt_s: f64,
}

impl Machine {
    /// Builds the machine of a scene, at rest in the scene's pose.
    ///
    /// # Errors
    /// A signal of the scene that its ports do not have.
    pub(super) fn build(scene: &Scene, period: TimeSpan) -> Result<Self, SlotError> {
        let reads = PortLayout::new(scene.reads.clone());
        let writes = PortLayout::new(scene.writes.clone());
        let mut world = World::build(scene, period);
        let gauges: Vec<_> = scene.joints.iter().map(|joint| Gauge::new(&world, joint)).collect();
        let axes = scene
            .axes
            .iter()
            .map(|axis| Axis::build(axis, scene, &mut world, [&reads, &writes]))
            .collect::<Result<Vec<_>, _>>()?;
        let sensors =
            scene.sensors.iter().map(|sensor| Sensor::build(sensor, &world, &writes)).collect::<Result<Vec<_>, _>>()?;
        let memory = Memory {
            positions: scene.joints.iter().map(|joint| joint.initial).collect(),
            setpoints: axes.iter().map(|axis| axis.rest(scene)).collect(),
            detected: vec![false; sensors.len()],
        };
        Ok(Self { world, memory, gauges, axes, sensors, dt_s: period.as_secs_f64() })
    }

    /// Moves the machine by one period.
    ///
    /// # Errors
    /// A command that is not finite, a world that has come apart.
    pub(super) fn turn(&mut self, scene: &Scene, inputs: &[u8], outputs: &mut [u8]) -> Result<(), ClientFault> {
        let Self { world, memory, gauges, axes, dt_s, .. } = self;
        let measured = Measured { gauges, positions: &memory.positions };
        for ((axis, setpoint), described) in axes.iter().zip(&mut memory.setpoints).zip(&scene.axes) {
            axis.drive(&described.name, setpoint, measured, *dt_s, inputs, world)?;
        }
        self.world.step(scene)?;
        self.observe(outputs);
        Ok(())
    }

    /// Measures every joint, lets every sensor look and writes all signals.
    pub(super) fn observe(&mut self, outputs: &mut [u8]) {
        let Self { world, memory, gauges, axes, sensors, .. } = self;
        for (gauge, position) in gauges.iter().zip(&mut memory.positions) {
            *position = gauge.position(world, *position);
        }
        let measured = Measured { gauges, positions: &memory.positions };
        for (axis, setpoint) in axes.iter().zip(&memory.setpoints) {
            axis.feed_back(*setpoint, measured, world, outputs);
        }
        for (sensor, detected) in sensors.iter().zip(&mut memory.detected) {
            *detected = sensor.detects(world, &memory.positions, *detected);
            sensor.write(*detected, outputs);
        }
    }
}
