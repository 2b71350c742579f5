//! The elements of a drawn chart (TC6 2.01, `sfcObjects`): numbers, places, connections.

use std::fmt::Write;

use super::markup::documentation;

/// Distance of two columns, and of two rows.
const GRID: (u32, u32) = (200, 60);

/// Where an element stands, in columns and rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Place {
    column: u32,
    row: u32,
}

impl Place {
    /// One row further down.
    pub(super) fn below(self) -> Self {
        Self { row: self.row.saturating_add(1), ..self }
    }

    /// In the same column, as far down as `other`.
    pub(super) fn level(self, other: Self) -> Self {
        Self { row: other.row, ..self }
    }

    fn xml(self) -> String {
        let (x, y) = (self.column.saturating_mul(GRID.0), self.row.saturating_mul(GRID.1));
        format!("<position x=\"{x}\" y=\"{y}\"/>")
    }
}

/// What has been drawn.
#[derive(Debug, Default)]
pub(super) struct Elements {
    pub(super) xml: String,
    last: u64,
    columns: u32,
}

fn inlet(from: u64) -> String {
    format!("<connectionPointIn><connection refLocalId=\"{from}\"/></connectionPointIn>")
}

const OUTLET: &str = "<connectionPointOut formalParameter=\"\"/>";

impl Elements {
    /// The top of a column that nothing stands in.
    pub(super) fn next_column(&mut self) -> Place {
        self.columns += 1;
        Place { column: self.columns - 1, row: 0 }
    }

    /// An element with its number, its place and what is in it.
    fn add(&mut self, element: &str, attributes: &str, place: Place, inner: &str) -> u64 {
        self.last += 1;
        let (id, place) = (self.last, place.xml());
        let written = writeln!(self.xml, "<{element} localId=\"{id}\"{attributes}>{place}{inner}</{element}>");
        debug_assert!(written.is_ok(), "a string takes what is written to it");
        id
    }

    pub(super) fn step(&mut self, name: &str, initial: bool, before: Option<u64>, place: Place, words: &str) -> u64 {
        let initial = if initial { " initialStep=\"true\"" } else { "" };
        let inlet = before.map(inlet).unwrap_or_default();
        let inner = format!("{inlet}{OUTLET}<connectionPointOutAction formalParameter=\"\"/>{}", documentation(words));
        self.add("step", &format!(" name=\"{name}\"{initial}"), place, &inner)
    }

    /// The actions of step `step`: attributes and name of each.
    pub(super) fn actions(&mut self, step: u64, place: Place, actions: &[(String, String)]) {
        let block = self.last + 1;
        self.last += actions.len() as u64;
        let action = |(index, (attributes, name)): (usize, &(String, String))| {
            // An action's number is one of its own.
            let (id, y) = (block + index as u64, index * 20);
            let reference = format!("<relPosition x=\"0\" y=\"{y}\"/><reference name=\"{name}\"/>");
            format!("<action localId=\"{id}\"{attributes}>{reference}</action>")
        };
        let inner: String = std::iter::once(inlet(step)).chain(actions.iter().enumerate().map(action)).collect();
        self.add("actionBlock", "", place, &inner);
    }

    /// The beginning of alternatives behind step `from`.
    pub(super) fn alternatives(&mut self, from: u64, count: usize, place: Place) -> u64 {
        self.add("selectionDivergence", "", place, &format!("{}{}", inlet(from), OUTLET.repeat(count)))
    }

    /// The beginning of simultaneous sequences behind transition `from`.
    pub(super) fn divergence(&mut self, from: u64, count: usize, place: Place) -> u64 {
        self.add("simultaneousDivergence", "", place, &format!("{}{}", inlet(from), OUTLET.repeat(count)))
    }

    /// The end of simultaneous sequences.
    pub(super) fn convergence(&mut self, from: &[u64], place: Place) -> u64 {
        let inlets: String = from.iter().copied().map(inlet).collect();
        self.add("simultaneousConvergence", "", place, &format!("{inlets}<connectionPointOut/>"))
    }

    pub(super) fn transition(
        &mut self,
        from: u64,
        rank: Option<u32>,
        condition: &str,
        place: Place,
        words: &str,
    ) -> u64 {
        let rank = rank.map(|rank| format!(" priority=\"{rank}\"")).unwrap_or_default();
        let inlet = inlet(from);
        let words = documentation(words);
        let inner = format!("{inlet}<connectionPointOut/><condition>{condition}</condition>{words}");
        self.add("transition", &rank, place.below(), &inner)
    }

    pub(super) fn jump(&mut self, target: &str, from: u64, place: Place) {
        self.add("jumpStep", &format!(" targetName=\"{target}\""), place, &inlet(from));
    }
}
