//! Loads and stores of elementary values.

use wasm_encoder::{Instruction, MemArg};

use super::Emitter;
use crate::compile::analyse::{Address, Base};
use onescan_iec::ir::ElementaryType;
use onescan_iec::ir::elementary::Kind;

fn argument(offset: u64, ty: ElementaryType) -> MemArg {
    MemArg { offset, align: ty.size().trailing_zeros(), memory_index: 0 }
}

impl Emitter<'_, '_> {
    /// Pushes what stands in memory.
    pub(super) fn load_from(&mut self, address: Address, ty: ElementaryType) {
        self.push_base(address.base);
        self.load_instruction(u64::from(address.offset), ty);
    }

    /// Pushes what an address counts from.
    pub(crate) fn push_base(&mut self, base: Base) {
        match base {
            Base::Memory => self.emit(Instruction::I32Const(0)),
            Base::Register(register) => self.get(register),
        }
    }

    /// Pushes an address as a number.
    pub(crate) fn push_address(&mut self, address: Address) {
        match address.base {
            Base::Memory => self.emit(Instruction::I32Const(address.offset as i32)),
            Base::Register(register) => {
                self.get(register);
                if address.offset > 0 {
                    self.emit(Instruction::I32Const(address.offset as i32));
                    self.emit(Instruction::I32Add);
                }
            }
        }
    }

    /// Replaces the address on the stack by the value `offset` bytes behind it.
    pub(crate) fn load_instruction(&mut self, offset: u64, ty: ElementaryType) {
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

    /// Puts the value on the stack `offset` bytes behind the address below it.
    pub(crate) fn store_instruction(&mut self, offset: u64, ty: ElementaryType) {
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
}
