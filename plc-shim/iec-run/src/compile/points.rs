//! Points of the program whose execution is noted, if that is asked for: a byte each, in a memory of
//! their own. The PLC's memory is the same with and without them, so that one build takes the other's state.

use std::collections::{BTreeMap, BTreeSet};

use onescan_iec::syntax::{FileId, Span};

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
pub(crate) const NOTES_MEMORY: u32 = 1;

/// All points in the order of their bytes.
#[derive(Debug, Default)]
pub(crate) struct Points {
    /// Statements are told to the host as they run; nothing is noted in memory.
    traced: bool,
    /// Files that are not the user's.
    library: BTreeSet<FileId>,
    /// A unit may be compiled in several places.
    known: BTreeMap<(FileId, u32, u32, PointKind), u32>,
    list: Vec<Point>,
}

impl Points {
    pub(crate) fn new(library: &BTreeSet<FileId>) -> Self {
        Self { library: library.clone(), ..Self::default() }
    }

    pub(crate) fn traced(library: &BTreeSet<FileId>) -> Self {
        Self { traced: true, library: library.clone(), ..Self::default() }
    }

    pub(crate) fn is_traced(&self) -> bool {
        self.traced
    }

    /// True for the user's text.
    pub(crate) fn is_own(&self, span: Span) -> bool {
        !self.library.contains(&span.file)
    }

    /// The point's number; nothing if it is not the user's.
    pub(crate) fn index(&mut self, kind: PointKind, unit: &str, span: Span) -> Option<u32> {
        if !self.is_own(span) {
            return None;
        }
        let next = self.list.len() as u32;
        let index = *self.known.entry((span.file, span.start, span.end, kind)).or_insert(next);
        if index == next {
            self.list.push(Point { kind, unit: unit.to_owned(), span });
        }
        debug_assert_eq!(self.known.len(), self.list.len(), "every point has one byte, wherever its unit is compiled");
        Some(index)
    }

    pub(crate) fn into_list(self) -> Vec<Point> {
        self.list
    }

    /// Bytes of [`NOTES_MEMORY`] for them.
    pub(crate) fn bytes(&self) -> usize {
        if self.traced { 0 } else { self.list.len() }
    }
}
