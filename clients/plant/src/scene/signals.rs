//! The signals of a scene: each written once, each read as one type.

use super::placed::Placed;
use onescan_server::signal::{Port, SignalName, SignalType};

use super::error::{SceneFaultKind, Thing};
use super::faults::Faults;
use super::names::Names;

/// The signals found so far, in the scene's order.
pub(super) struct Signals {
    reads: Vec<(Port, std::ops::Range<usize>)>,
    writes: Vec<Port>,
    written: Names,
}

impl Signals {
    pub(super) fn new() -> Self {
        Self { reads: Vec::new(), writes: Vec::new(), written: Names::none(Thing::Signal) }
    }

    /// Type and name of a signal that the plant reads or writes so far.
    pub(super) fn find(&self, name: &str) -> Option<&Port> {
        self.reads.iter().map(|(port, _)| port).chain(&self.writes).find(|port| port.name.as_str() == name)
    }

    /// Gives a signal another type in the session than the plant has for it.
    pub(super) fn retype(&mut self, name: &SignalName, ty: SignalType) {
        let ports = self.reads.iter_mut().map(|(port, _)| port).chain(&mut self.writes);
        for port in ports.filter(|port| port.name == *name) {
            port.ty = ty;
        }
    }

    /// The names of all signals so far.
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.reads.iter().map(|(port, _)| port).chain(&self.writes).map(|port| port.name.as_str())
    }

    /// A signal that the plant reads; several axes may read the same one.
    pub(super) fn read(
        &mut self,
        name: &Placed<String>,
        ty: SignalType,
        faults: &mut Faults<'_>,
    ) -> Option<SignalName> {
        let signal = signal_name(name, faults)?;
        match self.reads.iter().find(|(port, _)| port.name == signal) {
            None => self.reads.push((Port { name: signal.clone(), ty }, name.span())),
            Some((port, _)) if port.ty == ty => {}
            Some(_) => faults.add(name.span(), SceneFaultKind::SignalType(signal.as_str().to_owned())),
        }
        Some(signal)
    }

    /// A signal that the plant writes.
    pub(super) fn write(
        &mut self,
        name: &Placed<String>,
        ty: SignalType,
        faults: &mut Faults<'_>,
    ) -> Option<SignalName> {
        let signal = signal_name(name, faults)?;
        self.written.claim(name, faults);
        self.writes.push(Port { name: signal.clone(), ty });
        Some(signal)
    }

    /// What the plant reads and writes.
    pub(super) fn into_ports(self, faults: &mut Faults<'_>) -> (Vec<Port>, Vec<Port>) {
        for (port, span) in &self.reads {
            if self.written.contains(port.name.as_str()) {
                faults.add(span.clone(), SceneFaultKind::OwnSignal(port.name.as_str().to_owned()));
            }
        }
        (self.reads.into_iter().map(|(port, _)| port).collect(), self.writes)
    }
}

fn signal_name(name: &Placed<String>, faults: &mut Faults<'_>) -> Option<SignalName> {
    SignalName::new(name.get_ref().as_str()).map_err(|bad| faults.add(name.span(), bad.into())).ok()
}
