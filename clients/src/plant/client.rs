//! The plant as a client of a session.

use std::path::Path;

use onescan_server::client::{Client, ClientFault, JoinRequest, StateError, Wake};
use onescan_server::signal::{ClientName, Port, SlotError};
use onescan_server::time::{TimeSpan, VirtualTime};

use super::machine::Machine;
use super::scene::{Scene, SceneError};
use super::state;

/// A simulated machine that takes part in a session.
pub struct Plant {
    name: ClientName,
    period: TimeSpan,
    seed: u64,
    scene: Scene,
    identity: blake3::Hash,
    machine: Option<Machine>,
}

impl Plant {
    /// The plant of the scene file at `path`, called `name` in its session, with turns of `period`.
    ///
    /// # Errors
    /// A file that cannot be read or is not a scene.
    pub fn load(path: &Path, name: ClientName, period: TimeSpan) -> Result<Self, SceneError> {
        let file = path.display().to_string();
        match std::fs::read_to_string(path) {
            Ok(text) => Self::parse(&text, &file, name, period),
            Err(error) => Err(SceneError::Unreadable { file, cause: error.to_string() }),
        }
    }

    /// The plant of a scene in `text`; faults call it `file`.
    ///
    /// # Errors
    /// A text that is not a scene.
    pub fn parse(text: &str, file: &str, name: ClientName, period: TimeSpan) -> Result<Self, SceneError> {
        Ok(Self::new(Scene::parse(text, file)?, name, period))
    }

    /// The plant of a scene that was checked before.
    pub fn new(scene: Scene, name: ClientName, period: TimeSpan) -> Self {
        let identity = identity(&scene, &name, period, 0);
        Self { name, period, seed: 0, scene, identity, machine: None }
    }

    /// The plant with the scenario's seed, on which noise and jitter depend; 0 without.
    #[must_use]
    pub fn seeded(mut self, seed: u64) -> Self {
        self.seed = seed;
        self.identity = identity(&self.scene, &self.name, self.period, seed);
        self
    }

    /// What the plant is made of.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Where the bodies are, in the scene's order; nothing before the set-up.
    pub fn poses(&self) -> impl Iterator<Item = BodyPose<'_>> {
        let machine = self.machine.iter();
        machine.flat_map(|machine| {
            self.scene.bodies.iter().enumerate().map(|(index, body)| {
                let pose = machine.world.body(machine.world.handle(Some(index))).position();
                BodyPose {
                    name: &body.name,
                    position_m: pose.translation.to_array(),
                    rotation_xyzw: pose.rotation.to_array(),
                }
            })
        })
    }
}

/// Where a body is, for recordings and pictures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyPose<'p> {
    /// The body.
    pub name: &'p str,
    /// Its origin.
    pub position_m: [f64; 3],
    /// Its orientation, a unit quaternion with the scalar last.
    pub rotation_xyzw: [f64; 4],
}

/// A digest of all that a plant's state depends on.
fn identity(scene: &Scene, name: &ClientName, period: TimeSpan, seed: u64) -> blake3::Hash {
    // plain data of known length always has bytes
    let bytes = postcard::to_stdvec(&(scene, name, period, seed)).unwrap_or_default();
    blake3::hash(&bytes)
}

/// Refuses a port of the wrong size, in which no slot could be trusted.
fn check_size(which: &str, ports: &[Port], bytes: &[u8]) -> Result<(), ClientFault> {
    let wanted: usize = ports.iter().map(|port| port.ty.size()).sum();
    if bytes.len() == wanted {
        return Ok(());
    }
    Err(ClientFault::new(format!("{which} of {} bytes where {wanted} are wanted", bytes.len())))
}

impl Client for Plant {
    fn join(&self) -> JoinRequest {
        JoinRequest {
            name: self.name.clone(),
            period: self.period,
            reads: self.scene.reads.clone(),
            writes: self.scene.writes.clone(),
        }
    }

    fn setup(&mut self, outputs: &mut [u8]) -> Result<(), ClientFault> {
        check_size("outputs", &self.scene.writes, outputs)?;
        let machine = Machine::build(&self.scene, self.period, self.seed).map_err(|error| unbound(&error))?;
        self.machine.insert(machine).begin(&self.scene, outputs)
    }

    fn turn(&mut self, t_v: VirtualTime, inputs: &[u8], outputs: &mut [u8]) -> Result<Wake, ClientFault> {
        check_size("inputs", &self.scene.reads, inputs)?;
        check_size("outputs", &self.scene.writes, outputs)?;
        let machine = self.machine.as_mut().ok_or_else(|| ClientFault::new("a turn before the set-up"))?;
        machine.turn(&self.scene, t_v, inputs, outputs)?;
        Ok(Wake::NextPeriod)
    }

    fn save(&self) -> Result<Vec<u8>, StateError> {
        let machine =
            self.machine.as_ref().ok_or_else(|| StateError::Corrupt("there is no state before the set-up".into()))?;
        state::to_bytes(self.identity, &machine.world.physics, &machine.memory())
    }

    fn restore(&mut self, bytes: &[u8]) -> Result<(), StateError> {
        let restored = state::from_bytes(self.identity, bytes)?;
        let mut machine = Machine::build(&self.scene, self.period, self.seed)
            .map_err(|error| StateError::Corrupt(error.to_string()))?;
        if !machine.restore(restored.memory) {
            return Err(StateError::Corrupt("it has other joints, axes, sensors or components".to_owned()));
        }
        machine.world.physics = restored.physics;
        self.machine = Some(machine);
        Ok(())
    }
}

/// A signal that was lost between the scene and its ports.
fn unbound(error: &SlotError) -> ClientFault {
    ClientFault::new(error.to_string())
}
