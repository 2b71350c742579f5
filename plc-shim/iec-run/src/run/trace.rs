//! Who wrote what is watched: the last statement, and the calls and decisions that led to it. And all that a scan
//! did, if its journal is kept.

use std::ops::Range;

use super::frames::{Frames, Writer};
use super::journal::Journal;

/// Bytes of memory that are watched.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Watched {
    range: Range<usize>,
    /// The bit that counts; all if absent.
    bit: Option<u8>,
    last: Vec<u8>,
    pub(super) writer: Option<Writer>,
}

/// What the statements of a scan are held against.
#[derive(Debug, Default)]
pub(in crate::run) struct Trace {
    pub(super) watched: Vec<Watched>,
    /// The statements that have begun and not ended, except those that were left early, each with
    /// the way that it went last.
    pub(super) active: Vec<(u32, Option<u32>)>,
    /// The ways of all decisions of the scan, in their order.
    pub(super) ways: Vec<u32>,
    /// What the scan does, if that is asked for.
    pub(super) journal: Option<Journal>,
}

impl Watched {
    pub(super) fn new(range: Range<usize>, bit: Option<u8>) -> Self {
        Self { last: vec![0; range.len()], range, bit, writer: None }
    }

    /// Takes the bytes as they are now; true if they have changed.
    fn look(&mut self, memory: &[u8]) -> bool {
        let Some(now) = memory.get(self.range.clone()) else { return false };
        let changed = match self.bit {
            Some(bit) => now.iter().zip(&self.last).any(|(now, last)| (now ^ last) >> bit & 1 == 1),
            None => now != self.last,
        };
        debug_assert_eq!(self.last.len(), now.len(), "what is watched keeps its size");
        self.last.copy_from_slice(now);
        changed
    }

    /// True if a store there is one to the watched bytes; of a single bit only a change tells.
    fn is_within(&self, stored: &Range<usize>) -> bool {
        self.bit.is_none() && stored.start < self.range.end && self.range.start < stored.end
    }
}

impl Trace {
    pub(super) fn new(watched: Vec<Watched>) -> Self {
        Self { watched, ..Self::default() }
    }

    /// A scan begins: what is watched has been written from outside, if at all.
    pub(super) fn begin_scan(&mut self, memory: &[u8]) {
        self.active.clear();
        self.ways.clear();
        for watched in &mut self.watched {
            watched.look(memory);
            watched.writer = None;
        }
        if let Some(journal) = &mut self.journal {
            journal.begin(memory);
        }
    }

    /// A scan is over: what changed last, no statement may have written.
    pub(super) fn end_scan(&mut self, memory: &[u8]) {
        if let Some(journal) = &mut self.journal {
            journal.wrote(None, memory, Vec::new);
        }
    }

    /// A unit that a task runs begins: nothing is around its statements.
    pub(in crate::run) fn begin_unit(&mut self) {
        self.active.clear();
        if let Some(journal) = &mut self.journal {
            journal.unit_begins();
        }
    }

    /// The statement `statement` goes a way. What began in it and was left early is over.
    pub(super) fn choose(&mut self, statement: u32, way: u32) {
        self.ways.push(way);
        if let Some(at) = self.active.iter().rposition(|(active, _)| *active == statement) {
            self.active.truncate(at + 1);
            self.active[at].1 = Some(way);
        }
    }

    /// The statement `point` has just done something; `stored` is what it says that it has written.
    pub(super) fn look(
        &mut self,
        point: Option<u32>,
        stored: &Range<usize>,
        memory: &[u8],
        frames: impl Fn() -> Frames,
    ) {
        if let Some(journal) = &mut self.journal {
            journal.wrote(point, memory, &frames);
        }
        for watched in &mut self.watched {
            let changed = watched.look(memory);
            if let Some(point) = point.filter(|_| changed || watched.is_within(stored)) {
                let within = self.active.iter().rev().filter_map(|(_, way)| *way).collect();
                watched.writer = Some(Writer { point, frames: frames(), within });
            }
        }
    }
}
