//! Loads, stores and addresses.

use super::Walk;
use crate::compile::analyse::address::{Address, Base, Extent, Register};
use crate::compile::analyse::price;
use crate::compile::analyse::scope::{INSTANCE, constant_index};
use onescan_iec::ir::{ElementaryType, Place, Step, Storage};

impl Walk<'_, '_> {
    pub(super) fn load(&mut self, place: &Place) {
        let Some(ty) = self.scope.types().elementary(place.ty) else {
            self.full_address(place);
            return;
        };
        if place.part.is_some() {
            if !matches!(place.storage, Storage::Register(_)) {
                self.address(place);
            }
            self.charge(price::PART);
        } else if let Storage::Register(_) = place.storage {
            self.charge(1);
        } else if let Some(address) = self.scope.fixed_address(place) {
            self.load_at(address, ty);
        } else {
            self.address(place);
            self.charge(1);
        }
    }

    pub(super) fn load_at(&mut self, address: Address, ty: ElementaryType) {
        let again = self.effects.loads_again(address, ty);
        self.charge(if again { price::HELD_LOAD } else { price::LOAD });
        self.effects.load(address, ty);
    }

    pub(super) fn store(&mut self, place: &Place, value: impl FnOnce(&mut Self)) {
        if place.part.is_some() {
            if let Storage::Register(local) = place.storage {
                value(self);
                self.set(self.scope.register(local));
            } else {
                self.address(place);
                value(self);
            }
            self.charge(2 * price::PART);
            self.changed(self.scope.extent(place));
        } else if let Storage::Register(local) = place.storage {
            value(self);
            self.set(self.scope.register(local));
        } else if let Some(address) = self.scope.fixed_address(place) {
            value(self);
            self.store_at(address, self.scope.held_as(place.ty));
        } else {
            self.address(place);
            value(self);
            self.charge(1);
            self.changed(self.scope.extent(place));
        }
    }

    pub(super) fn store_at(&mut self, address: Address, ty: ElementaryType) {
        self.charge(price::STORE);
        let extent = Extent::new(address, ty.size());
        match self.scope.roots().settled(extent, |register| self.effects.sets(register)) {
            settled if settled == extent => self.effects.store(address, ty),
            settled => self.effects.change(Some(settled)),
        }
    }

    pub(super) fn set(&mut self, register: Register) {
        self.charge(1);
        self.effects.set(register);
    }

    pub(super) fn changed(&mut self, extent: Option<Extent>) {
        let settled = |extent| self.scope.roots().settled(extent, |register| self.effects.sets(register));
        let extent = extent.map(settled);
        self.effects.change(extent);
    }

    pub(super) fn address(&mut self, place: &Place) {
        let mut pushed = self.storage(place.storage);
        for step in &place.steps {
            match step {
                Step::Offset(_) => {}
                Step::Pointer { address, .. } => {
                    self.expression(address);
                    self.charge(price::REFERENCE);
                    pushed = true;
                }
                Step::Open { description, indices, .. } => {
                    self.full_address(description);
                    self.charge(price::open_element(indices.len() as u64));
                    self.expressions(indices);
                }
                Step::Index { index, low, count, stride } => {
                    if constant_index(index, *low, *count).is_none() {
                        self.expression(index);
                        let added = u64::from(pushed);
                        self.charge(price::index(self.scope.held_as(index.ty), *low, *stride) + added);
                        pushed = true;
                    }
                }
            }
        }
        self.charge(u64::from(!pushed));
    }

    pub(super) fn storage(&mut self, storage: Storage) -> bool {
        match storage {
            Storage::InstancePointer(at) => {
                self.load_at(self.scope.pointer(INSTANCE).further(at), ElementaryType::Udint);
                true
            }
            Storage::AbsolutePointer(at) => {
                self.load_at(Address::absolute(at), ElementaryType::Udint);
                true
            }
            Storage::Absolute(_) | Storage::Located(_) | Storage::Instance(_) | Storage::RegisterPointer(_) => {
                let beginning = self.scope.beginning(storage);
                let register = matches!(beginning, Some(Address { base: Base::Register(_), .. }));
                self.charge(u64::from(register));
                register
            }
            Storage::Register(_) | Storage::Referred => false,
        }
    }

    pub(super) fn full_address(&mut self, place: &Place) {
        if let Some(Address { base: Base::Memory, .. }) = self.scope.fixed_address(place) {
            self.charge(1);
        } else {
            self.address(place);
            self.charge(2);
        }
    }
}
