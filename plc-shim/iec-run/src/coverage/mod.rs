//! Which statements, branches and units of a program were executed.
//!
//! | module | subject |
//! |---|---|
//! | [`lcov`] | as an lcov tracefile |
//! | [`cobertura`] | as a Cobertura report |
//! | [`rows`] | as plain rows, to be carried elsewhere |
//!
//! Counts are of runs: a line with 2 was executed in two of the runs that were merged. A run that was resumed
//! from a saved state counts from there on; reports say so, because what ran before looks as if it never had.

mod cobertura;
mod lcov;
mod rows;

use std::collections::BTreeMap;

use onescan_base::VirtualTime;

use crate::compile::points::{Point, PointKind};
use onescan_iec::syntax::SourceMap;

pub use rows::{Counted, Row};

/// Of all files of an application but the standard library.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Coverage {
    files: BTreeMap<String, FileCoverage>,
    /// From when on all runs are counted; nothing if none was resumed.
    counted_from: Option<VirtualTime>,
}

/// Of one file; lines count from 1, as its author sees them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
struct FileCoverage {
    /// Units by line and name.
    units: BTreeMap<(u32, String), u64>,
    lines: BTreeMap<u32, u64>,
    /// Decisions by line and column, each with its outcomes.
    decisions: BTreeMap<(u32, u32), BTreeMap<u32, u64>>,
}

impl Coverage {
    /// What the bytes say of the points; nothing is known of the run up to `counted_from`.
    pub(crate) fn new(sources: &SourceMap, points: &[Point], seen: &[u8], counted_from: Option<VirtualTime>) -> Self {
        debug_assert!(seen.len() >= points.len(), "every point has its byte");
        let mut found = Self { counted_from, ..Self::default() };
        for (point, seen) in points.iter().zip(seen) {
            let (file, place) = sources.locate(point.span);
            let file = found.files.entry(file.to_owned()).or_default();
            let count = u64::from(*seen != 0);
            let slot = match point.kind {
                PointKind::Unit => file.units.entry((place.line, point.unit.clone())).or_default(),
                PointKind::Statement => file.lines.entry(place.line).or_default(),
                PointKind::Outcome(outcome) => {
                    file.decisions.entry((place.line, place.column)).or_default().entry(outcome).or_default()
                }
            };
            // A line is executed if any of its statements is.
            *slot = count.max(*slot);
        }
        found
    }

    /// Adds what another run executed.
    pub fn merge(&mut self, other: &Self) {
        self.counted_from = self.counted_from.max(other.counted_from);
        for (name, theirs) in &other.files {
            let file = self.files.entry(name.clone()).or_default();
            for (unit, count) in &theirs.units {
                *file.units.entry(unit.clone()).or_default() += count;
            }
            for (line, count) in &theirs.lines {
                *file.lines.entry(*line).or_default() += count;
            }
            for (at, outcomes) in &theirs.decisions {
                let known = file.decisions.entry(*at).or_default();
                for (outcome, count) in outcomes {
                    *known.entry(*outcome).or_default() += count;
                }
            }
        }
    }

    /// From when on all of the runs are counted: what one of them executed before it was resumed is not. Nothing
    /// if every run is counted from its start.
    pub fn counted_from(&self) -> Option<VirtualTime> {
        self.counted_from
    }

    /// Lines with statements, and how many of them were executed.
    pub fn lines(&self) -> (usize, usize) {
        covered(self.files.values().flat_map(|file| file.lines.values()))
    }

    /// Outcomes of decisions, and how many of them occurred.
    pub fn branches(&self) -> (usize, usize) {
        covered(self.files.values().flat_map(|file| file.decisions.values()).flat_map(BTreeMap::values))
    }
}

/// How many, and how many of them are not 0.
fn covered<'c>(counts: impl Iterator<Item = &'c u64>) -> (usize, usize) {
    counts.fold((0, 0), |(all, some), count| (all + 1, some + usize::from(*count > 0)))
}
