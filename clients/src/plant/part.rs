//! A component of the scene at work: bound to its signals, to other components and to the world.

use onescan_server::client::ClientFault;
use onescan_server::signal::{PortLayout, Slot, SlotError};
use rapier3d::math::Vector;
use rapier3d::prelude::*;
use serde::{Deserialize, Serialize};

use super::axis::{Measured, arm};
use super::command::NumberSlot;
use super::component::behaviour::{Running, Start, Turn};
use super::component::coupling::{Coordinate, Effect, Seen};
use super::component::declare::{Failed, Value};
use super::component::kind::Values;
use super::component::library::entry;
use super::machine::Misfit;
use super::random::seed_for;
use super::scene::Scene;
use super::scene::model::{self, Bound, When, Wire};
use super::world::{Surface, World, measured_axis};

/// The part of a joint's deviation that one period corrects, as for an axis.
const CORRECTED_A_PERIOD: f64 = 0.25;
const MOTOR_GAIN_PER_S: f64 = 1e12;

/// A value in a port.
#[derive(Clone, Copy)]
enum ValueSlot {
    Bool(Slot<bool>),
    Number(NumberSlot),
    Whole(Slot<i32>),
}

impl ValueSlot {
    fn find(layout: &PortLayout, name: &str, values: Values, number: model::NumberType) -> Result<Self, SlotError> {
        Ok(match values {
            Values::Bool => Self::Bool(layout.slot(name)?),
            Values::Whole => Self::Whole(layout.slot(name)?),
            Values::Number => Self::Number(match number {
                model::NumberType::Real => NumberSlot::Real(layout.slot(name)?),
                model::NumberType::Lreal => NumberSlot::Lreal(layout.slot(name)?),
            }),
        })
    }

    fn get(self, port: &[u8]) -> Value {
        match self {
            Self::Bool(slot) => Value::Bool(slot.get(port)),
            Self::Whole(slot) => Value::Whole(slot.get(port)),
            Self::Number(slot) => Value::Number(slot.get(port)),
        }
    }

    fn set(self, port: &mut [u8], value: Value) {
        match (self, value) {
            (Self::Bool(slot), Value::Bool(value)) => slot.set(port, value),
            (Self::Whole(slot), Value::Whole(value)) => slot.set(port, value),
            (Self::Number(slot), Value::Number(value)) => slot.set(port, value),
            // a component gives the values that its kind states
            _ => {}
        }
    }
}

/// Where an input comes from.
enum Feed {
    Open,
    Port(ValueSlot),
    Output { part: usize, output: usize },
}

/// When a mode of failure is on.
enum Switch {
    Signal(Slot<bool>),
    Between(model::Between),
}

/// What of the world a part is bound to.
enum Tie {
    Nothing,
    Moved { joint: usize, motor: ImpulseJointHandle, along: JointAxis },
    Measured(usize),
    Belt { body: RigidBodyHandle, direction: Vector },
    Ray { body: RigidBodyHandle, point: Vector, direction: Vector, targets: Vec<RigidBodyHandle> },
    Touch { surface: Surface, targets: Vec<RigidBodyHandle> },
    Meet { targets: Vec<RigidBodyHandle> },
    Collect { body: RigidBodyHandle, targets: Vec<RigidBodyHandle> },
    Place { body: RigidBodyHandle, targets: Vec<RigidBodyHandle> },
}

/// A component at work.
pub(super) struct Part {
    running: Box<dyn Running>,
    tie: Tie,
    feeds: Vec<Feed>,
    outputs: Vec<Option<ValueSlot>>,
    switches: Vec<(usize, Switch)>,
    /// Inputs of this turn; those that nothing feeds never change.
    taken: Vec<Value>,
    /// Outputs of the last turn.
    given: Vec<Value>,
    held: Option<Held>,
    /// What has been made to fail while the plant runs, beside what the switches say.
    failed: Failed,
}

/// A body that a part holds fast.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Held {
    target: u32,
    joint: ImpulseJointHandle,
}

/// What a part remembers, as plain data.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct PartMemory {
    state: Vec<u8>,
    given: Vec<Value>,
    held: Option<Held>,
    failed: Failed,
}

/// What surrounds a part in a half turn.
#[derive(Clone, Copy)]
pub(super) struct Moment<'m> {
    pub(super) t_v_ns: u64,
    pub(super) dt_s: f64,
    pub(super) inputs: &'m [u8],
    pub(super) measured: Measured<'m>,
}

impl Part {
    /// Binds a component in a world that still stands in the scene's pose; none for a kind that is
    /// not in the library, which no checked scene has.
    pub(super) fn build(
        described: &model::Component,
        scene: &Scene,
        seed: u64,
        world: &mut World,
        [reads, writes]: [&PortLayout; 2],
    ) -> Result<Option<Self>, SlotError> {
        let Some(entry) = entry(described.kind) else { return Ok(None) };
        let kind = (entry.kind)();
        let mut feeds = Vec::new();
        for (wire, input) in described.inputs.iter().zip(&kind.inputs) {
            feeds.push(match wire {
                Wire::Open => Feed::Open,
                Wire::Signal(name) => {
                    Feed::Port(ValueSlot::find(reads, name.as_str(), input.values, described.number)?)
                }
                Wire::Output { component, output } => Feed::Output { part: *component, output: *output },
            });
        }
        let mut outputs = Vec::new();
        for (name, output) in described.outputs.iter().zip(&kind.outputs) {
            let slot = |name: &onescan_server::signal::SignalName| {
                ValueSlot::find(writes, name.as_str(), output.values, described.number)
            };
            outputs.push(name.as_ref().map(slot).transpose()?);
        }
        let mut switches = Vec::new();
        for failure in &described.failures {
            let switch = match &failure.when {
                When::Signal(name) => Switch::Signal(reads.slot(name.as_str())?),
                When::Between(between) => Switch::Between(*between),
            };
            switches.push((failure.mode, switch));
        }
        let tie = Tie::bind(&described.bound, scene, world);
        let joint = match described.bound {
            Bound::Drives(index) | Bound::Measures(index) => {
                Some(Coordinate { position: scene.joints[index].initial, velocity: 0.0 })
            }
            _ => None,
        };
        let start = Start { joint, seed: seed_for(seed, "component", &described.name) };
        Ok(Some(Self {
            running: (entry.start)(&described.settings, &start),
            tie,
            feeds,
            outputs,
            switches,
            taken: (entry.unconnected)(),
            given: kind.outputs.iter().map(|output| Value::zero(output.values)).collect(),
            held: None,
            failed: Failed::default(),
        }))
    }

    /// First half of a turn, before the world moves; `others` are all parts' outputs so far.
    ///
    /// # Errors
    /// An input that is not a finite number.
    pub(super) fn drive(
        &mut self,
        described: &model::Component,
        moment: &Moment<'_>,
        others: &[Vec<Value>],
        world: &mut World,
    ) -> Result<(), ClientFault> {
        self.take(described, moment, others)?;
        let turn = self.turn(moment, world);
        self.running.drive(&self.taken, &turn);
        let effect = self.running.effect();
        self.apply(effect, moment, world);
        Ok(())
    }

    /// Second half of a turn, after the world has moved.
    ///
    /// # Errors
    /// An input that is not a finite number.
    pub(super) fn sense(
        &mut self,
        described: &model::Component,
        moment: &Moment<'_>,
        others: &[Vec<Value>],
        world: &World,
        outputs: &mut [u8],
    ) -> Result<(), ClientFault> {
        self.take(described, moment, others)?;
        let turn = self.turn(moment, world);
        self.running.sense(&self.taken, &turn, &mut self.given);
        for (slot, value) in self.outputs.iter().zip(&self.given) {
            if let Some(slot) = slot {
                slot.set(outputs, *value);
            }
        }
        Ok(())
    }

    /// The outputs of the last turn.
    pub(super) fn given(&self) -> &[Value] {
        &self.given
    }

    /// Switches a mode on from the next half turn on, by its place among those of the kind.
    pub(super) fn fail(&mut self, mode: usize) {
        self.failed = self.failed.with(mode);
    }

    /// Switches off what [`fail`](Self::fail) has switched on; false if it has not.
    pub(super) fn repair(&mut self, mode: usize) -> bool {
        let repaired = self.failed.without(mode);
        std::mem::replace(&mut self.failed, repaired) != repaired
    }

    /// # Errors
    /// A state that does not go into bytes, which no kind has: each is plain data.
    pub(super) fn memory(&self) -> Result<PartMemory, postcard::Error> {
        let Self { given, held, failed, .. } = self;
        Ok(PartMemory { state: self.running.save()?, given: given.clone(), held: *held, failed: *failed })
    }

    /// Checks that a memory is one of such a part; `name` is the part in the refusal.
    ///
    /// # Errors
    /// A memory of another part.
    pub(super) fn check(&self, memory: &PartMemory, name: &str) -> Result<(), Misfit> {
        let foreign = |why: &str| Misfit(format!("component `{name}`: {why}"));
        if !self.given.iter().map(Value::values).eq(memory.given.iter().map(Value::values)) {
            return Err(foreign("its outputs are others"));
        }
        self.running.check(&memory.state).map_err(|error| foreign(&error.to_string()))
    }

    /// Takes a memory in; `name` is the part in the refusal.
    ///
    /// # Errors
    /// A memory that [`check`](Self::check) refuses.
    pub(super) fn restore(&mut self, memory: PartMemory, name: &str) -> Result<(), Misfit> {
        let taken = self.running.restore(&memory.state);
        taken.map_err(|error| Misfit(format!("component `{name}`: {error}")))?;
        (self.given, self.held, self.failed) = (memory.given, memory.held, memory.failed);
        Ok(())
    }

    fn take(
        &mut self,
        described: &model::Component,
        moment: &Moment<'_>,
        others: &[Vec<Value>],
    ) -> Result<(), ClientFault> {
        for (index, feed) in self.feeds.iter().enumerate() {
            let value = match feed {
                Feed::Open => continue,
                Feed::Port(slot) => slot.get(moment.inputs),
                Feed::Output { part, output } => others[*part][*output],
            };
            if let Value::Number(number) = value
                && !number.is_finite()
            {
                let name = match &described.inputs[index] {
                    Wire::Signal(name) => name.as_str(),
                    Wire::Open | Wire::Output { .. } => "a wire",
                };
                let told = format!("component `{}` gets {number} from {name}, which is not finite", described.name);
                return Err(ClientFault::new(told));
            }
            self.taken[index] = value;
        }
        Ok(())
    }

    fn turn(&self, moment: &Moment<'_>, world: &World) -> Turn {
        let mut failed = self.failed;
        for (mode, switch) in &self.switches {
            let on = match switch {
                Switch::Signal(slot) => slot.get(moment.inputs),
                Switch::Between(between) => (between.from_ns..between.until_ns).contains(&moment.t_v_ns),
            };
            if on {
                failed = failed.with(*mode);
            }
        }
        Turn { dt_s: moment.dt_s, seen: self.tie.see(moment.measured, world), failed }
    }

    fn apply(&mut self, effect: Effect, moment: &Moment<'_>, world: &mut World) {
        match (effect, &self.tie) {
            (Effect::Move { from, to, effort_max }, Tie::Moved { joint, motor, along }) => {
                let correction = CORRECTED_A_PERIOD * (from - moment.measured.positions[*joint]);
                let velocity = (to - from + correction) / moment.dt_s;
                if let Some(joint) = world.physics.impulse_joints.get_mut(*motor, true) {
                    joint.data.set_motor_velocity(*along, velocity, MOTOR_GAIN_PER_S);
                    joint.data.set_motor_max_force(*along, effort_max);
                }
            }
            (Effect::Run { velocity_m_s }, Tie::Belt { body, direction }) => {
                if let Some(body) = world.physics.bodies.get_mut(*body) {
                    body.set_linvel(*direction * velocity_m_s, true);
                }
            }
            (Effect::Hold(target), Tie::Touch { surface, targets }) if self.held.map(|held| held.target) != target => {
                if let Some(held) = self.held.take() {
                    world.physics.remove_impulse_joint(held.joint);
                }
                self.held = target.and_then(|target| {
                    let joint = world.hold(surface.body, *targets.get(target as usize)?);
                    Some(Held { target, joint })
                });
            }
            (Effect::Remove(target), Tie::Collect { targets, .. }) => {
                if let Some(target) = targets.get(target as usize) {
                    world.take_out(*target);
                }
            }
            (Effect::Place(target), Tie::Place { body, targets }) => {
                if let Some(target) = targets.get(target as usize) {
                    world.put_in(*target, *body);
                }
            }
            _ => {}
        }
    }
}

impl Tie {
    fn bind(bound: &Bound, scene: &Scene, world: &mut World) -> Self {
        let handles = |world: &World, indices: &[usize]| -> Vec<_> {
            indices.iter().map(|index| world.handle(Some(*index))).collect()
        };
        match bound {
            Bound::Nothing => Self::Nothing,
            Bound::Drives(joint) => {
                let (motor, along) = (world.joint(*joint), measured_axis(scene.joints[*joint].kind));
                arm(world, motor, along, None);
                Self::Moved { joint: *joint, motor, along }
            }
            Bound::Measures(joint) => Self::Measured(*joint),
            Bound::Belt { body, direction } => {
                let body = world.handle(Some(*body));
                world.keep_in_place(body);
                Self::Belt { body, direction: Vector::from_array(*direction) }
            }
            Bound::Ray { body, point_m, direction, targets } => {
                let body = world.handle(*body);
                let pose = world.body(body).position();
                Self::Ray {
                    body,
                    point: pose.inverse_transform_point(Vector::from_array(*point_m)),
                    direction: pose.inverse_transform_vector(Vector::from_array(*direction)),
                    targets: handles(world, targets),
                }
            }
            Bound::Touch { body, shape, targets } => {
                let shape = shape.map(|shape| world.shape(shape));
                let surface = Surface { body: world.handle(Some(*body)), shape };
                Self::Touch { surface, targets: handles(world, targets) }
            }
            Bound::Meet { targets } => {
                let mut targets = handles(world, targets);
                targets.sort_unstable_by_key(|target| target.0);
                Self::Meet { targets }
            }
            Bound::Collect { body, targets } => {
                Self::Collect { body: world.handle(Some(*body)), targets: handles(world, targets) }
            }
            Bound::Place { body, targets } => {
                let targets = handles(world, targets);
                for target in &targets {
                    world.take_out(*target);
                }
                Self::Place { body: world.handle(Some(*body)), targets }
            }
        }
    }

    fn see(&self, measured: Measured<'_>, world: &World) -> Seen {
        let joint = |index: usize| {
            let (position, velocity) = (measured.positions[index], measured.gauges[index].velocity(world));
            Seen { joint: Some(Coordinate { position, velocity }), ..Seen::default() }
        };
        match self {
            Self::Nothing | Self::Belt { .. } => Seen::default(),
            Self::Moved { joint: index, .. } | Self::Measured(index) => joint(*index),
            Self::Ray { body, point, direction, targets } => {
                let pose = *world.body(*body).position();
                let ray = Ray::new(pose * *point, pose.rotation * *direction);
                let hits = targets.iter().filter_map(|target| world.ray_distance(&ray, *target));
                Seen { hit_m: hits.reduce(f64::min), ..Seen::default() }
            }
            Self::Touch { surface, targets } => first(targets, |target| world.touch(*surface, target)),
            Self::Meet { targets } => Seen { count: world.contacts_among(targets), ..Seen::default() },
            Self::Collect { body, targets } => {
                let surface = Surface { body: *body, shape: None };
                first(targets, |target| !world.hangs(target) && world.touch(surface, target))
            }
            Self::Place { body, targets } => {
                let surface = Surface { body: *body, shape: None };
                let seen = first(targets, |target| !world.body(target).is_enabled());
                let free = !targets.iter().any(|target| world.touch(surface, *target));
                Seen { target: seen.target.filter(|_| free), ..seen }
            }
        }
    }
}

/// The first of the targets for which something holds, and how many there are.
fn first(targets: &[RigidBodyHandle], holds: impl Fn(RigidBodyHandle) -> bool) -> Seen {
    let mut seen = Seen::default();
    for (index, target) in targets.iter().enumerate() {
        if holds(*target) {
            seen.count += 1;
            seen.target = seen.target.or(Some(index as u32));
        }
    }
    seen
}
