//! Names of a scene: each given once, each found again by its index.

use std::ops::Range;

use super::placed::Placed;

use super::error::{SceneFaultKind, Thing};
use super::faults::Faults;

/// The names of all things of one sort, in the file's order.
pub(super) struct Names {
    thing: Thing,
    entries: Vec<(String, Range<usize>)>,
}

impl Names {
    /// No names yet.
    pub(super) fn none(thing: Thing) -> Self {
        Self { thing, entries: Vec::new() }
    }

    /// Takes all names of a sort; a name that was there before is a fault.
    pub(super) fn gather<'n>(
        thing: Thing,
        names: impl IntoIterator<Item = &'n Placed<String>>,
        faults: &mut Faults<'_>,
    ) -> Self {
        let mut all = Self::none(thing);
        for name in names {
            all.claim(name, faults);
        }
        all
    }

    /// Takes one more name; a name that was there before is a fault.
    pub(super) fn claim(&mut self, name: &Placed<String>, faults: &mut Faults<'_>) {
        if let Some((_, first)) = self.entries.iter().find(|(known, _)| known == name.get_ref()) {
            let first = faults.place(first.start);
            let doubled = SceneFaultKind::Doubled { thing: self.thing, name: name.get_ref().clone(), first };
            faults.add(name.span(), doubled);
        }
        self.entries.push((name.get_ref().clone(), name.span()));
    }

    /// True if the name was given.
    pub(super) fn contains(&self, name: &str) -> bool {
        self.entries.iter().any(|(known, _)| known == name)
    }

    /// The index of a name; one that was never given is a fault.
    pub(super) fn find(&self, name: &Placed<String>, faults: &mut Faults<'_>) -> Option<usize> {
        self.find_beside(name, None, faults)
    }

    /// Like [`Names::find`], with one more name that the scene knows by itself.
    pub(super) fn find_beside(
        &self,
        name: &Placed<String>,
        known: Option<&str>,
        faults: &mut Faults<'_>,
    ) -> Option<usize> {
        let index = self.entries.iter().position(|(entry, _)| entry == name.get_ref());
        if index.is_none() {
            faults.unknown(self.thing, name, self.entries.iter().map(|(entry, _)| entry.as_str()).chain(known));
        }
        index
    }
}
