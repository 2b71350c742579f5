//! Where signals begin and end inside of a client: at components of a scene, at variables of a PLC.

use std::collections::BTreeMap;

use onescan_iec_run::Application;
use onescan_plant::component::kind::Setting;
use onescan_plant::component::open_inputs;
use onescan_plant::scene::model::{Component, Drive, Scene, When, Wire};
use onescan_scenario::compose::Paths;
use onescan_scenario::ports_file::PortFile;
use onescan_server::signal::{ClientName, SignalDecl, SignalName, SignalType};
use onescan_soft_plc::{BindError, bind_each};

/// A signal at a client: its type there, and what it is there.
#[derive(Clone, Debug)]
pub(super) struct End {
    pub(super) signal: SignalName,
    pub(super) ty: SignalType,
    /// Outputs and inputs of components, variables of the PLC.
    pub(super) places: Vec<String>,
}

/// What a client reads and writes.
#[derive(Clone, Debug, Default)]
pub(super) struct Ends {
    pub(super) reads: Vec<End>,
    pub(super) writes: Vec<End>,
    /// Inputs of components that nobody drives, each with the value that it has.
    pub(super) open: Vec<(String, Setting)>,
    /// Signals that cannot be bound, each with the reason.
    pub(super) unbound: Vec<BindError>,
}

/// The ends of a client, found by their signals.
#[derive(Debug)]
pub(super) struct Found {
    pub(super) ends: Ends,
    reads: Positions,
    writes: Positions,
    unbound: Positions,
}

/// Where something of a signal is in a list.
type Positions = BTreeMap<SignalName, Vec<usize>>;

impl Found {
    pub(super) fn new(ends: Ends) -> Self {
        let reads = positions(ends.reads.iter().map(|end| &end.signal));
        let writes = positions(ends.writes.iter().map(|end| &end.signal));
        let unbound = positions(ends.unbound.iter().map(|error| &error.signal));
        Self { ends, reads, writes, unbound }
    }

    /// Where the client reads a signal.
    pub(super) fn reads(&self, signal: &SignalName) -> impl Iterator<Item = &End> {
        of(&self.reads, signal, &self.ends.reads)
    }

    /// Where it writes a signal.
    pub(super) fn writes(&self, signal: &SignalName) -> impl Iterator<Item = &End> {
        of(&self.writes, signal, &self.ends.writes)
    }

    /// Why a signal cannot be bound.
    pub(super) fn unbound(&self, signal: &SignalName) -> impl Iterator<Item = &BindError> {
        of(&self.unbound, signal, &self.ends.unbound)
    }
}

fn positions<'n>(names: impl Iterator<Item = &'n SignalName>) -> Positions {
    let mut positions = Positions::new();
    for (at, name) in names.enumerate() {
        positions.entry(name.clone()).or_default().push(at);
    }
    positions
}

fn of<'f, T>(positions: &'f Positions, signal: &SignalName, all: &'f [T]) -> impl Iterator<Item = &'f T> {
    positions.get(signal).into_iter().flatten().filter_map(|at| all.get(*at))
}

/// The ends of a plant.
pub(super) fn of_plant(scene: &Scene) -> Ends {
    let mut places: BTreeMap<SignalName, Vec<String>> = BTreeMap::new();
    for (name, place) in places_of(scene) {
        places.entry(name).or_default().push(place);
    }
    let end = |port: &onescan_server::signal::Port| End {
        signal: port.name.clone(),
        ty: port.ty,
        places: places.get(&port.name).cloned().unwrap_or_default(),
    };
    Ends {
        reads: scene.reads.iter().map(end).collect(),
        writes: scene.writes.iter().map(end).collect(),
        open: open_of(scene),
        unbound: Vec::new(),
    }
}

/// The inputs of components that nobody drives, with their presets.
fn open_of(scene: &Scene) -> Vec<(String, Setting)> {
    let open = |component: &Component| {
        open_inputs(component)
            .into_iter()
            .map(|(key, preset)| (format!("{}.{key}", component.name), preset))
            .collect::<Vec<_>>()
    };
    scene.components.iter().flat_map(open).collect()
}

/// Every place of a scene that a signal has, in the scene's order.
fn places_of(scene: &Scene) -> Vec<(SignalName, String)> {
    let mut places = Vec::new();
    for fitting in &scene.fittings {
        let release = fitting.brake.as_ref().and_then(|brake| brake.release.clone());
        places.extend(release.map(|signal| (signal, format!("{}.release", scene.joints[fitting.joint].name))));
    }
    for axis in &scene.axes {
        let mut at = |signal: &SignalName, what: &str| places.push((signal.clone(), format!("{}.{what}", axis.name)));
        match &axis.drive {
            Drive::Bidirectional { forward, reverse } => {
                at(forward, "forward");
                at(reverse, "reverse");
            }
            Drive::Velocity { command } | Drive::Position { command } => at(command, "command"),
        }
        axis.position.iter().for_each(|signal| at(signal, "position"));
        axis.velocity.iter().for_each(|signal| at(signal, "velocity"));
        axis.effort.iter().for_each(|signal| at(signal, "effort"));
        axis.limit.iter().for_each(|signal| at(signal, "limit"));
    }
    places.extend(scene.sensors.iter().map(|sensor| (sensor.signal.clone(), sensor.name.clone())));
    for component in &scene.components {
        let kind = &component.kind;
        for (input, wire) in kind.inputs.iter().zip(&component.inputs) {
            if let Wire::Signal(signal) = wire {
                places.push((signal.clone(), format!("{}.{}", component.name, input.key)));
            }
        }
        for (output, signal) in kind.outputs.iter().zip(&component.outputs) {
            places.extend(signal.iter().map(|signal| (signal.clone(), format!("{}.{}", component.name, output.key))));
        }
        for failure in &component.failures {
            if let (When::Signal(signal), Some(mode)) = (&failure.when, kind.failures.get(failure.mode)) {
                places.push((signal.clone(), format!("{} fails: {}", component.name, mode.mode)));
            }
        }
    }
    places
}

/// The lines of a soft PLC's ports, which are bound to no variable.
pub(super) fn of_ports(ports: &BTreeMap<String, PortFile>, declared: &[SignalDecl], ends: &mut Ends) {
    for (name, port) in ports {
        let end = |signal: &SignalName| {
            let found = declared.iter().find(|declared| declared.name == *signal)?;
            Some(End { signal: found.name.clone(), ty: found.ty, places: vec![format!("port {name}")] })
        };
        ends.reads.extend(end(&port.receive));
        ends.writes.extend(end(&port.transmit));
    }
}

/// The ends of a soft PLC, each signal by itself, so that one that is wrong hides no other.
pub(super) fn of_plc(application: &Application, plc: &ClientName, declared: &[SignalDecl], paths: &Paths) -> Ends {
    let (bound, unbound) = bind_each(application, plc, declared, paths);
    let end =
        |bound: onescan_soft_plc::Bound| End { signal: bound.port.name, ty: bound.port.ty, places: bound.variables };
    Ends {
        reads: bound.inputs.into_iter().map(end).collect(),
        writes: bound.outputs.into_iter().map(end).collect(),
        open: Vec::new(),
        unbound,
    }
}
