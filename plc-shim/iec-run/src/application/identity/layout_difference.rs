//! In which variable two layouts differ.

use std::collections::{BTreeMap, BTreeSet};

use thiserror::Error;

use super::layout::{Layout, Member, Parts, Shape};

/// A variable in which the layout of a saved state differs from that of the program.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum VariableDifference {
    /// The program has it, the state does not.
    #[error("the saved state has no variable `{path}`")]
    Missing { path: String },
    /// The state has it, the program does not.
    #[error("the saved state has a variable `{path}`, which the program does not have")]
    Unknown { path: String },
    /// Both have it, but not of the same type.
    #[error("the saved state has another type of `{path}`: {saved}, not {wanted}")]
    Type {
        path: String,
        /// The type in the state.
        saved: String,
        /// The type in the program.
        wanted: String,
    },
    /// It lies elsewhere, although all variables are the same: they are declared in another order.
    #[error("the saved state has `{path}` at another place in memory")]
    Place { path: String },
}

impl Layout {
    /// The first difference to the layout of a state; a variable more or less or of another type comes before
    /// variables that lie elsewhere because of it. Nothing if the two are equal.
    pub(crate) fn difference(&self, saved: &Self) -> Option<VariableDifference> {
        let mut search = Search { wanted: self, saved, equal: BTreeSet::new(), moved: None };
        let found = search.members("", &self.roots, &saved.roots);
        found.or_else(|| search.moved.map(|path| VariableDifference::Place { path }))
    }
}

struct Search<'l> {
    wanted: &'l Layout,
    saved: &'l Layout,
    /// Pairs of types, the program's and the state's, that have been found alike.
    equal: BTreeSet<(u32, u32)>,
    /// The first variable that lies elsewhere.
    moved: Option<String>,
}

impl Search<'_> {
    fn members(&mut self, path: &str, wanted: &[Member], saved: &[Member]) -> Option<VariableDifference> {
        let (ours, theirs) = (by_name(wanted), by_name(saved));
        let path_of = |member: &Member| {
            let dot = if path.is_empty() { "" } else { "." };
            format!("{path}{dot}{}", member.name)
        };
        if let Some(missing) = ours.iter().find(|(name, _)| !theirs.contains_key(*name)) {
            return Some(VariableDifference::Missing { path: path_of(missing.1) });
        }
        if let Some(unknown) = theirs.iter().find(|(name, _)| !ours.contains_key(*name)) {
            return Some(VariableDifference::Unknown { path: path_of(unknown.1) });
        }
        for (ours, theirs) in ours.values().zip(theirs.values()) {
            let path = path_of(ours);
            if let Some(found) = self.shapes(&path, ours.shape, theirs.shape) {
                return Some(found);
            }
            if (ours.offset, ours.bit) != (theirs.offset, theirs.bit) {
                self.moved.get_or_insert(path);
            }
        }
        None
    }

    fn shapes(&mut self, path: &str, wanted: u32, saved: u32) -> Option<VariableDifference> {
        if self.equal.contains(&(wanted, saved)) {
            return None;
        }
        let (ours, theirs) = (self.wanted.shapes.get(wanted as usize)?, self.saved.shapes.get(saved as usize)?);
        let found = self.parts(path, ours, theirs);
        if found.is_none() {
            self.equal.insert((wanted, saved));
        }
        found
    }

    fn parts(&mut self, path: &str, ours: &Shape, theirs: &Shape) -> Option<VariableDifference> {
        if ours.name.eq_ignore_ascii_case(&theirs.name) {
            match (&ours.parts, &theirs.parts) {
                (Parts::None, Parts::None) if ours.size == theirs.size => return None,
                (Parts::Elements(wanted), Parts::Elements(saved)) => {
                    return self.shapes(&format!("{path}[]"), *wanted, *saved);
                }
                (Parts::Members(wanted), Parts::Members(saved)) => return self.members(path, wanted, saved),
                // A name that stands for types of different forms.
                _ => {}
            }
        }
        let (saved, wanted) = (theirs.name.clone(), ours.name.clone());
        Some(VariableDifference::Type { path: path.to_owned(), saved, wanted })
    }
}

/// Members by name, and by number where methods of different units share one.
fn by_name(members: &[Member]) -> BTreeMap<(String, usize), &Member> {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    let numbered = members.iter().map(|member| {
        let name = member.name.to_ascii_uppercase();
        let count = counts.entry(name.clone()).or_default();
        *count += 1;
        ((name, *count), member)
    });
    numbered.collect()
}
