//! Structures that nobody declares and that are assigned to one another: they are one type with several names.

use std::collections::BTreeMap;

use super::collect::Collector;
use super::shape::Shape;
use super::ty::Ty;

impl Collector<'_> {
    /// Makes one of two structures another name of the other; true if there were two.
    pub(super) fn unite(&mut self) -> bool {
        let found = self.pairs();
        for (gone, kept) in &found {
            let Some(lost) = self.needs.types.remove(gone) else { continue };
            if !lost.is_anonymous {
                self.needs.aliases.insert(gone.clone(), (lost.name, kept.clone()));
            }
            for (_, target) in self.needs.aliases.values_mut().filter(|(_, target)| target == gone) {
                target.clone_from(kept);
            }
            self.slots.rename(gone, kept);
        }
        !found.is_empty()
    }

    /// Each structure that becomes another name, with the one that stays.
    fn pairs(&self) -> BTreeMap<String, String> {
        let is_plain = |key: &str| {
            let found = self.needs.types.get(key)?;
            let is_own = found.base_of_structure || found.extends_stub || found.name.contains('.');
            (!is_own && self.shape(found) == Shape::Structure).then_some(found)
        };
        let mut pairs = BTreeMap::new();
        for (key, each) in &self.needs.types {
            let Some(one) = is_plain(key) else { continue };
            for (other_key, other) in each.stands_for.iter().filter_map(|other| Some((other, is_plain(other)?))) {
                let order = |key: &str, is_anonymous: bool| (is_anonymous, key.to_owned());
                let is_first = order(key, one.is_anonymous) < order(other_key, other.is_anonymous);
                let (kept, gone) = if is_first { (key, other_key) } else { (other_key, key) };
                // What goes in this round has no other name in it.
                if !pairs.contains_key(kept) && !pairs.contains_key(gone) && !pairs.values().any(|used| used == gone) {
                    pairs.insert(gone.clone(), kept.clone());
                }
            }
        }
        pairs
    }

    /// The type of a key, or the one that it is another name of.
    pub(super) fn foreign_type(&self, key: String) -> Ty {
        Ty::Foreign(self.needs.aliases.get(&key).map_or(key, |(_, kept)| kept.clone()))
    }
}
