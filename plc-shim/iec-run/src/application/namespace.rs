//! Global variables whose names namespaces or lists make longer.

use super::Application;
use super::variable::{Piece, Spot, spot};
use onescan_iec::ir::Variable;

impl Application {
    /// What the first pieces of a path name in a namespace, and what is left of it. A variable is found
    /// without its namespace too, or without the first part of that, if no other has its name.
    pub(super) fn qualified_root<'p>(&self, pieces: &'p [Piece]) -> Option<(Spot, &'p [Piece])> {
        let checked = &self.inner.checked;
        let found = |variable: &Variable| spot(checked, "", variable, 0);
        let mut name = String::new();
        for (index, piece) in pieces.iter().enumerate() {
            let Piece::Name(next) = piece else { break };
            name = if index == 0 { next.clone() } else { format!("{name}.{next}") };
            if let Some(global) = checked.globals.iter().find(|each| each.name.eq_ignore_ascii_case(&name)) {
                return Some((found(global)?, pieces.get(index + 1..)?));
            }
        }
        let mut name = String::new();
        for (index, piece) in pieces.iter().enumerate() {
            let Piece::Name(next) = piece else { break };
            name = format!("{name}.{next}");
            let mut all = checked.globals.iter().filter(|global| ends_with(&global.name, &name));
            if let Some(only) = all.next().filter(|_| all.next().is_none()) {
                return Some((found(only)?, pieces.get(index + 1..)?));
            }
        }
        None
    }
}

/// In any case.
fn ends_with(name: &str, tail: &str) -> bool {
    let end = name.len().checked_sub(tail.len()).and_then(|start| name.get(start..));
    end.is_some_and(|end| end.eq_ignore_ascii_case(tail))
}
