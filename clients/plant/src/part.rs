//! A component of the scene at work: bound to its signals, to other components and to the world.

use std::collections::BTreeMap;
use std::ops::Range;

use onescan_server::client::ClientFault;
use onescan_server::signal::{PortLayout, SignalName, Slot, SlotError};
use onescan_server::time::TimeSpan;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::command::NumberSlot;
use super::component::behaviour::{Compiled, Running, Surroundings};
use super::component::declare::{Failed, Value};
use super::component::instance::{Between, Component, FailureSwitch, When, Wire};
use super::component::kind::{Setting, Signal, Values};
use super::component::origin::{Making, Unmade};
use super::effort::{Effort, Motion};
use super::layout_mismatch::LayoutMismatch;
use super::model;
use super::scene::Scene;
use super::world::World;
use super::world::coordinate::Measured;
use onescan_base::SignalType;
use onescan_base::byte_line::DEFAULT_WINDOW;
use onescan_server::random::seed_for;
use onescan_stream::{Port, PortState};

/// Why a plant cannot be built; no checked scene is the cause.
#[derive(Clone, Debug, PartialEq, Error)]
pub(super) enum Unbuilt {
    /// A signal that the plant's ports do not have.
    #[error(transparent)]
    Slot(#[from] SlotError),
    #[error("component `{0}`: {1}")]
    Unmade(String, Unmade),
}

/// A value in a port.
#[derive(Clone, Copy)]
enum ValueSlot {
    Bool(Slot<bool>),
    Number(NumberSlot),
    Whole(Slot<i32>),
    /// A port reads or writes it.
    Line,
}

impl ValueSlot {
    fn find(
        layout: &PortLayout,
        name: &SignalName,
        values: Values,
        number: model::NumberType,
    ) -> Result<Self, SlotError> {
        Ok(match values {
            Values::Bool => Self::Bool(layout.slot(name.as_str())?),
            Values::Whole => Self::Whole(layout.slot(name.as_str())?),
            Values::Number => Self::Number(NumberSlot::find(layout, name, number)?),
            Values::Bytes => Self::Line,
        })
    }

    fn get(self, port: &[u8]) -> Value {
        match self {
            Self::Bool(slot) => Value::Bool(slot.get(port)),
            Self::Whole(slot) => Value::Whole(slot.get(port)),
            Self::Number(slot) => Value::Number(slot.get(port)),
            Self::Line => Value::Bytes,
        }
    }

    /// True if the value is of the slot's type, and written.
    #[must_use]
    fn set(self, port: &mut [u8], value: Value) -> bool {
        match (self, value) {
            (Self::Bool(slot), Value::Bool(value)) => slot.set(port, value),
            (Self::Whole(slot), Value::Whole(value)) => slot.set(port, value),
            (Self::Number(slot), Value::Number(value)) => slot.set(port, value),
            (Self::Line, Value::Bytes) => {}
            (Self::Bool(_) | Self::Whole(_) | Self::Number(_) | Self::Line, _) => return false,
        }
        true
    }
}

/// Where an input comes from.
enum Feed {
    Port(ValueSlot),
    Output { part: usize, output: usize },
}

/// Where the signals of a port lie in the plant's inputs and outputs; nowhere, if it is not connected.
struct LinePlaces {
    reads: Option<Range<usize>>,
    writes: Option<Range<usize>>,
}

impl LinePlaces {
    /// What the other side has put on the line: nothing, if there is none.
    fn input<'i>(&self, inputs: &'i [u8]) -> &'i [u8] {
        self.reads.clone().and_then(|place| inputs.get(place)).unwrap_or_default()
    }

    fn output<'o>(&self, outputs: &'o mut [u8]) -> &'o mut [u8] {
        self.writes.clone().and_then(|place| outputs.get_mut(place)).unwrap_or_default()
    }
}

/// When a mode of failure is on.
enum Switch {
    Signal(Slot<bool>),
    Between(Between),
}

/// A component at work.
pub(super) struct Part {
    running: Box<dyn Running>,
    /// By their places among the inputs; constants and presets are not fed.
    feeds: Vec<(usize, Feed)>,
    /// Those that are signals, by their places among the outputs.
    outputs: Vec<(usize, ValueSlot)>,
    switches: Vec<(usize, Switch)>,
    ports: Vec<Port>,
    /// Where the lines of each port lie.
    lines: Vec<LinePlaces>,
    /// Inputs of this turn; those that nothing feeds never change.
    taken: Vec<Value>,
    /// Outputs of the last turn.
    given: Vec<Value>,
    /// What has been made to fail while the plant runs, beside what the switches say.
    failed: Failed,
    /// Parameters that have another value than in the scene, by their places.
    changed: BTreeMap<usize, Setting>,
}

/// What a part remembers, as plain data.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct PartMemory {
    state: Vec<u8>,
    given: Vec<Value>,
    failed: Failed,
    ports: Vec<PortState>,
    /// Changed parameters, as places and texts.
    changed: Vec<(u32, String)>,
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
    /// Binds a component in a world that still stands in the scene's pose.
    ///
    /// # Errors
    /// None that a checked scene could cause.
    pub(super) fn build(
        described: &Component,
        scene: &Scene,
        (seed, period): (u64, TimeSpan),
        world: &mut World,
        [reads, writes]: [&PortLayout; 2],
    ) -> Result<Self, Unbuilt> {
        let kind = &described.kind;
        let mut feeds = Vec::new();
        let mut taken = kind.unconnected();
        for (index, (wire, input)) in described.inputs.iter().zip(&kind.inputs).enumerate() {
            match wire {
                Wire::Open => {}
                Wire::Constant(setting) => taken[index] = Value::of(*setting).unwrap_or(taken[index]),
                Wire::Signal(name) => {
                    feeds.push((index, Feed::Port(ValueSlot::find(reads, name, input.values, described.number)?)));
                }
                Wire::Output { component, output } => {
                    feeds.push((index, Feed::Output { part: *component, output: *output }));
                }
            }
        }
        let mut outputs = Vec::new();
        for (index, (name, output)) in described.outputs.iter().zip(&kind.outputs).enumerate() {
            if let Some(name) = name {
                outputs.push((index, ValueSlot::find(writes, name, output.values, described.number)?));
            }
        }
        let seed = seed_for(seed, "component", &described.name);
        let making = Making { seed, bound: &described.bound, scene, period };
        let running = kind.make(&described.settings, &making, world);
        let running = running.map_err(|unmade| Unbuilt::Unmade(described.name.clone(), unmade))?;
        let (ports, lines) = ports(described, &*running, seed, [reads, writes]).into_iter().unzip();
        Ok(Self {
            running,
            ports,
            lines,
            feeds,
            outputs,
            switches: switches(described, reads)?,
            taken,
            given: kind.outputs.iter().map(|output| Value::zero(output.values)).collect(),
            failed: Failed::default(),
            changed: BTreeMap::new(),
        })
    }

    /// First half of a turn, before the world moves; `others` are all parts' outputs so far.
    ///
    /// # Errors
    /// An input that is not a finite number.
    pub(super) fn drive(
        &mut self,
        described: &Component,
        moment: &Moment<'_>,
        others: &[Vec<Value>],
        world: &mut World,
    ) -> Result<(), ClientFault> {
        self.take(described, moment, others)?;
        let around = self.surroundings(moment);
        let driven = self.running.drive(&self.taken, &around, world);
        driven.map_err(|ClientFault { message, place }| ClientFault {
            place,
            ..ClientFault::new(format!("component `{}`: {message}", described.name))
        })
    }

    /// Second half of a turn, after the world has moved.
    ///
    /// # Errors
    /// An input that is not a finite number.
    pub(super) fn sense(
        &mut self,
        described: &Component,
        moment: &Moment<'_>,
        others: &[Vec<Value>],
        world: &World,
        outputs: &mut [u8],
    ) -> Result<(), ClientFault> {
        self.take(described, moment, others)?;
        self.talk(moment, world, outputs);
        self.running.sense(&self.taken, &self.surroundings(moment), world, &mut self.given);
        for (index, slot) in &self.outputs {
            let value = self.given[*index];
            // a component gives the values that its kind states, by the same macro
            if !slot.set(outputs, value) {
                let name = &described.name;
                return Err(ClientFault::new(format!(
                    "component `{name}` gives {value:?} where another type is wanted"
                )));
            }
        }
        Ok(())
    }

    /// Lets bytes arrive, the component receive and send, and bytes depart; at the set-up the lines are as they begin.
    fn talk(&mut self, moment: &Moment<'_>, world: &World, outputs: &mut [u8]) {
        if self.ports.is_empty() {
            return;
        }
        let (around, now_ns) = (self.surroundings(moment), moment.t_v_ns);
        let Self { ports, lines, running, taken, .. } = self;
        if now_ns == 0 {
            ports.iter().zip(lines).for_each(|(port, places)| port.show(places.output(outputs)));
            return;
        }
        for (port, places) in ports.iter_mut().zip(&*lines) {
            port.arrive(now_ns, places.input(moment.inputs));
        }
        running.talk(taken, &around, world, ports);
        for (port, places) in ports.iter_mut().zip(lines) {
            port.depart(now_ns, places.input(moment.inputs), places.output(outputs));
        }
    }

    /// The number of the drive that it is, if it drives a joint by its own equations.
    pub(super) fn drive_number(&self) -> Option<usize> {
        self.running.drive_number()
    }

    /// The longest sub-step of its equations, s.
    pub(super) fn longest_s(&self) -> f64 {
        self.running.longest_s()
    }

    /// Moves its state by a sub-step in which its joint moves so.
    pub(super) fn advance(&mut self, motion: Motion, dt_s: f64) -> Effort {
        self.running.advance(motion, dt_s)
    }

    /// What it would exert at the end of a step in which its joint moves so.
    pub(super) fn foresee(&self, motion: Motion, dt_s: f64) -> Effort {
        self.running.foresee(motion, dt_s)
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

    /// The settings with which it runs, one for each parameter.
    pub(super) fn settings(&self, described: &Component) -> Vec<Setting> {
        settings(described, &self.changed)
    }

    /// Gives a parameter another value from the next half turn on, or the scene's own again.
    ///
    /// # Errors
    /// A component that is compiled with its parameters.
    pub(super) fn change(
        &mut self,
        described: &Component,
        parameter: usize,
        to: Option<Setting>,
    ) -> Result<(), Compiled> {
        let mut changed = self.changed.clone();
        match to {
            Some(setting) => drop(changed.insert(parameter, setting)),
            None => drop(changed.remove(&parameter)),
        }
        self.running.tune(&settings(described, &changed))?;
        self.changed = changed;
        Ok(())
    }

    /// Whether a parameter has another value than in the scene.
    pub(super) fn has_changed(&self, parameter: usize) -> bool {
        self.changed.contains_key(&parameter)
    }

    /// # Errors
    /// A state that does not go into bytes, which no kind has: each is plain data.
    pub(super) fn memory(&self) -> Result<PartMemory, postcard::Error> {
        let ports = self.ports.iter().map(|port| port.state().clone()).collect();
        // a kind has a handful of parameters
        let changed = self.changed.iter().map(|(place, setting)| (*place as u32, setting.text())).collect();
        Ok(PartMemory { state: self.running.save()?, given: self.given.clone(), failed: self.failed, ports, changed })
    }

    /// Checks that a memory is one of such a part.
    ///
    /// # Errors
    /// A memory of another part.
    pub(super) fn check(&self, memory: &PartMemory, described: &Component) -> Result<(), LayoutMismatch> {
        let foreign = |why: &str| LayoutMismatch(format!("component `{}`: {why}", described.name));
        changed(described, memory).ok_or_else(|| others(described))?;
        if !self.given.iter().map(Value::values).eq(memory.given.iter().map(Value::values)) {
            return Err(foreign("its outputs are others"));
        }
        let mut ports = self.ports.iter().zip(&memory.ports);
        if self.ports.len() != memory.ports.len() || !ports.all(|(port, state)| port.check(state).is_ok()) {
            return Err(foreign("its lines of bytes are others"));
        }
        self.running.check(&memory.state).map_err(|error| foreign(&error.to_string()))
    }

    /// Takes a memory in.
    ///
    /// # Errors
    /// A memory that [`check`](Self::check) refuses.
    pub(super) fn restore(&mut self, memory: PartMemory, described: &Component) -> Result<(), LayoutMismatch> {
        let name = &described.name;
        let changed = changed(described, &memory).ok_or_else(|| others(described))?;
        if self.changed != changed {
            let tuned = self.running.tune(&settings(described, &changed));
            tuned.map_err(|error| LayoutMismatch(format!("component `{name}`: {error}")))?;
            self.changed = changed;
        }
        let taken = self.running.restore(&memory.state);
        taken.map_err(|error| LayoutMismatch(format!("component `{name}`: {error}")))?;
        for (port, state) in self.ports.iter_mut().zip(memory.ports) {
            port.restore(state).map_err(|error| LayoutMismatch(format!("component `{name}`: {error}")))?;
        }
        (self.given, self.failed) = (memory.given, memory.failed);
        Ok(())
    }

    fn take(&mut self, described: &Component, moment: &Moment<'_>, others: &[Vec<Value>]) -> Result<(), ClientFault> {
        for (index, feed) in &self.feeds {
            let value = match feed {
                Feed::Port(slot) => slot.get(moment.inputs),
                Feed::Output { part, output } => others[*part][*output],
            };
            if let Value::Number(number) = value
                && !number.is_finite()
            {
                let name = match &described.inputs[*index] {
                    Wire::Signal(name) => name.as_str(),
                    Wire::Open | Wire::Constant(_) | Wire::Output { .. } => "a wire",
                };
                let reported = format!("component `{}` gets {number} from {name}, which is not finite", described.name);
                return Err(ClientFault::new(reported));
            }
            self.taken[*index] = value;
        }
        Ok(())
    }

    fn surroundings<'m>(&self, moment: &Moment<'m>) -> Surroundings<'m> {
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
        Surroundings { t_v_ns: moment.t_v_ns, dt_s: moment.dt_s, measured: moment.measured, failed }
    }
}

/// The settings of a component with some parameters changed.
fn settings(described: &Component, changed: &BTreeMap<usize, Setting>) -> Vec<Setting> {
    let own = described.settings.iter().enumerate();
    own.map(|(place, setting)| *changed.get(&place).unwrap_or(setting)).collect()
}

/// The changed parameters of a memory; nothing if they are not those of such a component.
fn changed(described: &Component, memory: &PartMemory) -> Option<BTreeMap<usize, Setting>> {
    let parameters = &described.kind.parameters;
    let setting = |(place, text): &(u32, String)| {
        let place = usize::try_from(*place).ok()?;
        Some((place, parameters.get(place)?.form.read_text(text)?))
    };
    memory.changed.iter().map(setting).collect()
}

/// Why a memory with these changed parameters is not one of such a component.
fn others(described: &Component) -> LayoutMismatch {
    LayoutMismatch(format!("component `{}`: its changed parameters are others", described.name))
}

/// The ports of a component: the first of its inputs and outputs that are lines are the first port, and so on.
fn ports(
    described: &Component,
    running: &dyn Running,
    seed: u64,
    [reads, writes]: [&PortLayout; 2],
) -> Vec<(Port, LinePlaces)> {
    let is_line = |signal: &&Signal| signal.values == Values::Bytes;
    let place = |layout: &PortLayout, name: &SignalName| {
        let found = layout.iter().find(|(port, _)| port.name == *name);
        found.map(|(port, offset)| (offset..offset + port.ty.size(), port.ty))
    };
    let inputs = described.kind.inputs.iter().zip(&described.inputs).filter(|(signal, _)| is_line(signal));
    let mut read = inputs.map(|(_, wire)| match wire {
        Wire::Signal(name) => place(reads, name),
        Wire::Open | Wire::Constant(_) | Wire::Output { .. } => None,
    });
    let outputs = described.kind.outputs.iter().zip(&described.outputs).filter(|(signal, _)| is_line(signal));
    let mut written = outputs.map(|(_, name)| name.as_ref().and_then(|name| place(writes, name)));
    let window = described.window.unwrap_or(DEFAULT_WINDOW);
    let window_of = |found: &Option<(Range<usize>, SignalType)>| match found {
        Some((_, SignalType::Bytes(bytes))) => *bytes,
        _ => window,
    };
    let forms = running.ports().into_iter().enumerate();
    forms
        .map(|(index, form)| {
            let (reads, writes) = (read.next().flatten(), written.next().flatten());
            let seed = seed_for(seed, "line", &index.to_string());
            let port = Port::new(form, [window_of(&reads), window_of(&writes)], seed);
            let [reads, writes] = [reads, writes].map(|found| found.map(|(place, _)| place));
            (port, LinePlaces { reads, writes })
        })
        .collect()
}

/// The scene's own switches of failures, by the index of the mode.
fn switches(described: &Component, reads: &PortLayout) -> Result<Vec<(usize, Switch)>, SlotError> {
    let switch = |failure: &FailureSwitch| {
        let switch = match &failure.when {
            When::Signal(name) => Switch::Signal(reads.slot(name.as_str())?),
            When::Between(between) => Switch::Between(*between),
        };
        Ok((failure.mode, switch))
    };
    described.failures.iter().map(switch).collect()
}
