//! Between which numbers integer variables lie at one point of a function.

use super::address::{Address, Base, Extent, Register, Roots};
use onescan_iec::ir::ElementaryType;

/// Smallest and greatest value of an integer.
pub(crate) type Interval = (i128, i128);

/// Most variables that are remembered. Every lookup is a walk through all of them, and conditions
/// seldom speak of more at a time.
const MAX_ENTRIES: usize = 16;

/// A variable whose range is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Slot {
    Memory(Address),
    Register(Register),
}

#[derive(Debug, Clone, Copy)]
struct Entry {
    slot: Slot,
    ty: ElementaryType,
    interval: Interval,
}

impl Entry {
    /// The bytes that it lies in; nothing for a register.
    fn extent(&self) -> Option<Extent> {
        match self.slot {
            Slot::Memory(address) => Some(Extent::new(address, self.ty.size())),
            Slot::Register(_) => None,
        }
    }
}

/// The ranges, oldest first.
#[derive(Debug, Clone, Default)]
pub(crate) struct Ranges {
    entries: Vec<Entry>,
}

impl Ranges {
    pub(crate) fn find(&self, slot: Slot, ty: ElementaryType) -> Option<Interval> {
        self.entries.iter().find(|entry| entry.slot == slot && entry.ty == ty).map(|entry| entry.interval)
    }

    /// Remembers a range in place of what was known of the variable.
    pub(crate) fn insert(&mut self, slot: Slot, ty: ElementaryType, interval: Interval) {
        self.entries.retain(|entry| entry.slot != slot);
        if self.entries.len() >= MAX_ENTRIES {
            self.entries.remove(0);
        }
        self.entries.push(Entry { slot, ty, interval });
    }

    /// Forgets what a store to `extent` may change.
    pub(crate) fn forget(&mut self, extent: Extent, roots: &Roots) {
        self.retain(|entry| !roots.overlap(entry, extent), |_| true);
    }

    /// Forgets the variable in this register, and those found by way of it.
    pub(crate) fn forget_register(&mut self, register: Register) {
        let base = Base::Register(register);
        self.retain(|extent| extent.base != base, |own| own != register);
    }

    /// Forgets what does not fulfil its condition.
    pub(crate) fn retain(&mut self, memory: impl Fn(Extent) -> bool, register: impl Fn(Register) -> bool) {
        self.entries.retain(|entry| match entry.slot {
            Slot::Register(own) => register(own),
            Slot::Memory(_) => entry.extent().is_none_or(&memory),
        });
    }

    pub(crate) fn clear(&mut self) {
        self.entries.clear();
    }

    /// What holds whichever way execution came.
    pub(crate) fn meet(&mut self, other: &Self) {
        self.entries.retain_mut(|entry| {
            let there = other.find(entry.slot, entry.ty);
            if let Some((low, high)) = there {
                entry.interval = (entry.interval.0.min(low), entry.interval.1.max(high));
            }
            there.is_some()
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways_that_meet_keep_both_ranges() {
        let (slot, other) = (Slot::Register(Register::new(1)), Slot::Register(Register::new(2)));
        let (mut left, mut right) = (Ranges::default(), Ranges::default());
        left.insert(slot, ElementaryType::Dint, (0, 5));
        left.insert(other, ElementaryType::Dint, (0, 5));
        right.insert(slot, ElementaryType::Dint, (-3, 2));
        left.meet(&right);
        assert_eq!(left.find(slot, ElementaryType::Dint), Some((-3, 5)));
        assert_eq!(left.find(other, ElementaryType::Dint), None);
    }

    #[test]
    fn a_store_ends_what_was_known_of_what_it_touches() {
        let slot = |offset| Slot::Memory(Address::absolute(offset));
        let mut ranges = Ranges::default();
        for offset in [0, 4, 8] {
            ranges.insert(slot(offset), ElementaryType::Dint, (1, 2));
        }
        ranges.forget(Extent::new(Address::absolute(2), 4), &Roots::default());
        let known = [0, 4, 8].map(|offset| ranges.find(slot(offset), ElementaryType::Dint).is_some());
        assert_eq!(known, [false, false, true]);
    }
}
