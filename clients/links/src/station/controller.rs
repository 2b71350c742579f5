//! The PLC between its cycles: its points, RUN and STOP, starts.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use onescan_iec::VirtualTime;
use onescan_iec_run::SoftPlc;
use serde::Serialize;

use super::wires::{Source, Wire, Wires};
use crate::gateway::answer::Answer;
use crate::gateway::exchange::Direction;
use onescan_soft_plc::bind::Place;

/// How a PLC is.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Status {
    pub running: bool,
    /// Cold starts since it is there, on demand or by its operator.
    pub boots: u32,
    /// Cycles since the last start.
    pub cycles: u64,
    /// The session that it takes part in, if any, and how many of its grants are done.
    pub session: Option<(u32, u32)>,
    /// The fault that put it into STOP.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fault: Option<String>,
}

struct State {
    plc: SoftPlc,
    /// The PLC's own clock, ns.
    own_ns: u64,
    is_running: bool,
    boots: u32,
    cycles: u64,
    fault: Option<String>,
    /// Goes up when something may have changed that a client would see.
    version: u64,
    /// The client that may write, of those that may be replaced.
    holder: u64,
    is_over: bool,
}

/// A soft PLC that its servers share with its clock.
pub struct Controller {
    state: Mutex<State>,
    changed: Condvar,
    /// Servers that wait at a PLC listener: the clock lets them in between two cycles.
    waiting: AtomicUsize,
    wires: Wires,
    /// What is written into memory at every start.
    presets: Vec<(usize, Vec<u8>)>,
    /// It starts cold by itself as soon as its program says that it must be started.
    starts_itself: bool,
}

impl Controller {
    /// A PLC in RUN, just started.
    pub fn new(plc: SoftPlc, wires: Wires) -> Self {
        let state = State {
            plc,
            own_ns: 0,
            is_running: true,
            boots: 0,
            cycles: 0,
            fault: None,
            version: 1,
            holder: 0,
            is_over: false,
        };
        let (changed, waiting) = (Condvar::new(), AtomicUsize::new(0));
        Self { state: Mutex::new(state), changed, waiting, wires, presets: Vec::new(), starts_itself: false }
    }

    /// The same with `bytes` at `offset` of the PLC's memory after every start, as its program was downloaded.
    pub fn with_preset(mut self, offset: usize, bytes: Vec<u8>) -> Self {
        preset(&mut self.lock(), offset, &bytes);
        self.presets.push((offset, bytes));
        self
    }

    /// The same, started cold as soon as its program says that it must be, as if its operator stood beside it.
    pub fn starting_itself(self) -> Self {
        Self { starts_itself: true, ..self }
    }

    /// Its points.
    pub fn wires(&self) -> &Wires {
        &self.wires
    }

    /// A thread that panicked here left whole values.
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn enter(&self) -> MutexGuard<'_, State> {
        // A lock alone would let the clock back in first, time and again: it looks at this number and stands back.
        self.waiting.fetch_add(1, Ordering::SeqCst);
        let state = self.lock();
        self.waiting.fetch_sub(1, Ordering::SeqCst);
        state
    }

    /// True while somebody waits to read or write.
    pub(super) fn is_wanted(&self) -> bool {
        self.waiting.load(Ordering::SeqCst) > 0
    }

    /// One cycle, which takes `span_ns` by the PLC's own clock; nothing in STOP. False when all is over.
    pub(super) fn cycle(&self, span_ns: u64) -> bool {
        let mut state = self.lock();
        if state.is_running {
            state.own_ns = state.own_ns.saturating_add(span_ns);
            state.cycles += 1;
            let now = VirtualTime::from_nanos(state.own_ns);
            if let Err(fault) = state.plc.scan(now) {
                let text = format!("PLC fault: {} in {}{}", fault.kind, fault.at, fault.way());
                tracing::warn!("{text}; the PLC is in STOP");
                (state.fault, state.is_running) = (Some(text), false);
            }
            if self.starts_itself && self.must_be_started(&state) {
                tracing::info!("another session asks for this PLC, which has run: it is started cold");
                self.start(&mut state, SoftPlc::cold_start);
            }
            state.version += 1;
            self.changed.notify_all();
        }
        !state.is_over
    }

    fn must_be_started(&self, state: &State) -> bool {
        let Some(wire) = &self.wires.answer else { return false };
        let mut word = [0; 2];
        get(state, wire, &mut word);
        Answer::from(i16::from_le_bytes(word)) == Answer::MustBeStarted
    }

    /// Writes all points, as one request.
    pub fn write(&self, to_plc: &[u8]) {
        self.write_as(&mut self.enter(), to_plc);
    }

    /// The same for the client `holder`; false if another has taken its place.
    pub(super) fn write_held(&self, holder: u64, to_plc: &[u8]) -> bool {
        let mut state = self.enter();
        if state.holder != holder {
            return false;
        }
        self.write_as(&mut state, to_plc);
        true
    }

    fn write_as(&self, state: &mut State, to_plc: &[u8]) {
        for wire in &self.wires.to_plc {
            if let Some(value) = to_plc.get(wire.point.range()) {
                self.put(state, wire, value);
            }
        }
        self.note(state);
    }

    /// Writes single points, by their index among those to the PLC, as one request.
    pub fn write_points<'v>(&self, values: impl Iterator<Item = (usize, &'v [u8])>) {
        let mut state = self.enter();
        for (index, value) in values {
            if let Some(wire) = self.wires.to_plc.get(index).filter(|wire| wire.point.ty.size() == value.len()) {
                self.put(&mut state, wire, value);
            }
        }
        self.note(&mut state);
    }

    fn put(&self, state: &mut State, wire: &Wire, value: &[u8]) {
        match &wire.source {
            Source::Memory(places) => put(state, places, value),
            Source::Start if value == state.boots.wrapping_add(1).to_le_bytes() => {
                self.start(state, SoftPlc::cold_start);
            }
            Source::Start | Source::Boots | Source::Running => {}
        }
    }

    fn start(&self, state: &mut State, how: fn(&mut SoftPlc)) {
        how(&mut state.plc);
        for (offset, bytes) in &self.presets {
            preset(state, *offset, bytes);
        }
        (state.own_ns, state.cycles, state.fault, state.is_running) = (0, 0, None, true);
        state.boots = state.boots.wrapping_add(1);
        state.version += 1;
    }

    /// In STOP no cycle would show that something was written.
    fn note(&self, state: &mut State) {
        if !state.is_running {
            state.version += 1;
            self.changed.notify_all();
        }
    }

    /// Reads all points of a direction, between two cycles.
    pub fn read(&self, direction: Direction, packed: &mut [u8]) {
        self.read_in(&self.enter(), direction, packed);
    }

    /// All points of both directions, between the same two cycles.
    pub(super) fn snapshot(&self) -> Snapshot {
        let packed = |direction| vec![0; self.wires.exchange().size(direction)];
        let (mut to_plc, mut from_plc) = (packed(Direction::ToPlc), packed(Direction::FromPlc));
        let state = self.enter();
        self.read_in(&state, Direction::ToPlc, &mut to_plc);
        self.read_in(&state, Direction::FromPlc, &mut from_plc);
        Snapshot { to_plc, from_plc }
    }

    fn read_in(&self, state: &State, direction: Direction, packed: &mut [u8]) {
        for wire in self.wires.of(direction) {
            if let Some(value) = packed.get_mut(wire.point.range()) {
                get(state, wire, value);
            }
        }
    }

    /// Reads one point, by its index among those of a direction.
    pub fn read_point(&self, direction: Direction, index: usize, value: &mut [u8]) {
        let state = self.enter();
        if let Some(wire) = self.wires.of(direction).get(index).filter(|wire| wire.point.ty.size() == value.len()) {
            get(&state, wire, value);
        }
    }

    /// The version after `seen`, waited for as long as `patience`; nothing when all is over.
    pub(super) fn wait(&self, seen: u64, patience: Duration) -> Option<u64> {
        let state = self.enter();
        let is_same = |state: &mut State| state.version == seen && !state.is_over;
        let waited = self.changed.wait_timeout_while(state, patience, is_same);
        let (state, _) = waited.unwrap_or_else(PoisonError::into_inner);
        (!state.is_over).then_some(state.version)
    }

    /// Makes somebody new the client that may write, and gives its number.
    pub(super) fn take_hold(&self) -> u64 {
        let mut state = self.enter();
        state.holder += 1;
        state.holder
    }

    /// Goes on, or into STOP. A PLC with a fault stays in STOP until it is started.
    pub fn set_running(&self, is_running: bool) {
        let mut state = self.enter();
        state.is_running = is_running && state.fault.is_none();
        state.version += 1;
        self.changed.notify_all();
    }

    /// A cold start: all variables have their initial values.
    pub fn start_cold(&self) {
        let mut state = self.enter();
        self.start(&mut state, SoftPlc::cold_start);
        self.changed.notify_all();
    }

    /// A warm start: what is RETAIN stays.
    pub fn start_warm(&self) {
        let mut state = self.enter();
        self.start(&mut state, SoftPlc::warm_start);
        self.changed.notify_all();
    }

    /// How it is.
    pub fn status(&self) -> Status {
        let exchange = self.wires.exchange();
        let mut packed = vec![0; exchange.size(Direction::FromPlc)];
        self.read(Direction::FromPlc, &mut packed);
        let report = exchange.report(&packed);
        let state = self.enter();
        Status {
            running: state.is_running,
            boots: state.boots,
            cycles: state.cycles,
            session: (report.joined != 0).then(|| (report.joined, report.done.saturating_sub(report.joined))),
            fault: state.fault.clone(),
        }
    }

    /// Ends clock and servers.
    pub fn end(&self) {
        self.enter().is_over = true;
        self.changed.notify_all();
    }

    /// True once it has been ended.
    pub fn is_over(&self) -> bool {
        self.enter().is_over
    }
}

/// The packed values of all points.
pub(super) struct Snapshot {
    to_plc: Vec<u8>,
    from_plc: Vec<u8>,
}

impl Snapshot {
    /// Those of a direction.
    pub(super) fn of(&self, direction: Direction) -> &[u8] {
        match direction {
            Direction::ToPlc => &self.to_plc,
            Direction::FromPlc => &self.from_plc,
        }
    }
}

fn preset(state: &mut State, offset: usize, bytes: &[u8]) {
    if let Some(target) = state.plc.memory_mut().get_mut(offset..offset + bytes.len()) {
        target.copy_from_slice(bytes);
    }
}

fn put(state: &mut State, places: &[Place], value: &[u8]) {
    let memory = state.plc.memory_mut();
    for place in places {
        place.give(value, memory);
    }
}

fn get(state: &State, wire: &Wire, value: &mut [u8]) {
    match &wire.source {
        Source::Memory(places) => {
            if let Some(place) = places.first() {
                place.take(state.plc.memory(), value);
            }
        }
        Source::Boots => value.copy_from_slice(&state.boots.to_le_bytes()),
        Source::Running => value.fill(u8::from(state.is_running)),
        Source::Start => value.copy_from_slice(&0_u32.to_le_bytes()),
    }
}
