//! Global variables whose names namespaces or lists make longer.

use super::Application;
use super::variable::{Piece, Spot, spot};
use crate::ir::Variable;

impl Application {
    /// What the first pieces of a path name in a namespace, and what is left of it. A variable is found
    /// without its namespace too, if no other has its name.
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
        let (Piece::Name(first), rest) = pieces.split_first()? else { return None };
        let is_it =
            |each: &&Variable| each.name.rsplit_once('.').is_some_and(|(_, last)| last.eq_ignore_ascii_case(first));
        let mut all = checked.globals.iter().filter(is_it);
        let only = all.next().filter(|_| all.next().is_none())?;
        Some((found(only)?, rest))
    }
}
