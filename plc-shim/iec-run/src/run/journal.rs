//! All that the statements of a scan did, in its order: what they read, what they changed, which way they went.
//!
//! Statements say that they begin, end, read and choose; what they change the journal finds by comparing memory, so
//! that what a library block or a function of the host wrote is there, too, by the statement that called it.

use std::ops::Range;

use super::fault::{self, WriteSite};
use super::frames::{Frames, Writer};
use super::way::{WayId, rows};
use crate::application::Application;
use crate::compile::points::PointKind;

/// A statement of an application.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct StatementId(u32);

/// One thing that was done in a scan.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Act {
    /// A unit that a task runs begins: no statement is around what follows.
    Unit,
    Begin(StatementId),
    /// A statement ends. One that is left early has no end.
    End(StatementId),
    /// Bytes of memory are read.
    Read(Range<u32>),
    /// A statement goes a way.
    Choice(StatementId, WayId),
    Wrote(Wrote),
}

/// Memory that has changed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Wrote {
    /// The statement that did it; nothing if it was written from outside, or by what is not a statement, as by the
    /// steps of a chart.
    pub statement: Option<StatementId>,
    frames: Frames,
    /// Where, and what is there now.
    pub changes: Vec<(u32, Vec<u8>)>,
}

/// A statement, as it stands in the sources.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Statement {
    /// Its number in the application.
    pub id: StatementId,
    pub unit: String,
    pub file: String,
    /// Its line, from 1.
    pub line: u32,
    /// Its column in characters, from 1.
    pub column: u32,
    /// Its text on one line; of one with statements in it, its conditions alone.
    pub text: String,
    /// The same line by line, each with its number.
    pub rows: Vec<(u32, String)>,
}

/// What a scan did.
#[derive(Debug, Default)]
pub(in crate::run) struct Journal {
    acts: Vec<Act>,
    last: Vec<u8>,
    /// Bytes of memory that are in use; what the module has behind them, up to the end of its page, is nobody's.
    used: usize,
}

/// Most acts that are kept of a scan: a program may run in a loop for as long as its budget lasts.
pub const ACTS_MAX: usize = 1_000_000;

/// Bytes that are compared at once.
const BLOCK: usize = 1024;

impl Journal {
    /// A scan begins with this memory in use; what changed since the last one was written from outside.
    pub(super) fn begin(&mut self, memory: &[u8]) {
        self.acts.clear();
        self.used = memory.len();
        self.wrote(None, memory, Vec::new);
    }

    pub(super) fn unit_begins(&mut self) {
        self.add(Act::Unit);
    }

    pub(super) fn statement_begins(&mut self, point: u32) {
        self.add(Act::Begin(StatementId(point)));
    }

    pub(super) fn statement_ends(&mut self, point: u32) {
        self.add(Act::End(StatementId(point)));
    }

    pub(super) fn chose(&mut self, statement: u32, way: u32) {
        self.add(Act::Choice(StatementId(statement), WayId(way)));
    }

    pub(super) fn read(&mut self, address: u32, size: u32) {
        self.add(Act::Read(address..address.saturating_add(size)));
    }

    fn add(&mut self, act: Act) {
        if self.acts.len() < ACTS_MAX {
            self.acts.push(act);
        }
    }

    /// Notes what has changed in `memory` since it was last looked at, as written by `statement`.
    pub(super) fn wrote(&mut self, statement: Option<u32>, memory: &[u8], frames: impl FnOnce() -> Frames) {
        // Looked at twice a statement: a page has 64 KiB, and a program a few of them.
        let memory = memory.get(..self.used).unwrap_or(memory);
        let changes = changes(&self.last, memory);
        if changes.is_empty() {
            return;
        }
        if self.last.len() < memory.len() {
            self.last.resize(memory.len(), 0);
        }
        debug_assert!(self.last.len() >= memory.len(), "memory never shrinks below what was seen");
        for (at, bytes) in &changes {
            self.last[*at as usize..][..bytes.len()].copy_from_slice(bytes);
        }
        // A backtrace costs far more than the comparison; where no statement wrote, there is none to tell of.
        let frames = if statement.is_some() { frames() } else { Vec::new() };
        self.add(Act::Wrote(Wrote { statement: statement.map(StatementId), frames, changes }));
    }

    pub(super) fn acts(&self) -> &[Act] {
        &self.acts
    }
}

/// Where `now` is not `last`, and what is there; memory that `last` did not have was zero.
fn changes(last: &[u8], now: &[u8]) -> Vec<(u32, Vec<u8>)> {
    let mut found: Vec<(u32, Vec<u8>)> = Vec::new();
    for (index, block) in now.chunks(BLOCK).enumerate() {
        let start = index * BLOCK;
        let before = last.get(start..(start + block.len()).min(last.len())).unwrap_or_default();
        if before == block {
            continue;
        }
        for (offset, byte) in block.iter().enumerate() {
            if before.get(offset).unwrap_or(&0) == byte {
                continue;
            }
            let at = start + offset;
            match found.last_mut() {
                Some((from, bytes)) if *from as usize + bytes.len() == at => bytes.push(*byte),
                _ => found.push((at as u32, vec![*byte])),
            }
        }
    }
    found
}

impl Application {
    /// All its statements that are not a library's; none unless it was compiled for
    /// [`SoftPlc::journal`](crate::SoftPlc::journal).
    pub fn statements(&self) -> Vec<Statement> {
        let statements = self.points().iter().zip(0..).filter(|(point, _)| point.kind == PointKind::Statement);
        let statement = |(point, id): (&crate::compile::points::Point, u32)| {
            let (file, place) = self.sources().locate(point.span);
            let (file, unit) = (file.to_owned(), point.unit.clone());
            let rows = rows(self.sources().text(point.span), place.line);
            let text = self.conditions(point.span).unwrap_or_else(|| self.shown(point.span));
            Statement { id: StatementId(id), unit, file, line: place.line, column: place.column, text, rows }
        };
        statements.map(statement).collect()
    }

    /// Where memory was changed, with the units that were active; nothing if no statement did it.
    pub fn site(&self, wrote: &Wrote) -> Option<WriteSite> {
        let StatementId(id) = wrote.statement?;
        let point = self.points().get(id as usize)?;
        let writer = Writer { point: id, frames: wrote.frames.clone(), within: Vec::new() };
        Some(fault::write_site(self, point.span, &writer))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rest of the last page is not looked at.
    #[test]
    fn memory_that_nobody_uses_is_left_aside() {
        let mut journal = Journal::default();
        let mut page = vec![0; 8];
        journal.begin(&page[..4]);
        (page[3], page[6]) = (1, 1);
        journal.wrote(None, &page, Vec::new);
        let changes = vec![(3, vec![1])];
        assert_eq!(journal.acts(), [Act::Wrote(Wrote { statement: None, frames: Vec::new(), changes })]);
    }

    #[test]
    fn changes_are_found_across_blocks() {
        let mut last = vec![0; 3 * BLOCK];
        let mut now = last.clone();
        (now[BLOCK - 1], now[BLOCK], now[2 * BLOCK + 5]) = (1, 2, 3);
        assert_eq!(changes(&last, &now), [(BLOCK as u32 - 1, vec![1, 2]), (2 * BLOCK as u32 + 5, vec![3])]);
        assert_eq!(changes(&[], &[0, 7]), [(1, vec![7])]);
        last.clone_from(&now);
        assert_eq!(changes(&last, &now), []);
    }
}
