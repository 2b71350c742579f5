//! The plant as a client of a session.

use std::path::Path;
use std::sync::Arc;

use onescan_base::regular;
use onescan_server::client::{
    Client, ClientFault, ClientOperation, ClientView, JoinRequest, OperationRefused, Parts, Pose, StateError, Wake,
};
use onescan_server::signal::{ClientName, Port};
use onescan_server::time::{TimeSpan, VirtualTime};

use super::failure::FailureRefused;
use super::identity::Identity;
use super::layout_mismatch::LayoutMismatch;
use super::machine::Machine;
use super::placement::{BodyPose, Placement};
use super::scene::{ParameterRefused, Scene, SceneError};
use super::state::{self, Restored};

/// A simulated machine that takes part in a session.
///
/// ```
/// use onescan_plant::Plant;
/// use onescan_server::client::Client;
/// use onescan_server::signal::ClientName;
/// use onescan_server::time::VirtualTime;
///
/// let scene = r#"
///     version = 1
///
///     [[component]]
///     name = "tank"
///     kind = "tank"
///     pump_signal = "Pump"
///     level_m_signal = "Level"
/// "#;
/// let mut plant = Plant::parse(scene, "tank.toml", ClientName::new("plant")?, "10ms".parse()?)?;
/// let (pump, mut level) = (1.0_f64.to_le_bytes(), [0; 8]);
/// plant.setup(&mut level)?;
/// let before = f64::from_le_bytes(level);
/// for step in 1..=100 {
///     plant.turn(VirtualTime::from_nanos(step * 10_000_000), &pump, &mut level)?;
/// }
/// assert!(f64::from_le_bytes(level) > before);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Plant {
    name: ClientName,
    period: TimeSpan,
    seed: u64,
    scene: Scene,
    /// The bodies' names, shared with every view of them.
    names: Vec<Arc<str>>,
    /// An error only where the scene is not plain data, which no checked scene is.
    identity: Result<Identity, String>,
    machine: Option<Machine>,
}

impl Plant {
    /// The plant of the scene file at `path`, called `name` in its session, with turns of `period`.
    ///
    /// # Errors
    /// A file that cannot be read or is not a scene.
    pub fn load(path: &Path, name: ClientName, period: TimeSpan) -> Result<Self, SceneError> {
        let file = path.display().to_string();
        match regular::read_text(path) {
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
        let identity = Identity::new(&scene, &name, period).map_err(|error| error.to_string());
        let names = scene.bodies.iter().map(|body| Arc::from(body.name.as_str())).collect();
        Self { name, period, seed: 0, scene, names, identity, machine: None }
    }

    /// The plant with the scenario's seed, on which noise and jitter depend; 0 without.
    #[must_use]
    pub fn seeded(mut self, seed: u64) -> Self {
        self.seed = seed;
        if let Ok(identity) = &mut self.identity {
            identity.seed(seed);
        }
        self
    }

    /// What the plant is made of.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The machine at work; none before the set-up.
    pub(super) fn machine(&self) -> Option<&Machine> {
        self.machine.as_ref()
    }

    /// Sets the plant up, with these components failing from `t_v = 0` on, each by one mode.
    ///
    /// # Errors
    /// Outputs of the wrong size, a component or mode that the scene does not have.
    pub fn set_up(&mut self, failing: &[(String, String)], outputs: &mut [u8]) -> Result<(), ClientFault> {
        let fails = |(component, mode): &(String, String)| ClientOperation::Fail {
            component: component.clone(),
            mode: mode.clone(),
        };
        self.begin(&failing.iter().map(fails).collect::<Vec<_>>(), outputs)
    }

    /// Makes a component fail by `mode` from the next half turn on, until it is repaired. A mode
    /// that is on stays on.
    ///
    /// # Errors
    /// A component or mode that the scene does not have; a plant before its set-up.
    pub fn fail(&mut self, component: &str, mode: &str) -> Result<(), FailureRefused> {
        let found = self.scene.find_failure(component, mode)?;
        let machine = self.machine.as_mut().ok_or_else(|| before_set_up(component))?;
        machine.fail(found);
        Ok(())
    }

    /// Ends what [`fail`](Self::fail) or [`set_up`](Self::set_up) has begun, from the next half turn
    /// on. A `[[failure]]` of the scene by the same mode goes on.
    ///
    /// # Errors
    /// A component or mode that the scene does not have or that nobody has made fail; a plant before
    /// its set-up.
    pub fn repair(&mut self, component: &str, mode: &str) -> Result<(), FailureRefused> {
        let found = self.scene.find_failure(component, mode)?;
        let machine = self.machine.as_mut().ok_or_else(|| before_set_up(component))?;
        if machine.repair(found) {
            return Ok(());
        }
        Err(FailureRefused::NotFailed { component: component.to_owned(), mode: mode.to_owned() })
    }

    /// Gives a parameter of a component another value from the next half turn on. The component keeps its state.
    ///
    /// # Errors
    /// See [`ParameterRefused`].
    pub fn change_parameter(&mut self, component: &str, parameter: &str, value: &str) -> Result<(), ParameterRefused> {
        self.change(component, parameter, Some(value))
    }

    /// Gives a parameter that was changed the scene's own value again.
    ///
    /// # Errors
    /// See [`ParameterRefused`].
    pub fn restore_parameter(&mut self, component: &str, parameter: &str) -> Result<(), ParameterRefused> {
        self.change(component, parameter, None)
    }

    fn change(&mut self, component: &str, parameter: &str, to: Option<&str>) -> Result<(), ParameterRefused> {
        let found = self.scene.find_parameter(component, parameter)?;
        let before_set_up = || ParameterRefused::BeforeSetUp { component: component.to_owned() };
        self.machine.as_mut().ok_or_else(before_set_up)?.change(&self.scene, found, to)
    }

    fn identity(&self) -> Result<&Identity, StateError> {
        self.identity.as_ref().map_err(|error| StateError::Corrupt(format!("the scene has no identity: {error}")))
    }
}

fn before_set_up(component: &str) -> FailureRefused {
    FailureRefused::BeforeSetUp { component: component.to_owned() }
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
        self.begin(&[], outputs)
    }

    fn begin(&mut self, operations: &[ClientOperation], outputs: &mut [u8]) -> Result<(), ClientFault> {
        check_size("outputs", &self.scene.writes, outputs)?;
        let machine = Machine::build(&self.scene, self.period, self.seed)
            .map_err(|unbuilt| ClientFault::new(unbuilt.to_string()))?;
        self.machine = Some(machine);
        for operation in operations {
            self.operate(operation).map_err(|refused| match refused {
                OperationRefused::Because(why) => ClientFault::new(why),
                OperationRefused::Unsupported => ClientFault::new(format!("{operation}: {refused}")),
            })?;
        }
        let machine = self.machine.as_mut().ok_or_else(|| ClientFault::new("a plant lost its machine"))?;
        machine.begin(&self.scene, outputs)
    }

    fn operate(&mut self, operation: &ClientOperation) -> Result<(), OperationRefused> {
        let why = |refused: &dyn std::fmt::Display| OperationRefused::Because(refused.to_string());
        match operation {
            ClientOperation::Fail { component, mode } => self.fail(component, mode).map_err(|refused| why(&refused)),
            ClientOperation::Repair { component, mode } => {
                self.repair(component, mode).map_err(|refused| why(&refused))
            }
            ClientOperation::ChangeParameter { component, parameter, value } => {
                self.change_parameter(component, parameter, value).map_err(|refused| why(&refused))
            }
            ClientOperation::RestoreParameter { component, parameter } => {
                self.restore_parameter(component, parameter).map_err(|refused| why(&refused))
            }
            ClientOperation::WriteVariable { .. }
            | ClientOperation::ForceVariable { .. }
            | ClientOperation::ReleaseVariable { .. }
            | ClientOperation::Postpone { .. }
            | ClientOperation::CatchUp { .. } => Err(OperationRefused::Unsupported),
        }
    }

    fn show(&self, parts: Parts, view: &mut ClientView) {
        if parts.poses {
            let seen = self.machine().into_iter().flat_map(Machine::seen);
            view.poses.extend(seen.zip(&self.names).map(|(placement, name)| Pose {
                body: Arc::clone(name),
                // What is out of the world is nowhere.
                position_m: placement.map_or([f64::NAN; 3], |placement| placement.position_m),
                rotation_xyzw: placement.map_or([0.0, 0.0, 0.0, 1.0], |placement| placement.rotation_xyzw),
            }));
        }
        if parts.tables {
            let heated = self.machine.iter().flat_map(Machine::heated);
            view.tables.extend(heated.map(|(body, field)| field.unrolled(&self.name, &self.names[body])));
        }
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
        let memory = machine.memory().map_err(|error| StateError::Corrupt(error.to_string()))?;
        state::to_bytes(self.identity()?, &machine.world.physics, &memory)
    }

    fn restore(&mut self, bytes: &[u8]) -> Result<(), StateError> {
        let Restored { physics, memory } = state::from_bytes(self.identity()?, bytes)?;
        let mismatch = |mismatch: LayoutMismatch| StateError::Corrupt(mismatch.to_string());
        // A machine is its scene's handles and wiring, which never change, and its state, all of
        // which is replaced: one that has run is as good as a new one.
        if let Some(machine) = &mut self.machine {
            return machine.restore(&self.scene, physics, memory).map_err(mismatch);
        }
        let mut machine = Machine::build(&self.scene, self.period, self.seed)
            .map_err(|error| StateError::Corrupt(error.to_string()))?;
        machine.restore(&self.scene, physics, memory).map_err(mismatch)?;
        self.machine = Some(machine);
        Ok(())
    }
}

impl Plant {
    /// Where the bodies are, in the scene's order; nothing before the set-up.
    pub fn poses(&self) -> impl Iterator<Item = BodyPose<'_>> {
        self.placements().zip(&self.scene().bodies).map(|(placement, body)| {
            let Placement { position_m, rotation_xyzw } = placement;
            BodyPose { name: &body.name, position_m, rotation_xyzw }
        })
    }

    /// Where the bodies are, in the order of [`scene`](Self::scene)`().bodies`, in place of what
    /// `into` held; nothing before the set-up. From the second call on it allocates nothing.
    pub fn write_poses(&self, into: &mut Vec<Placement>) {
        into.clear();
        into.extend(self.placements());
    }

    fn placements(&self) -> impl Iterator<Item = Placement> {
        self.machine().into_iter().flat_map(Machine::placements)
    }
}
