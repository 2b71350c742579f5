//! Values in memory that registers hold too: fetched or stored before, or for as long as a loop runs.

use std::collections::BTreeSet;

use super::{Emitter, value_type};
use crate::compile::analyse::{Address, Effects, Entry, Extent, Known, Register};
use onescan_iec::ir::{ElementaryType, LocalId};

/// Most values that loops keep in registers. A machine has about 16, of which some are needed to compute.
const MAX_PINS: usize = 10;

/// Caches are swept once there are so many: a sweep looks at all of them.
const MANY_CACHES: usize = 64;

impl Emitter<'_, '_> {
    /// Pushes the value at an address, from a register that has it if there is one.
    pub(crate) fn load_at(&mut self, address: Address, ty: ElementaryType) {
        if let Some(entry) = self.pinned(address, ty).or_else(|| self.known.find(address, ty)) {
            self.get(entry.register);
            return;
        }
        self.load_from(address, ty);
        if let Some(register) = self.cache(ty) {
            self.tee(register);
            self.known.insert(Entry { address, ty, register });
        }
    }

    /// Stores the value on the stack, which stands above its base, and remembers it.
    pub(crate) fn store_at(&mut self, address: Address, ty: ElementaryType) {
        self.expect_change(Some(Extent::new(address, ty.size())));
        let pinned = self.pinned(address, ty);
        // A pinned value has its register already, and must keep it through all turns.
        let entry = match pinned {
            None => self.cache(ty).map(|register| Entry { address, ty, register }),
            pinned => pinned,
        };
        if let Some(entry) = entry {
            self.tee(entry.register);
        }
        self.store_instruction(u64::from(address.offset), ty);
        self.known.forget(Extent::new(address, ty.size()), self.scope.roots());
        if let (Some(entry), None) = (entry, pinned) {
            self.known.insert(entry);
        }
    }

    /// Puts the value on the stack into a unit's own register, which addresses may count from.
    pub(crate) fn store_register(&mut self, local: LocalId) {
        let register = self.register(local);
        self.set(register);
        self.known.forget_base(register);
    }

    fn pinned(&self, address: Address, ty: ElementaryType) -> Option<Entry> {
        self.pins.iter().find(|entry| entry.address == address && entry.ty == ty).copied()
    }

    /// A register for a value that is remembered; nothing where it would not pay.
    fn cache(&mut self, ty: ElementaryType) -> Option<Register> {
        if self.known.is_unreachable() || self.registers.are_many() {
            return None;
        }
        let register = self.scratch(value_type(ty));
        self.caches.push(register);
        Some(register)
    }

    /// Gives back the registers of values that are no longer remembered. No copy of what is
    /// known may be kept elsewhere: it would speak of registers that hold something else by then.
    pub(crate) fn sweep(&mut self) {
        let kept_elsewhere = self.held > 0 || self.frames.iter().any(super::Frame::has_returned);
        if kept_elsewhere || self.caches.len() < MANY_CACHES {
            return;
        }
        let pinned = self.pins.iter().map(|entry| entry.register);
        let entered = self.entered.iter().copied();
        let used: BTreeSet<Register> = self.known.registers().chain(pinned).chain(entered).collect();
        let (kept, unused) = std::mem::take(&mut self.caches).into_iter().partition(|register| used.contains(register));
        self.caches = kept;
        for register in unused {
            self.release(register);
        }
    }

    /// Gets a value into a register for as long as the loop runs that is about to be entered.
    fn pin(&mut self, address: Address, ty: ElementaryType) {
        if self.known.is_unreachable() || self.registers.are_many() || self.pinned(address, ty).is_some() {
            return;
        }
        match self.known.find(address, ty) {
            Some(entry) => self.get(entry.register),
            None => self.load_from(address, ty),
        }
        let register = self.scratch(value_type(ty));
        self.set(register);
        self.pins.push(Entry { address, ty, register });
    }

    /// Makes what lies in a loop: `emit` makes its turns, which do no more than `effects`. What they change is
    /// forgotten, and what they use most is got into registers, the variable that the loop counts, if it has one, first of
    /// all.
    pub(crate) fn in_turns(
        &mut self,
        effects: &Effects,
        counted: Option<(Address, ElementaryType)>,
        emit: impl FnOnce(&mut Self),
    ) {
        let before = self.pins.len();
        if let Some((address, ty)) = counted {
            self.pin(address, ty);
        }
        for (address, ty) in effects.candidates(self.scope.roots()) {
            if self.pins.len() >= MAX_PINS {
                break;
            }
            self.pin(address, ty);
        }
        self.known.enter_loop(effects, self.scope.roots());
        self.foreseen.push(effects.clone());
        // The begin of each turn reads these registers, also where the end of the turn remembers them no longer.
        let entered = self.entered.len();
        self.entered.extend(self.known.registers());
        emit(self);
        debug_assert!(self.entered.len() >= entered, "a loop inside gives back its own registers only");
        self.entered.truncate(entered);
        self.foreseen.pop();
        debug_assert!(self.pins.len() >= before, "a loop inside gives back its own pins only");
        // Behind the loop its registers still hold what is in memory.
        self.known = Known::default();
        for entry in self.pins.split_off(before) {
            self.caches.push(entry.register);
            self.known.insert(entry);
        }
    }
}
