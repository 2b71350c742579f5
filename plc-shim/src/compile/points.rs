//! Points of the program whose execution is noted, if that is asked for: a byte each, in a memory of
//! their own. The PLC's memory is the same with and without them, so that one build takes the other's state.

use std::collections::{BTreeMap, BTreeSet};

use wasm_encoder::{Instruction, MemArg};

use super::emitter::Emitter;
use crate::syntax::{FileId, Span};

/// What a point is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum PointKind {
    /// A unit was called.
    Unit,
    /// A statement was executed.
    Statement,
    /// A decision had this outcome: a branch or arm by its position, ELSE behind them whether
    /// written or not; of a loop, 0 for a turn and 1 for its end.
    Outcome(u32),
}

/// A point, the name of its unit, and the place that it is shown at.
#[derive(Debug, Clone)]
pub(crate) struct Point {
    pub(crate) kind: PointKind,
    pub(crate) unit: String,
    pub(crate) span: Span,
}

/// Index of the memory that notes lie in; 0 is the PLC's own.
pub(super) const NOTES_MEMORY: u32 = 1;

/// All points in the order of their bytes.
#[derive(Debug, Default)]
pub(super) struct Points {
    /// Statements are told to the host as they run; nothing is noted in memory.
    traced: bool,
    /// Files that are not the user's.
    library: BTreeSet<FileId>,
    /// A unit may be compiled in several places.
    known: BTreeMap<(FileId, u32, u32, PointKind), u32>,
    list: Vec<Point>,
}

impl Points {
    pub(super) fn new(library: &BTreeSet<FileId>) -> Self {
        Self { library: library.clone(), ..Self::default() }
    }

    pub(super) fn traced(library: &BTreeSet<FileId>) -> Self {
        Self { traced: true, library: library.clone(), ..Self::default() }
    }

    pub(super) fn is_traced(&self) -> bool {
        self.traced
    }

    /// The point's number; nothing if it is not the user's.
    pub(super) fn index(&mut self, kind: PointKind, unit: &str, span: Span) -> Option<u32> {
        if self.library.contains(&span.file) {
            return None;
        }
        let next = self.list.len() as u32;
        let index = *self.known.entry((span.file, span.start, span.end, kind)).or_insert(next);
        if index == next {
            self.list.push(Point { kind, unit: unit.to_owned(), span });
        }
        Some(index)
    }

    pub(super) fn into_list(self) -> Vec<Point> {
        self.list
    }

    /// Bytes of [`NOTES_MEMORY`] for them.
    pub(super) fn bytes(&self) -> usize {
        if self.traced { 0 } else { self.list.len() }
    }
}

impl Emitter<'_, '_> {
    /// True if points are noted: then every one of them has code of its own.
    pub(super) fn is_covered(&self) -> bool {
        self.shared.points.is_some()
    }

    /// Notes that execution comes here.
    pub(super) fn cover(&mut self, kind: PointKind, span: Span) {
        let pou = self.frames.last().and_then(|frame| self.shared.pous.get(&frame.pou));
        let (Some(points), Some(pou)) = (&mut self.shared.points, pou) else { return };
        // Initial values are given by declarations, which are no statements.
        if kind == PointKind::Statement && pou.variables.iter().any(|variable| variable.span == span) {
            return;
        }
        if points.traced {
            self.trace(kind, span);
            return;
        }
        let Some(index) = points.index(kind, &pou.name, span) else { return };
        let note = MemArg { offset: u64::from(index), align: 0, memory_index: NOTES_MEMORY };
        self.free_of_charge(|emitter| {
            emitter.emit(Instruction::I32Const(0));
            emitter.emit(Instruction::I32Const(1));
            emitter.emit(Instruction::I32Store8(note));
        });
    }

    /// Emits what the plain program does not have. A budget that paid for it would end a loop sooner than there.
    pub(super) fn free_of_charge(&mut self, emit: impl FnOnce(&mut Self)) {
        let cost = self.cost;
        emit(self);
        self.cost = cost;
    }

    fn trace(&mut self, kind: PointKind, span: Span) {
        let pou = self.frames.last().and_then(|frame| self.shared.pous.get(&frame.pou));
        let (Some(points), Some(pou)) = (&mut self.shared.points, pou) else { return };
        let mut point = |kind| points.index(kind, &pou.name, span);
        match kind {
            PointKind::Unit => {}
            PointKind::Statement => {
                if let Some(statement) = point(kind) {
                    self.trace_begin(statement);
                }
            }
            PointKind::Outcome(_) => {
                if let Some((statement, outcome)) = point(PointKind::Statement).zip(point(kind)) {
                    self.trace_choice(statement, outcome);
                }
            }
        }
    }
}
