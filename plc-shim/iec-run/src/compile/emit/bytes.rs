//! The bytes and the fraction of a number.

use wasm_encoder::{Instruction, ValType};

use super::emitter::{Emitter, value_type};
use crate::compile::analyse::Register;
use onescan_iec::ir::{ElementaryType, Expr};

impl Emitter<'_, '_> {
    /// 3rd ed. Table 37. All eight bytes of a 64 bit number are reversed; those of the value then stand in front.
    pub(crate) fn swapped_bytes(&mut self, operands: &[Expr], ty: ElementaryType) {
        for operand in operands {
            self.expression(operand);
        }
        self.widen_to_bits(ty);
        let number = self.scratch(ValType::I64);
        self.set(number);
        self.exchange(number, 8, 0x00ff_00ff_00ff_00ff);
        self.exchange(number, 16, 0x0000_ffff_0000_ffff);
        self.get(number);
        self.release(number);
        self.emit(Instruction::I64Const(32));
        self.emit(Instruction::I64Rotl);
        self.emit(Instruction::I64Const(64 - i64::from(ty.size()) * 8));
        self.emit(if ty.is_signed() { Instruction::I64ShrS } else { Instruction::I64ShrU });
        self.narrow_from_bits(ty);
    }

    /// Exchanges neighbouring groups of `bits`; `mask` has the lower of each two.
    fn exchange(&mut self, number: Register, bits: i64, mask: i64) {
        self.get(number);
        self.emit(Instruction::I64Const(mask));
        self.emit(Instruction::I64And);
        self.emit(Instruction::I64Const(bits));
        self.emit(Instruction::I64Shl);
        self.get(number);
        self.emit(Instruction::I64Const(bits));
        self.emit(Instruction::I64ShrU);
        self.emit(Instruction::I64Const(mask));
        self.emit(Instruction::I64And);
        self.emit(Instruction::I64Or);
        self.set(number);
    }

    /// The number less what TRUNC makes of it; it has the number's sign.
    pub(crate) fn fraction(&mut self, operands: &[Expr], ty: ElementaryType) {
        for operand in operands {
            self.expression(operand);
        }
        let number = self.scratch(value_type(ty));
        let (truncate, subtract) = match ty {
            ElementaryType::Real => (Instruction::F32Trunc, Instruction::F32Sub),
            _ => (Instruction::F64Trunc, Instruction::F64Sub),
        };
        self.tee(number);
        self.get(number);
        self.emit(truncate);
        self.emit(subtract);
        self.release(number);
    }
}
