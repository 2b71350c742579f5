//! What is known at one point of a function: values in memory that registers hold already, and the
//! ranges of variables.
//!
//! Every store goes to memory at once, so that a fault finds the state as the program left it;
//! only loads are saved.

use super::address::{Address, Base, Extent, Register, Roots};
use super::effect::Effects;
use super::range::Ranges;
use onescan_iec::ir::ElementaryType;

/// Most values that are remembered: as many as a machine can hold, roughly. More would be put into memory again.
const MAX_ENTRIES: usize = 24;

/// A register holds what a load of this type from this address would give.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Entry {
    pub(crate) address: Address,
    pub(crate) ty: ElementaryType,
    pub(crate) register: Register,
}

impl Entry {
    pub(crate) fn extent(&self) -> Extent {
        Extent::new(self.address, self.ty.size())
    }
}

/// The entries, oldest first.
#[derive(Debug, Clone, Default)]
pub(crate) struct Known {
    entries: Vec<Entry>,
    ranges: Ranges,
    /// No execution comes here.
    unreachable: bool,
}

impl Known {
    pub(crate) fn find(&self, address: Address, ty: ElementaryType) -> Option<Entry> {
        self.entries.iter().find(|entry| entry.address == address && entry.ty == ty).copied()
    }

    /// Between what numbers variables lie.
    pub(crate) fn ranges(&self) -> &Ranges {
        &self.ranges
    }

    pub(crate) fn ranges_mut(&mut self) -> &mut Ranges {
        &mut self.ranges
    }

    pub(crate) fn is_unreachable(&self) -> bool {
        self.unreachable
    }

    pub(crate) fn insert(&mut self, entry: Entry) {
        if self.unreachable {
            return;
        }
        self.entries.retain(|other| other.address != entry.address || other.ty != entry.ty);
        if self.entries.len() >= MAX_ENTRIES {
            self.entries.remove(0);
        }
        self.entries.push(entry);
        debug_assert!(self.entries.len() <= MAX_ENTRIES, "no more is remembered than a machine can hold");
    }

    /// Forgets what a store to `extent` may change.
    pub(crate) fn forget(&mut self, extent: Extent, roots: &Roots) {
        self.entries.retain(|entry| !roots.overlap(entry.extent(), extent));
        self.ranges.forget(extent, roots);
    }

    /// Forgets what was found by way of this register.
    pub(crate) fn forget_base(&mut self, register: Register) {
        let base = Base::Register(register);
        self.entries.retain(|entry| entry.address.base != base);
        self.ranges.forget_register(register);
    }

    /// Forgets what a loop's turns change.
    pub(crate) fn enter_loop(&mut self, effects: &Effects, roots: &Roots) {
        let memory = |extent| !effects.changes(extent, roots);
        self.entries.retain(|entry| memory(entry.extent()));
        self.ranges.retain(memory, |register| !effects.sets(register));
    }

    pub(crate) fn forget_all(&mut self) {
        self.entries.clear();
        self.ranges.clear();
    }

    /// A jump away: what follows is not executed.
    pub(crate) fn leave(&mut self) {
        self.forget_all();
        self.unreachable = true;
    }

    /// What holds whichever way execution came.
    pub(crate) fn meet(&mut self, other: &Self) {
        if self.unreachable {
            self.clone_from(other);
        } else if !other.unreachable {
            self.entries.retain(|entry| other.entries.contains(entry));
            self.ranges.meet(&other.ranges);
        }
    }

    pub(crate) fn registers(&self) -> impl Iterator<Item = Register> {
        self.entries.iter().map(|entry| entry.register)
    }
}
