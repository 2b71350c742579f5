//! What the turns of a loop read and change.

use std::collections::{BTreeMap, BTreeSet};

use super::address::{Address, Base, Extent, Register, Roots};
use super::range::Slot;
use super::step::Steps;
use onescan_iec::ir::ElementaryType;

/// Most different accesses that are distinguished: each is compared with each.
const MAX_ACCESSES: usize = 512;

/// Accesses of one loop's body.
#[derive(Debug, Clone, Default)]
pub(crate) struct Effects {
    /// Loads of elementary places at known addresses, and how many of each.
    loads: Vec<(Address, ElementaryType, u32)>,
    stores: BTreeMap<(Address, ElementaryType), u32>,
    /// All other changes of memory.
    changes: BTreeSet<Extent>,
    /// Registers that are set, and how often.
    registers: BTreeMap<Register, u32>,
    /// Variables that are counted up or down by constants.
    steps: Steps,
    /// Something is changed that could lie anywhere.
    anything: bool,
}

impl Effects {
    pub(crate) fn load(&mut self, address: Address, ty: ElementaryType) {
        let known = self.loads.iter_mut().find(|(known, known_ty, _)| *known == address && *known_ty == ty);
        if let Some((_, _, count)) = known {
            *count += 1;
        } else if self.loads.len() < MAX_ACCESSES {
            self.loads.push((address, ty, 1));
        }
    }

    /// True if the value has been loaded before.
    pub(crate) fn loads_again(&self, address: Address, ty: ElementaryType) -> bool {
        self.loads.iter().any(|(known, known_ty, _)| *known == address && *known_ty == ty)
    }

    pub(crate) fn store(&mut self, address: Address, ty: ElementaryType) {
        *self.stores.entry((address, ty)).or_default() += 1;
        self.anything |= self.stores.len() > MAX_ACCESSES;
    }

    pub(crate) fn change(&mut self, extent: Option<Extent>) {
        match extent {
            Some(extent) if self.changes.len() < MAX_ACCESSES => {
                self.changes.insert(extent);
            }
            _ => self.anything = true,
        }
    }

    /// Variables that are counted up or down by constants.
    pub(crate) fn steps(&self) -> &Steps {
        &self.steps
    }

    pub(crate) fn steps_mut(&mut self) -> &mut Steps {
        &mut self.steps
    }

    pub(crate) fn set(&mut self, register: Register) {
        *self.registers.entry(register).or_default() += 1;
    }

    pub(crate) fn sets(&self, register: Register) -> bool {
        self.registers.contains_key(&register)
    }

    /// True if memory there may change.
    pub(crate) fn changes(&self, extent: Extent, roots: &Roots) -> bool {
        let stored = |(address, ty): &(Address, ElementaryType)| Extent::new(*address, ty.size());
        self.anything
            || self.stores.keys().any(|store| roots.overlap(stored(store), extent))
            || self.changes.iter().any(|change| roots.overlap(*change, extent))
    }

    /// True if all of memory may change.
    pub(crate) fn changes_anything(&self) -> bool {
        self.anything
    }

    /// What is worth a register through all turns of the loop, most used first: only stores to
    /// this very place change it.
    pub(crate) fn candidates(&self, roots: &Roots) -> Vec<(Address, ElementaryType)> {
        if self.anything {
            return Vec::new();
        }
        let mut found: Vec<_> = self.loads.iter().filter(|(address, ty, _)| self.keeps(*address, *ty, roots)).collect();
        found.sort_by_key(|(address, _, count)| (std::cmp::Reverse(*count), *address));
        found.into_iter().map(|(address, ty, _)| (*address, *ty)).collect()
    }

    /// How many times the variable is set, if nothing else changes it.
    pub(crate) fn sets_of(&self, slot: Slot, ty: ElementaryType, roots: &Roots) -> Option<u32> {
        match slot {
            Slot::Register(register) => self.registers.get(&register).copied(),
            Slot::Memory(address) if !self.anything && self.keeps(address, ty, roots) => {
                self.stores.get(&(address, ty)).copied()
            }
            Slot::Memory(_) => None,
        }
    }

    fn keeps(&self, address: Address, ty: ElementaryType, roots: &Roots) -> bool {
        let extent = Extent::new(address, ty.size());
        let steady = !matches!(address.base, Base::Register(register) if self.registers.contains_key(&register));
        let itself = |store: &(Address, ElementaryType)| *store == (address, ty);
        let apart = |store: &(Address, ElementaryType)| {
            itself(store) || !roots.overlap(Extent::new(store.0, store.1.size()), extent)
        };
        steady && self.stores.keys().all(apart) && !self.changes.iter().any(|change| roots.overlap(*change, extent))
    }
}
