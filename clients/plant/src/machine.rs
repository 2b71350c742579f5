//! A whole plant in motion: world, axes, sensors and components, one turn at a time.

use onescan_server::client::ClientFault;
use onescan_server::signal::{PortLayout, Slot, SlotError};
use onescan_server::time::{TimeSpan, VirtualTime};
use rapier3d::prelude::PhysicsWorld;
use serde::{Deserialize, Serialize};

use super::axis::Axis;
use super::channel::{Channels, ChannelsMemory, inner_ports};
use super::component::declare::Value;
use super::effort::{Drives, Effort, Mark, Motion};
use super::follower::Follower;
use super::layout_mismatch::LayoutMismatch;
use super::part::{Moment, Part, PartMemory, Unbuilt};
use super::placement::Placement;
use super::scene::failures::FoundMode;
use super::scene::parameters::{FoundParameter, ParameterRefused};
use super::scene::{Scene, model};
use super::sensor::Sensor;
use super::setpoint::Setpoint;
use super::temperature_field::TemperatureField;
use super::world::World;
use super::world::articulation::ArticulationMemory;
use super::world::coordinate::Measured;

/// What the plant remembers between two turns, beside the state of its world.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Memory {
    articulation: ArticulationMemory,
    /// Setpoint of every axis.
    setpoints: Vec<Setpoint>,
    /// What every sensor sees.
    detected: Vec<bool>,
    /// What every component remembers.
    parts: Vec<PartMemory>,
    /// What is on its way to the plant, and from it.
    channels: Option<[ChannelsMemory; 2]>,
}

/// A plant in motion.
pub(super) struct Machine {
    pub(super) world: World,
    /// The joints as they were measured last.
    motions: Vec<Mark>,
    setpoints: Vec<Setpoint>,
    detected: Vec<bool>,
    followers: Vec<Follower>,
    axes: Vec<Axis>,
    sensors: Vec<Sensor>,
    parts: Vec<Part>,
    /// The part that is the drive of each number, if one is.
    drivers: Vec<Option<usize>>,
    /// Brakes that signals release, by the joint.
    brakes: Vec<(usize, Slot<bool>)>,
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
        let followers = Follower::all(scene, &mut world);
        let axes = scene
            .axes
            .iter()
            .map(|axis| Axis::build(axis, scene, &mut world, [&reads, &writes]))
            .collect::<Result<Vec<_>, _>>()?;
        let sensors = scene
            .sensors
            .iter()
            .map(|sensor| Sensor::build(sensor, &mut world, &writes))
            .collect::<Result<Vec<_>, _>>()?;
        let mut parts = Vec::with_capacity(scene.components.len());
        for described in &scene.components {
            parts.push(Part::build(described, scene, (seed, period), &mut world, [&reads, &writes])?);
        }
        // now that all drives are known
        world.find_mechanisms();
        if scene.sleeping {
            world.let_sleep();
        }
        let channels = (!scene.conditions.is_empty()).then(|| Channels::pair(scene, seed));
        Ok(Self {
            motions: (0..scene.joints.len()).map(|joint| world.motion(joint)).collect(),
            drivers: drivers(&parts, &world),
            brakes: brakes(scene, &reads)?,
            setpoints: axes.iter().map(|axis| axis.rest(scene)).collect(),
            detected: vec![false; sensors.len()],
            given: parts.iter().map(|part| part.given().to_vec()).collect(),
            world,
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
            articulation: self.world.coordinates(),
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

    /// The same; nothing of a body that is out of the world.
    pub(super) fn seen(&self) -> impl Iterator<Item = Option<Placement>> {
        self.placements().zip(self.world.bodies()).map(|(placement, body)| body.is_enabled().then_some(placement))
    }

    /// The temperatures of heated surfaces, each with the index of its body.
    pub(super) fn heated(&self) -> impl Iterator<Item = (usize, &TemperatureField)> {
        self.world.heated()
    }

    /// Switches a mode of a component on.
    pub(super) fn fail(&mut self, FoundMode { component, mode }: FoundMode) {
        self.parts[component].fail(mode);
    }

    /// Switches off what [`fail`](Self::fail) has switched on; false if it has not.
    pub(super) fn repair(&mut self, FoundMode { component, mode }: FoundMode) -> bool {
        self.parts[component].repair(mode)
    }

    /// Gives a parameter another value, by its text, or the scene's own again.
    ///
    /// # Errors
    /// A value that the component does not take while it runs, or the scene's own where it has that.
    pub(super) fn change(
        &mut self,
        scene: &Scene,
        found: FoundParameter,
        to: Option<&str>,
    ) -> Result<(), ParameterRefused> {
        let FoundParameter { component, parameter } = found;
        let (part, described) = (&mut self.parts[component], &scene.components[component]);
        let to = match to {
            Some(text) => Some(scene.read_parameter(found, text, &part.settings(described))?),
            None if part.has_changed(parameter) => {
                // What the others have become meanwhile may not go with the scene's own value any more.
                scene.allow_parameter(found, described.settings[parameter], &part.settings(described))?;
                None
            }
            None => {
                let (component, parameter) = scene.names_of(found);
                return Err(ParameterRefused::Unchanged { component, parameter });
            }
        };
        part.change(described, parameter, to).map_err(|compiled| {
            let ((component, parameter), why) = (scene.names_of(found), compiled.to_string());
            ParameterRefused::Fixed { component, parameter, why }
        })
    }

    /// Takes a state in; it must fit in every part before any part takes its own.
    ///
    /// # Errors
    /// A state of another machine, which changes nothing.
    pub(super) fn restore(
        &mut self,
        scene: &Scene,
        physics: PhysicsWorld,
        memory: Memory,
    ) -> Result<(), LayoutMismatch> {
        self.check(scene, &physics, &memory)?;
        self.world.physics = physics;
        self.world.restore_coordinates(memory.articulation)?;
        for ((part, described), memory) in self.parts.iter_mut().zip(&scene.components).zip(memory.parts) {
            part.restore(memory, described)?;
        }
        for (channels, memory) in self.channels.iter_mut().flatten().zip(memory.channels.into_iter().flatten()) {
            channels.restore(memory);
        }
        self.motions = (0..scene.joints.len()).map(|joint| self.world.motion(joint)).collect();
        self.setpoints = memory.setpoints;
        self.detected = memory.detected;
        for (given, part) in self.given.iter_mut().zip(&self.parts) {
            given.clear();
            given.extend_from_slice(part.given());
        }
        Ok(())
    }

    fn check(&self, scene: &Scene, physics: &PhysicsWorld, memory: &Memory) -> Result<(), LayoutMismatch> {
        let counts = [
            ("axes", self.setpoints.len(), memory.setpoints.len()),
            ("sensors", self.detected.len(), memory.detected.len()),
            ("components", self.parts.len(), memory.parts.len()),
            ("directions of signals", self.channels.iter().flatten().count(), memory.channels.iter().flatten().count()),
        ];
        if let Some((what, own, saved)) = counts.into_iter().find(|(_, own, saved)| own != saved) {
            return Err(LayoutMismatch(format!("it has {saved} {what}, this plant has {own}")));
        }
        self.world.check(physics)?;
        for ((part, described), memory) in self.parts.iter().zip(&scene.components).zip(&memory.parts) {
            part.check(memory, described)?;
        }
        let mut channels = self.channels.iter().flatten().zip(memory.channels.iter().flatten());
        if channels.all(|(one, memory)| one.fits(memory)) {
            return Ok(());
        }
        Err(LayoutMismatch("its signals between plant and session are others".to_owned()))
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
        let Self { world, motions, setpoints, followers, axes, parts, given, dt_s, drivers, brakes, .. } = self;
        let measured = Measured { motions };
        for follower in followers {
            follower.drive(measured, *dt_s, world)?;
        }
        for (joint, release) in brakes.iter() {
            world.articulation.fittings[*joint].set_brake(release.get(inputs));
        }
        for ((axis, setpoint), described) in axes.iter().zip(setpoints).zip(&scene.axes) {
            axis.drive(&described.name, setpoint, measured, *dt_s, inputs, world)?;
        }
        let moment = Moment { t_v_ns: now_ns, dt_s: *dt_s, inputs, measured };
        for (part, described) in parts.iter_mut().zip(&scene.components) {
            part.drive(described, &moment, given, world)?;
        }
        world.step(scene, &mut Driving { parts, drivers })?;
        self.observe(scene, now_ns, inputs, outputs)
    }

    /// Measures every joint, lets every sensor and component look and writes all signals.
    fn observe(&mut self, scene: &Scene, now_ns: u64, inputs: &[u8], outputs: &mut [u8]) -> Result<(), ClientFault> {
        let Self { world, motions, setpoints, detected, axes, sensors, parts, given, dt_s, .. } = self;
        for (joint, motion) in motions.iter_mut().enumerate() {
            *motion = world.motion(joint);
        }
        let measured = Measured { motions };
        for (axis, setpoint) in axes.iter().zip(setpoints) {
            axis.feed_back(*setpoint, measured, world, outputs);
        }
        world.look_around();
        for (sensor, detected) in sensors.iter().zip(detected) {
            *detected = sensor.detects(world, motions, *detected);
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

/// The parts as the drives of a world.
struct Driving<'p> {
    parts: &'p mut [Part],
    drivers: &'p [Option<usize>],
}

impl Driving<'_> {
    fn part(&self, drive: usize) -> Option<&Part> {
        self.drivers.get(drive).copied().flatten().and_then(|part| self.parts.get(part))
    }
}

impl Drives for Driving<'_> {
    fn longest_s(&self, drive: usize) -> f64 {
        self.part(drive).map_or(f64::INFINITY, Part::longest_s)
    }

    fn advance(&mut self, drive: usize, motion: Motion, dt_s: f64) -> Effort {
        let part = self.drivers.get(drive).copied().flatten().and_then(|part| self.parts.get_mut(part));
        part.map_or(Effort::of(0.0), |part| part.advance(motion, dt_s))
    }

    fn foresee(&self, drive: usize, motion: Motion, dt_s: f64) -> Effort {
        self.part(drive).map_or(Effort::of(0.0), |part| part.foresee(motion, dt_s))
    }
}

/// The brakes that signals release.
fn brakes(scene: &Scene, reads: &PortLayout) -> Result<Vec<(usize, Slot<bool>)>, SlotError> {
    let released =
        |fitting: &model::Fitting| fitting.brake.as_ref()?.release.as_ref().map(|name| (fitting.joint, name.clone()));
    let each = scene.fittings.iter().filter_map(released);
    each.map(|(joint, name)| reads.slot(name.as_str()).map(|slot| (joint, slot))).collect()
}

/// Which part is the drive of each number.
fn drivers(parts: &[Part], world: &World) -> Vec<Option<usize>> {
    (0..world.actuators.len()).map(|drive| parts.iter().position(|part| part.drive_number() == Some(drive))).collect()
}
