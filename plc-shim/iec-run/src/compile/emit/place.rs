//! Addresses, loads and stores.

use wasm_encoder::{BlockType, Ieee32, Ieee64, Instruction, ValType};

use super::emitter::{Emitter, value_type};
use crate::compile::analyse::{Address, Base, INSTANCE, constant_index};
use crate::compile::fault::FaultKind;
use onescan_iec::ir::{ElementaryType, Expr, Place, Step, Storage, Type, TypeId};
use onescan_iec::syntax::Span;

/// What an index of an array runs through.
#[derive(Debug, Clone, Copy)]
struct Bounds {
    low: i64,
    /// How many elements there are.
    count: u32,
    /// Bytes from one element to the next.
    stride: u32,
}

/// How far an address has been computed: it lies `offset` bytes behind what is on the stack, or behind the beginning of
/// memory if nothing has been pushed.
#[derive(Debug, Clone, Copy)]
struct OnStack {
    offset: u64,
    pushed: bool,
}

impl Emitter<'_, '_> {
    /// Pushes an address; the place lies at the returned offset from it.
    pub(crate) fn address(&mut self, place: &Place) -> u64 {
        let mut on = self.storage(place.storage);
        let mut is_element = false;
        for (index, step) in place.steps.iter().enumerate() {
            match step {
                Step::Offset(further) => on.offset += u64::from(*further),
                Step::Pointer { address, target } => {
                    is_element = self.leads_to_element(*target, place.steps.get(index + 1));
                    if is_element {
                        self.referred_bytes(address, 0, place.span);
                    } else {
                        self.referred(address, *target, place.span);
                    }
                    on.pushed = true;
                }
                Step::Open { description, indices, stride } => {
                    self.open_element(description, indices, *stride, place.span);
                    self.emit(Instruction::I32Add);
                }
                Step::Index { index, low, count, stride } => {
                    if let Some(position) = constant_index(index, *low, *count) {
                        on.offset += u64::from(position * stride);
                    } else {
                        let bounds = Bounds { low: *low, count: *count, stride: *stride };
                        let offset = self.index(index, bounds, on, place.span);
                        if on.pushed {
                            self.emit(Instruction::I32Add);
                        }
                        on = OnStack { offset, pushed: true };
                    }
                }
            }
        }
        if !on.pushed {
            self.emit(Instruction::I32Const(0));
        }
        if is_element {
            self.ends_in_memory(on.offset + u64::from(self.size_of(place.ty)), place.span);
        }
        on.offset
    }

    /// True for the element of an array that a pointer leads to. The array may be declared greater than what is there,
    /// as `POINTER TO ARRAY [0..32000] OF REAL` is for an array of any length.
    fn leads_to_element(&self, target: TypeId, next: Option<&Step>) -> bool {
        let is_array = matches!(self.scope().types().get(target), Type::Array { .. });
        is_array && matches!(next, Some(Step::Index { .. } | Step::Offset(_)))
    }

    /// Pushes what stands in a register or in memory of the address that a variable begins at.
    fn storage(&mut self, storage: Storage) -> OnStack {
        let at = match storage {
            Storage::InstancePointer(at) => Some(self.scope().pointer(INSTANCE).further(at)),
            Storage::AbsolutePointer(at) => Some(Address::absolute(at)),
            _ => None,
        };
        if let Some(at) = at {
            self.load_at(at, ElementaryType::Udint);
            return OnStack { offset: 0, pushed: true };
        }
        match self.scope().beginning(storage) {
            Some(Address { base: Base::Memory, offset }) => OnStack { offset: u64::from(offset), pushed: false },
            Some(Address { base: Base::Register(register), offset }) => {
                self.get(register);
                OnStack { offset: u64::from(offset), pushed: true }
            }
            // The first step pushes it; what is in a register has no address.
            None => OnStack { offset: 0, pushed: false },
        }
    }

    /// Pushes the place's own address.
    pub(crate) fn full_address(&mut self, place: &Place) {
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
    fn index(&mut self, index: &Expr, Bounds { low, count, stride }: Bounds, on: OnStack, span: Span) -> u64 {
        let ty = self.held_as(index.ty);
        let range = self.interval(index);
        let (first, last) = (i128::from(low), i128::from(low) + i128::from(count) - 1);
        let sound = range.is_some_and(|(least, greatest)| first <= least && greatest <= last);
        let before = u64::try_from(low).ok().and_then(|low| low.checked_mul(u64::from(stride)));
        let rest = before.and_then(|before| on.offset.checked_sub(before)).filter(|_| !on.pushed);
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
        on.offset
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
    pub(crate) fn load(&mut self, place: &Place) {
        let Some(ty) = self.scope().types().elementary(place.ty) else {
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

    /// Puts what `value` pushes at an elementary place.
    pub(crate) fn store(&mut self, place: &Place, value: impl FnOnce(&mut Self)) {
        let ty = self.held_as(place.ty);
        if let Some(part) = place.part {
            self.store_part(place, part, ty, value);
            self.changed(self.extent(place));
        } else if let Storage::Register(register) = place.storage {
            value(self);
            self.store_register(register);
        } else if let Some(address) = self.fixed_address(place) {
            self.push_base(address.base);
            value(self);
            self.store_at(address, ty);
        } else {
            let offset = self.address(place);
            value(self);
            self.store_instruction(offset, ty);
            self.changed(self.extent(place));
        }
    }

    /// Makes a NaN on the stack the one that every machine writes alike: which one arithmetic
    /// gives depends on the machine, and only memory and conversions of bits can show it.
    pub(crate) fn canonical(&mut self, ty: ElementaryType) {
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
