//! Values that take some bits of a whole (3rd ed. Table 17, 2nd ed. Table 15).

use wasm_encoder::{Instruction, MemArg, ValType};

use super::emitter::{Emitter, value_type};
use crate::compile::analyse::Register;
use onescan_iec::ir::{ElementaryType, Part, Place, Storage};

/// The bits of a value of this type, at the lower end.
fn mask(ty: ElementaryType) -> u64 {
    match ty {
        ElementaryType::Bool => 1,
        _ => u64::MAX >> (64 - ty.size() * 8),
    }
}

impl Emitter<'_, '_> {
    /// Pushes the bits as a value of `ty`.
    pub(crate) fn load_part(&mut self, place: &Place, part: Part, ty: ElementaryType) {
        if let Storage::Register(register) = place.storage {
            self.get(self.register(register));
        } else {
            let offset = self.address(place);
            self.emit(Instruction::I32Load8U(byte(offset)));
        }
        let wide = value_type(part.whole) == ValType::I64;
        if part.shift > 0 {
            self.bits(wide, u64::from(part.shift));
            self.emit(if wide { Instruction::I64ShrU } else { Instruction::I32ShrU });
        }
        if wide {
            self.emit(Instruction::I32WrapI64);
        }
        if ty.size() < 4 {
            self.bits(false, mask(ty));
            self.emit(Instruction::I32And);
        }
    }

    /// Puts what `value` pushes, one of `ty`, in the place of the bits; the others stay. They are
    /// loaded last, as the value may be that of a function that changes them.
    pub(crate) fn store_part(&mut self, place: &Place, part: Part, ty: ElementaryType, value: impl FnOnce(&mut Self)) {
        let wide = value_type(part.whole) == ValType::I64;
        let new = self.scratch(value_type(ty));
        if let Storage::Register(register) = place.storage {
            let register = self.register(register);
            value(self);
            self.set(new);
            self.get(register);
            self.joined(part, wide, ty, new);
            self.wrap(part.whole);
            self.set(register);
        } else {
            let address = self.scratch(ValType::I32);
            let offset = self.address(place);
            self.set(address);
            value(self);
            self.set(new);
            self.get(address);
            self.get(address);
            self.emit(Instruction::I32Load8U(byte(offset)));
            self.joined(part, wide, ty, new);
            self.emit(Instruction::I32Store8(byte(offset)));
            self.release(address);
        }
        self.release(new);
    }

    /// The whole on the stack with the bits of `new` in their place.
    fn joined(&mut self, part: Part, wide: bool, ty: ElementaryType, new: Register) {
        self.bits(wide, !(mask(ty) << part.shift));
        self.emit(if wide { Instruction::I64And } else { Instruction::I32And });
        self.get(new);
        if wide {
            self.emit(Instruction::I64ExtendI32U);
        }
        self.bits(wide, u64::from(part.shift));
        self.emit(if wide { Instruction::I64Shl } else { Instruction::I32Shl });
        self.emit(if wide { Instruction::I64Or } else { Instruction::I32Or });
    }

    fn bits(&mut self, wide: bool, bits: u64) {
        self.emit(if wide { Instruction::I64Const(bits as i64) } else { Instruction::I32Const(bits as i32) });
    }
}

fn byte(offset: u64) -> MemArg {
    MemArg { offset, align: 0, memory_index: 0 }
}
