//! Addresses, loads and stores.

use wasm_encoder::{Instruction, MemArg};

use super::emitter::Emitter;
use super::fault::FaultKind;
use crate::ir::elementary::Kind;
use crate::ir::{ElementaryType, Expr, LocalId, Place, Step, Storage};
use crate::syntax::Span;

/// Register of the running instance's address.
const INSTANCE: LocalId = LocalId(0);

fn argument(offset: u64, ty: ElementaryType) -> MemArg {
    MemArg { offset, align: ty.size().trailing_zeros(), memory_index: 0 }
}

impl Emitter<'_, '_> {
    /// Pushes an address; the place lies at the returned offset from it.
    pub(super) fn address(&mut self, place: &Place) -> u64 {
        let (mut offset, mut pushed) = match place.storage {
            Storage::Absolute(offset) => (u64::from(offset), false),
            Storage::Located(location) => (u64::from(self.shared.areas.offset(location)), false),
            Storage::Instance(offset) => {
                self.get(INSTANCE);
                (u64::from(offset), true)
            }
            Storage::InstancePointer(offset) => {
                self.get(INSTANCE);
                self.emit(Instruction::I32Load(argument(u64::from(offset), ElementaryType::Udint)));
                (0, true)
            }
            Storage::AbsolutePointer(offset) => {
                self.emit(Instruction::I32Const(0));
                self.emit(Instruction::I32Load(argument(u64::from(offset), ElementaryType::Udint)));
                (0, true)
            }
            Storage::RegisterPointer(register) => {
                self.get(register);
                (0, true)
            }
            // A register has no address; the checker gives it memory where one is needed.
            Storage::Register(_) | Storage::Referred => (0, false),
        };
        for step in &place.steps {
            match step {
                Step::Offset(further) => offset += u64::from(*further),
                Step::Pointer { address, target } => {
                    self.pointer(address, *target, place.span);
                    pushed = true;
                }
                Step::Open { description, indices, stride } => {
                    self.open_element(description, indices, *stride, place.span);
                    self.emit(Instruction::I32Add);
                }
                Step::Index { index, low, count, stride } => {
                    self.index(index, *low, *count, *stride, place.span);
                    if pushed {
                        self.emit(Instruction::I32Add);
                    }
                    pushed = true;
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
        let offset = self.address(place);
        if offset > 0 {
            self.emit(Instruction::I32Const(offset as i32));
            self.emit(Instruction::I32Add);
        }
    }

    /// Pushes `(index - low) * stride`. Below `low` the difference wraps to a number that no
    /// array's count reaches, so one comparison checks both bounds.
    fn index(&mut self, index: &Expr, low: i64, count: u32, stride: u32, span: Span) {
        let ty = self.held_as(index.ty);
        self.expression(index);
        let wide = ty.size() == 8 || ty == ElementaryType::Udint;
        let held = super::emitter::value_type(if wide { ElementaryType::Lint } else { ty });
        if ty == ElementaryType::Udint {
            self.emit(Instruction::I64ExtendI32U);
        }
        let difference = self.scratch(held);
        if wide {
            self.emit(Instruction::I64Const(low));
            self.emit(Instruction::I64Sub);
            self.tee(difference);
            self.emit(Instruction::I64Const(i64::from(count)));
            self.emit(Instruction::I64GeU);
        } else {
            self.emit(Instruction::I32Const(low as i32));
            self.emit(Instruction::I32Sub);
            self.tee(difference);
            self.emit(Instruction::I32Const(count as i32));
            self.emit(Instruction::I32GeU);
        }
        self.fault_if(FaultKind::IndexOutOfRange, span);
        self.get(difference);
        if wide {
            self.emit(Instruction::I32WrapI64);
        }
        self.release(difference);
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
            return;
        }
        if let Storage::Register(register) = place.storage {
            self.get(register);
            return;
        }
        let argument = argument(self.address(place), ty);
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
            return;
        }
        if let Storage::Register(register) = place.storage {
            value(self);
            self.set(register);
            return;
        }
        let argument = argument(self.address(place), ty);
        value(self);
        self.emit(match (ty.kind(), ty.size()) {
            (Kind::Real, 4) => Instruction::F32Store(argument),
            (Kind::Real, _) => Instruction::F64Store(argument),
            (_, 1) => Instruction::I32Store8(argument),
            (_, 2) => Instruction::I32Store16(argument),
            (_, 4) => Instruction::I32Store(argument),
            _ => Instruction::I64Store(argument),
        });
    }
}
