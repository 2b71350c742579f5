//! What a traced PLC did: the statements that wrote its outputs, and the ways its decisions went.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

use onescan_iec_run::{SoftPlc, Way, WayId, WriteSite};
use onescan_server::signal::{ClientName, SignalName};
use onescan_server::time::VirtualTime;

/// Most ways that are kept of one PLC's run; a scan like the one before costs nothing.
const WAYS_MAX: usize = 4_000_000;

/// A statement of a PLC that wrote a signal, and when.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Written {
    /// The virtual time of the scan.
    pub t_v: VirtualTime,
    pub site: WriteSite,
    /// The ways that decisions around it had gone, innermost first.
    pub within: Vec<Way>,
}

/// The ways that a PLC's decisions went, scan by scan.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Ways {
    /// All that its program has.
    pub known: BTreeMap<WayId, Way>,
    /// The ways of a scan in their order, and the scan from which on all went so.
    pub scans: Vec<(VirtualTime, Vec<WayId>)>,
    /// Where keeping them ended because there were too many.
    pub cut_off: Option<VirtualTime>,
    kept: usize,
}

impl Ways {
    fn push(&mut self, t_v: VirtualTime, scan: impl Iterator<Item = WayId>) {
        if self.cut_off.is_some() {
            return;
        }
        let scan: Vec<WayId> = scan.collect();
        if self.scans.last().is_some_and(|(_, last)| *last == scan) {
            return;
        }
        self.kept += scan.len() + 1;
        if self.kept > WAYS_MAX {
            self.cut_off = Some(t_v);
            self.kept -= scan.len() + 1;
        } else {
            self.scans.push((t_v, scan));
        }
    }
}

impl Ways {
    /// Forgets the scans after `t_v`.
    fn rewind(&mut self, t_v: VirtualTime) {
        let known = self.scans.partition_point(|(since, _)| *since <= t_v);
        let forgotten = self.scans.drain(known..).map(|(_, scan)| scan.len() + 1).sum();
        self.kept = self.kept.saturating_sub(forgotten);
        self.cut_off = self.cut_off.filter(|cut_off| *cut_off <= t_v);
    }
}

/// What the traced PLCs of a run did.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Traced {
    /// The last statement that wrote each signal.
    pub writers: BTreeMap<SignalName, Written>,
    /// The ways of each PLC.
    pub ways: BTreeMap<ClientName, Ways>,
}

/// Where it is noted; it outlives the clients.
pub type TraceSink = Arc<Mutex<Traced>>;

/// Notes what one PLC does.
pub(super) struct Tracing {
    client: ClientName,
    /// The outputs that are watched, in the order in which the PLC watches them.
    watched: Vec<SignalName>,
    known: BTreeMap<WayId, Way>,
    sink: TraceSink,
}

impl Tracing {
    /// Lets `plc` watch those of `outputs`, each with its place in memory, that are among `signals`.
    pub(super) fn start(
        client: &ClientName,
        plc: &mut SoftPlc,
        signals: &BTreeSet<SignalName>,
        outputs: impl Iterator<Item = (SignalName, (Range<usize>, Option<u8>))>,
        sink: TraceSink,
    ) -> Self {
        let (watched, places): (Vec<_>, Vec<_>) = outputs.filter(|(name, _)| signals.contains(name)).unzip();
        plc.watch(places);
        let known = plc.application().ways();
        Self { client: client.clone(), watched, known, sink }
    }

    /// The session begins, or restarts after a reset.
    pub(super) fn begin(&self) {
        // Whoever panicked while it held the lock left whole entries; so below.
        let mut sink = self.sink.lock().unwrap_or_else(PoisonError::into_inner);
        sink.writers.retain(|signal, _| !self.watched.contains(signal));
        sink.ways.insert(self.client.clone(), Ways { known: self.known.clone(), ..Ways::default() });
    }

    /// The PLC goes on from a state saved at `t_v`: what it did later is not done yet.
    pub(super) fn rewind(&self, t_v: VirtualTime) {
        let mut sink = self.sink.lock().unwrap_or_else(PoisonError::into_inner);
        sink.writers.retain(|signal, written| written.t_v <= t_v || !self.watched.contains(signal));
        if let Some(ways) = sink.ways.get_mut(&self.client) {
            ways.rewind(t_v);
        }
    }

    /// A scan is over.
    pub(super) fn note(&self, plc: &SoftPlc, t_v: VirtualTime) {
        let mut sink = self.sink.lock().unwrap_or_else(PoisonError::into_inner);
        for (index, signal) in self.watched.iter().enumerate() {
            if let Some(site) = plc.last_writer(index) {
                let within = site.within.iter().filter_map(|way| self.known.get(way).cloned()).collect();
                sink.writers.insert(signal.clone(), Written { t_v, site, within });
            }
        }
        if let Some(ways) = sink.ways.get_mut(&self.client) {
            ways.push(t_v, plc.ways());
        }
    }
}
