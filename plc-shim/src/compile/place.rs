//! Addresses, loads and stores.

use std::collections::BTreeSet;

use wasm_encoder::{BlockType, Ieee32, Ieee64, Instruction, MemArg, ValType};

use super::address::{Address, Base, Extent};
use super::emitter::{Emitter, value_type};
use super::fault::FaultKind;
use super::known::Entry;
use super::registers::Register;
use crate::ir::elementary::Kind;
use crate::ir::{ElementaryType, Expr, ExprKind, LocalId, Place, Step, Storage, Value};
use crate::syntax::Span;

/// Register of the running instance's address.
pub(super) const INSTANCE: LocalId = LocalId(0);

fn argument(offset: u64, ty: ElementaryType) -> MemArg {
    MemArg { offset, align: ty.size().trailing_zeros(), memory_index: 0 }
}

/// A constant index, if it lies inside of its array.
fn constant_index(index: &Expr, low: i64, count: u32) -> Option<u32> {
    match index.kind {
        ExprKind::Constant(Value::Int(value)) => {
            u32::try_from(value - i128::from(low)).ok().filter(|position| *position < count)
        }
        _ => None,
    }
}

impl Emitter<'_, '_> {
    /// The address of a pointer's target, as far as it is known.
    fn pointer(&self, local: LocalId) -> Address {
        let known = self.frames.last().and_then(|frame| frame.pointers.get(&local)).copied();
        known.unwrap_or_else(|| Address::of_register(self.register(local)))
    }

    /// Where the variable begins; nothing if its address stands in memory or it has none.
    fn beginning(&self, storage: Storage) -> Option<Address> {
        match storage {
            Storage::Absolute(offset) => Some(Address::absolute(offset)),
            Storage::Located(location) => Some(Address::absolute(self.shared.areas.offset(location))),
            Storage::Instance(offset) => Some(self.pointer(INSTANCE).further(offset)),
            Storage::RegisterPointer(register) => Some(self.pointer(register)),
            Storage::InstancePointer(_) | Storage::AbsolutePointer(_) | Storage::Register(_) | Storage::Referred => {
                None
            }
        }
    }

    /// The address of a place without indices that are only known at run time.
    pub(super) fn fixed_address(&self, place: &Place) -> Option<Address> {
        let mut address = self.beginning(place.storage)?;
        for step in &place.steps {
            address = match step {
                Step::Offset(further) => address.further(*further),
                Step::Index { index, low, count, stride } => {
                    address.further(constant_index(index, *low, *count)? * stride)
                }
                Step::Pointer { .. } | Step::Open { .. } => return None,
            };
        }
        Some(address)
    }

    /// All bytes that the place may stand for, whatever its indices are.
    pub(super) fn extent(&self, place: &Place) -> Option<Extent> {
        let mut address = self.beginning(place.storage)?;
        let mut size = self.shared.types.size(place.ty);
        for step in &place.steps {
            match step {
                Step::Offset(further) => address = address.further(*further),
                Step::Index { index, low, count, stride } => match constant_index(index, *low, *count) {
                    Some(position) => address = address.further(position * stride),
                    None => size = size.saturating_add(count.saturating_sub(1).saturating_mul(*stride)),
                },
                Step::Pointer { .. } | Step::Open { .. } => return None,
            }
        }
        Some(Extent::new(address, size))
    }

    /// Pushes an address; the place lies at the returned offset from it.
    pub(super) fn address(&mut self, place: &Place) -> u64 {
        let mut offset = 0;
        let mut pushed = false;
        if let Some(address) = self.beginning(place.storage) {
            offset = u64::from(address.offset);
            if let Base::Register(register) = address.base {
                self.get(register);
                pushed = true;
            }
        } else if let Storage::InstancePointer(at) = place.storage {
            self.load_at(self.pointer(INSTANCE).further(at), ElementaryType::Udint);
            pushed = true;
        } else if let Storage::AbsolutePointer(at) = place.storage {
            self.load_at(Address::absolute(at), ElementaryType::Udint);
            pushed = true;
        }
        for step in &place.steps {
            match step {
                Step::Offset(further) => offset += u64::from(*further),
                Step::Pointer { address, target } => {
                    self.referred(address, *target, place.span);
                    pushed = true;
                }
                Step::Open { description, indices, stride } => {
                    self.open_element(description, indices, *stride, place.span);
                    self.emit(Instruction::I32Add);
                }
                Step::Index { index, low, count, stride } => {
                    if let Some(position) = constant_index(index, *low, *count) {
                        offset += u64::from(position * stride);
                    } else {
                        offset = self.index(index, (*low, *count, *stride), (offset, pushed), place.span);
                        if pushed {
                            self.emit(Instruction::I32Add);
                        }
                        pushed = true;
                    }
                }
            }
        }
        if !pushed {
            self.emit(Instruction::I32Const(0));
        }
        offset
    }

    /// Pushes the place's own address.
    pub(super) fn full_address(&mut self, place: &Place) {
        if let Some(Address { base: Base::Memory, offset }) = self.fixed_address(place) {
            self.emit(Instruction::I32Const(offset as i32));
            return;
        }
        let offset = self.address(place);
        if offset > 0 {
            self.emit(Instruction::I32Const(offset as i32));
            self.emit(Instruction::I32Add);
        }
    }

    /// Pushes `(index - low) * stride`, or `index * stride` if the offset so far has room for
    /// the rest; returns the offset.
    fn index(
        &mut self,
        index: &Expr,
        (low, count, stride): (i64, u32, u32),
        (offset, pushed): (u64, bool),
        span: Span,
    ) -> u64 {
        let ty = self.held_as(index.ty);
        let range = self.interval(index);
        let (first, last) = (i128::from(low), i128::from(low) + i128::from(count) - 1);
        let sound = range.is_some_and(|(least, greatest)| first <= least && greatest <= last);
        let before = u64::try_from(low).ok().and_then(|low| low.checked_mul(u64::from(stride)));
        let rest = before.and_then(|before| offset.checked_sub(before)).filter(|_| !pushed);
        self.expression(index);
        if let (true, Some(rest)) = (sound, rest) {
            if value_type(ty) == ValType::I64 {
                self.emit(Instruction::I32WrapI64);
            }
            self.scaled(stride);
            return rest;
        }
        self.position(ty, low, (!sound).then_some(count), span);
        self.scaled(stride);
        offset
    }

    /// Turns the index on the stack into a position from 0. Below `low` the difference wraps to a
    /// number that no array's count reaches, so one comparison checks both bounds.
    fn position(&mut self, ty: ElementaryType, low: i64, count: Option<u32>, span: Span) {
        let wide = ty.size() == 8 || ty == ElementaryType::Udint;
        if ty == ElementaryType::Udint {
            self.emit(Instruction::I64ExtendI32U);
        }
        if low != 0 {
            self.emit(if wide { Instruction::I64Const(low) } else { Instruction::I32Const(low as i32) });
            self.emit(if wide { Instruction::I64Sub } else { Instruction::I32Sub });
        }
        if let Some(count) = count {
            let difference = self.scratch(if wide { ValType::I64 } else { ValType::I32 });
            self.tee(difference);
            let limit = i64::from(count);
            self.emit(if wide { Instruction::I64Const(limit) } else { Instruction::I32Const(limit as i32) });
            self.emit(if wide { Instruction::I64GeU } else { Instruction::I32GeU });
            self.fault_if(FaultKind::IndexOutOfRange, span);
            self.get(difference);
            self.release(difference);
        }
        if wide {
            self.emit(Instruction::I32WrapI64);
        }
    }

    fn scaled(&mut self, stride: u32) {
        if stride != 1 {
            self.emit(Instruction::I32Const(stride as i32));
            self.emit(Instruction::I32Mul);
        }
    }

    /// Pushes the value at an elementary place, or an aggregate's address.
    pub(super) fn load(&mut self, place: &Place) {
        let Some(ty) = self.shared.types.elementary(place.ty) else {
            self.full_address(place);
            return;
        };
        if let Some(part) = place.part {
            self.load_part(place, part, ty);
        } else if let Storage::Register(register) = place.storage {
            self.get(self.register(register));
        } else if let Some(address) = self.fixed_address(place) {
            self.load_at(address, ty);
        } else {
            let offset = self.address(place);
            self.load_instruction(offset, ty);
        }
    }

    /// Pushes the value at an address, from a register that has it if there is one.
    pub(super) fn load_at(&mut self, address: Address, ty: ElementaryType) {
        if let Some(trial) = &mut self.trial {
            trial.load(address, ty);
        }
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

    /// Pushes what stands in memory.
    pub(super) fn load_from(&mut self, address: Address, ty: ElementaryType) {
        self.base(address.base);
        self.load_instruction(u64::from(address.offset), ty);
    }

    fn base(&mut self, base: Base) {
        match base {
            Base::Memory => self.emit(Instruction::I32Const(0)),
            Base::Register(register) => self.get(register),
        }
    }

    fn load_instruction(&mut self, offset: u64, ty: ElementaryType) {
        let argument = argument(offset, ty);
        self.emit(match (ty.kind(), ty.size()) {
            (Kind::Real, 4) => Instruction::F32Load(argument),
            (Kind::Real, _) => Instruction::F64Load(argument),
            (Kind::Signed, 1) => Instruction::I32Load8S(argument),
            (Kind::Signed, 2) => Instruction::I32Load16S(argument),
            (_, 1) => Instruction::I32Load8U(argument),
            (_, 2) => Instruction::I32Load16U(argument),
            (_, 4) => Instruction::I32Load(argument),
            _ => Instruction::I64Load(argument),
        });
    }

    /// Puts what `value` pushes at an elementary place.
    pub(super) fn store(&mut self, place: &Place, value: impl FnOnce(&mut Self)) {
        let ty = self.held_as(place.ty);
        if let Some(part) = place.part {
            self.store_part(place, part, ty, value);
            self.changed(self.extent(place));
        } else if let Storage::Register(register) = place.storage {
            value(self);
            let register = self.register(register);
            self.set(register);
            self.known.forget_base(register);
        } else if let Some(address) = self.fixed_address(place) {
            self.base(address.base);
            value(self);
            self.store_at(address, ty);
        } else {
            let offset = self.address(place);
            value(self);
            self.store_instruction(offset, ty);
            self.changed(self.extent(place));
        }
    }

    /// Stores the value on the stack, which stands above its base, and remembers it.
    pub(super) fn store_at(&mut self, address: Address, ty: ElementaryType) {
        if let Some(trial) = &mut self.trial {
            let extent = Extent::new(address, ty.size());
            match self.roots.settled(extent, |register| trial.sets(register)) {
                settled if settled == extent => trial.store(address, ty),
                settled => trial.change(Some(settled)),
            }
        }
        let pinned = self.pinned(address, ty);
        let entry = match pinned {
            None => self.cache(ty).map(|register| Entry { address, ty, register }),
            pinned => pinned,
        };
        if let Some(entry) = entry {
            self.tee(entry.register);
        }
        self.store_instruction(u64::from(address.offset), ty);
        self.known.forget(Extent::new(address, ty.size()), &self.roots);
        if let (Some(entry), None) = (entry, pinned) {
            self.known.insert(entry);
        }
    }

    fn pinned(&self, address: Address, ty: ElementaryType) -> Option<Entry> {
        self.pins.iter().find(|entry| entry.address == address && entry.ty == ty).copied()
    }

    fn store_instruction(&mut self, offset: u64, ty: ElementaryType) {
        let argument = argument(offset, ty);
        self.emit(match (ty.kind(), ty.size()) {
            (Kind::Real, 4) => Instruction::F32Store(argument),
            (Kind::Real, _) => Instruction::F64Store(argument),
            (_, 1) => Instruction::I32Store8(argument),
            (_, 2) => Instruction::I32Store16(argument),
            (_, 4) => Instruction::I32Store(argument),
            _ => Instruction::I64Store(argument),
        });
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
    /// known may be held elsewhere.
    pub(super) fn sweep(&mut self) {
        let held = self.held > 0 || self.frames.iter().any(|frame| frame.returned.is_some());
        if held || self.caches.len() < 64 {
            return;
        }
        let pinned = self.pins.iter().map(|entry| entry.register);
        let used: BTreeSet<Register> = self.known.registers().chain(pinned).collect();
        let (kept, unused) = std::mem::take(&mut self.caches).into_iter().partition(|register| used.contains(register));
        self.caches = kept;
        for register in unused {
            self.release(register);
        }
    }

    /// Makes a NaN on the stack the one that every machine writes alike: which one arithmetic
    /// gives depends on the machine, and only memory and conversions of bits can show it.
    pub(super) fn canonical(&mut self, ty: ElementaryType) {
        let held = value_type(ty);
        let value = self.scratch(held);
        self.set(value);
        self.get(value);
        self.get(value);
        let single = held == ValType::F32;
        self.emit(if single { Instruction::F32Ne } else { Instruction::F64Ne });
        // A branch that is hardly ever taken: a choice would stand in the way of what uses the value.
        self.emit(Instruction::If(BlockType::Empty));
        self.emit(if single {
            Instruction::F32Const(Ieee32::new(0x7fc0_0000))
        } else {
            Instruction::F64Const(Ieee64::new(0x7ff8_0000_0000_0000))
        });
        self.set(value);
        self.emit(Instruction::End);
        self.get(value);
        self.release(value);
    }
}
