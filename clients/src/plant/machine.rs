//! A whole plant in motion: world, axes, sensors and components, one turn at a time.

use onescan_server::client::ClientFault;
use onescan_server::signal::PortLayout;
use onescan_server::time::{TimeSpan, VirtualTime};
use rapier3d::prelude::PhysicsWorld;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::axis::Axis;
use super::channel::{Channels, ChannelsMemory, inner_ports};
use super::component::declare::Value;
use super::coordinate::{Gauge, Measured};
use super::follower::Follower;
use super::part::{Moment, Part, PartMemory, Unbuilt};
use super::placement::Placement;
use super::scene::Scene;
use super::scene::failures::FoundMode;
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
    /// What every component remembers.
    parts: Vec<PartMemory>,
    /// What is on its way to the plant, and from it.
    channels: Option<[ChannelsMemory; 2]>,
}

/// Why a state does not fit in a machine, in words that follow "it" or name a part.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{0}")]
pub(super) struct Misfit(pub(super) String);

/// A plant in motion.
pub(super) struct Machine {
    pub(super) world: World,
    positions: Vec<f64>,
    setpoints: Vec<Setpoint>,
    detected: Vec<bool>,
    gauges: Vec<Gauge>,
    followers: Vec<Follower>,
    axes: Vec<Axis>,
    sensors: Vec<Sensor>,
    parts: Vec<Part>,
    /// The outputs of all parts, for those that are wired to them.
    given: Vec<Vec<Value>>,
    /// Signals in and out, where the scene says that something happens to them.
    channels: Option<[Channels; 2]>,
    dt_s: f64,
}

impl Machine {
    /// Builds the machine of a scene, at rest in the scene's pose.
    ///
    /// # Errors
    /// None that a checked scene could cause.
    pub(super) fn build(scene: &Scene, period: TimeSpan, seed: u64) -> Result<Self, Unbuilt> {
        let reads = PortLayout::new(inner_ports(&scene.reads, &scene.conditions));
        let writes = PortLayout::new(inner_ports(&scene.writes, &scene.conditions));
        let mut world = World::build(scene, period);
        let gauges: Vec<_> = scene.joints.iter().map(|joint| Gauge::new(&world, joint)).collect();
        let followers = Follower::all(scene, &mut world);
        let axes = scene
            .axes
            .iter()
            .map(|axis| Axis::build(axis, scene, &mut world, [&reads, &writes]))
            .collect::<Result<Vec<_>, _>>()?;
        let sensors =
            scene.sensors.iter().map(|sensor| Sensor::build(sensor, &world, &writes)).collect::<Result<Vec<_>, _>>()?;
        let mut parts = Vec::with_capacity(scene.components.len());
        for described in &scene.components {
            parts.push(Part::build(described, scene, seed, &mut world, [&reads, &writes])?);
        }
        let channels = (!scene.conditions.is_empty()).then(|| Channels::pair(scene, seed));
        Ok(Self {
            positions: scene.joints.iter().map(|joint| joint.initial).collect(),
            setpoints: axes.iter().map(|axis| axis.rest(scene)).collect(),
            detected: vec![false; sensors.len()],
            given: parts.iter().map(|part| part.given().to_vec()).collect(),
            world,
            gauges,
            followers,
            axes,
            sensors,
            parts,
            channels,
            dt_s: period.as_secs_f64(),
        })
    }

    /// What the machine remembers.
    ///
    /// # Errors
    /// A component's state that does not go into bytes, which none is.
    pub(super) fn memory(&self) -> Result<Memory, postcard::Error> {
        Ok(Memory {
            positions: self.positions.clone(),
            setpoints: self.setpoints.clone(),
            detected: self.detected.clone(),
            parts: self.parts.iter().map(Part::memory).collect::<Result<_, _>>()?,
            channels: self.channels.as_ref().map(|channels| channels.each_ref().map(Channels::memory)),
        })
    }

    /// Where the bodies are, in the scene's order.
    pub(super) fn placements(&self) -> impl Iterator<Item = Placement> {
        self.world.bodies().map(|body| {
            let pose = body.position();
            Placement { position_m: pose.translation.to_array(), rotation_xyzw: pose.rotation.to_array() }
        })
    }

    /// Switches a mode of a component on.
    pub(super) fn fail(&mut self, FoundMode { component, mode }: FoundMode) {
        self.parts[component].fail(mode);
    }

    /// Switches off what [`fail`](Self::fail) has switched on; false if it has not.
    pub(super) fn repair(&mut self, FoundMode { component, mode }: FoundMode) -> bool {
        self.parts[component].repair(mode)
    }

    /// Takes a state in; it must fit in every part before any part takes its own.
    ///
    /// # Errors
    /// A state of another machine, which changes nothing.
    pub(super) fn restore(&mut self, scene: &Scene, physics: PhysicsWorld, memory: Memory) -> Result<(), Misfit> {
        self.check(scene, &physics, &memory)?;
        self.world.physics = physics;
        for ((part, described), memory) in self.parts.iter_mut().zip(&scene.components).zip(memory.parts) {
            part.restore(memory, &described.name)?;
        }
        for (channels, memory) in self.channels.iter_mut().flatten().zip(memory.channels.into_iter().flatten()) {
            channels.restore(memory);
        }
        self.positions = memory.positions;
        self.setpoints = memory.setpoints;
        self.detected = memory.detected;
        for (given, part) in self.given.iter_mut().zip(&self.parts) {
            given.clear();
            given.extend_from_slice(part.given());
        }
        Ok(())
    }

    fn check(&self, scene: &Scene, physics: &PhysicsWorld, memory: &Memory) -> Result<(), Misfit> {
        let counts = [
            ("joints", self.positions.len(), memory.positions.len()),
            ("axes", self.setpoints.len(), memory.setpoints.len()),
            ("sensors", self.detected.len(), memory.detected.len()),
            ("components", self.parts.len(), memory.parts.len()),
            ("directions of signals", self.channels.iter().flatten().count(), memory.channels.iter().flatten().count()),
        ];
        if let Some((what, own, saved)) = counts.into_iter().find(|(_, own, saved)| own != saved) {
            return Err(Misfit(format!("it has {saved} {what}, this plant has {own}")));
        }
        self.world.check(physics)?;
        for ((part, described), memory) in self.parts.iter().zip(&scene.components).zip(&memory.parts) {
            part.check(memory, &described.name)?;
        }
        let mut channels = self.channels.iter().flatten().zip(memory.channels.iter().flatten());
        if channels.all(|(one, memory)| one.fits(memory)) {
            return Ok(());
        }
        Err(Misfit("its signals between plant and session are others".to_owned()))
    }

    /// The signals as they are at the set-up.
    ///
    /// # Errors
    /// None that a checked scene could cause.
    pub(super) fn begin(&mut self, scene: &Scene, outputs: &mut [u8]) -> Result<(), ClientFault> {
        let dt_s = std::mem::replace(&mut self.dt_s, 0.0);
        let begun = match self.channels.take() {
            None => self.observe(scene, 0, &vec![0; PortLayout::new(scene.reads.clone()).size()], outputs),
            Some(mut channels) => {
                let zeros = vec![0; channels[0].inner().len()];
                let begun = self.observe(scene, 0, &zeros, channels[1].inner_mut());
                let sent = channels[1].give_at_once(outputs);
                self.channels = Some(channels);
                begun.and(sent)
            }
        };
        self.dt_s = dt_s;
        begun
    }

    /// Moves the machine by one period, which ends at `t_v`.
    ///
    /// # Errors
    /// A command that is not finite, a world that has come apart.
    pub(super) fn turn(
        &mut self,
        scene: &Scene,
        t_v: VirtualTime,
        inputs: &[u8],
        outputs: &mut [u8],
    ) -> Result<(), ClientFault> {
        let now_ns = t_v.as_nanos();
        let Some(mut channels) = self.channels.take() else {
            return self.inner_turn(scene, now_ns, inputs, outputs);
        };
        let [taken, given] = &mut channels;
        let turned = taken.take(now_ns, inputs);
        let turned = turned.and_then(|()| self.inner_turn(scene, now_ns, taken.inner(), given.inner_mut()));
        let sent = given.give(now_ns, outputs);
        // back in any case: a state that is restored after a fault finds its channels
        self.channels = Some(channels);
        turned.and(sent)
    }

    fn inner_turn(&mut self, scene: &Scene, now_ns: u64, inputs: &[u8], outputs: &mut [u8]) -> Result<(), ClientFault> {
        let Self { world, positions, setpoints, gauges, followers, axes, parts, given, dt_s, .. } = self;
        let measured = Measured { gauges, positions };
        for follower in followers {
            follower.drive(measured, *dt_s, world)?;
        }
        for ((axis, setpoint), described) in axes.iter().zip(setpoints).zip(&scene.axes) {
            axis.drive(&described.name, setpoint, measured, *dt_s, inputs, world)?;
        }
        let moment = Moment { t_v_ns: now_ns, dt_s: *dt_s, inputs, measured };
        for (part, described) in parts.iter_mut().zip(&scene.components) {
            part.drive(described, &moment, given, world)?;
        }
        self.world.step(scene)?;
        self.observe(scene, now_ns, inputs, outputs)
    }

    /// Measures every joint, lets every sensor and component look and writes all signals.
    fn observe(&mut self, scene: &Scene, now_ns: u64, inputs: &[u8], outputs: &mut [u8]) -> Result<(), ClientFault> {
        let Self { world, positions, setpoints, detected, gauges, axes, sensors, parts, given, dt_s, .. } = self;
        for (gauge, position) in gauges.iter().zip(positions.iter_mut()) {
            *position = gauge.position(world, *position);
        }
        let measured = Measured { gauges, positions };
        for (axis, setpoint) in axes.iter().zip(setpoints) {
            axis.feed_back(*setpoint, measured, world, outputs);
        }
        for (sensor, detected) in sensors.iter().zip(detected) {
            *detected = sensor.detects(world, positions, *detected);
            sensor.write(*detected, outputs);
        }
        let moment = Moment { t_v_ns: now_ns, dt_s: *dt_s, inputs, measured };
        for (index, (part, described)) in parts.iter_mut().zip(&scene.components).enumerate() {
            part.sense(described, &moment, given, world, outputs)?;
            given[index].clear();
            given[index].extend_from_slice(part.given());
        }
        Ok(())
    }
}
