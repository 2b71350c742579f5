//! Elements of arrays whose bounds come with them (3rd ed. 6.5.3).

use wasm_encoder::{Instruction, MemArg, ValType};

use super::emitter::{Emitter, value_type};
use crate::compile::analyse::Register;
use crate::compile::fault::FaultKind;
use onescan_iec::ir::types::OPEN_BOUNDS;
use onescan_iec::ir::{Expr, Place};
use onescan_iec::syntax::Span;

fn bound(offset: u64) -> MemArg {
    MemArg { offset, align: 2, memory_index: 0 }
}

impl Emitter<'_, '_> {
    /// Pushes how far from the array's begin the element lies. The last index runs fastest.
    pub(crate) fn open_element(&mut self, description: &Place, indices: &[Expr], stride: u32, span: Span) {
        let (bounds, number) = (self.scratch(ValType::I32), self.scratch(ValType::I64));
        self.full_address(description);
        self.set(bounds);
        self.emit(Instruction::I64Const(0));
        self.set(number);
        for (offset, index) in (4_u64..).step_by(OPEN_BOUNDS as usize).zip(indices) {
            self.open_index(bounds, number, offset, index, span);
        }
        self.get(number);
        self.emit(Instruction::I32WrapI64);
        self.emit(Instruction::I32Const(stride.cast_signed()));
        self.emit(Instruction::I32Mul);
        self.release(number);
        self.release(bounds);
    }

    /// `number` becomes `number * count + (index - low)`; a fault unless `index - low < count`. Both
    /// bounds are of 32 bits, so nothing overflows in 64 that passes the comparison.
    fn open_index(&mut self, bounds: Register, number: Register, offset: u64, index: &Expr, span: Span) {
        let (count, difference) = (self.scratch(ValType::I64), self.scratch(ValType::I64));
        self.get(bounds);
        self.emit(Instruction::I64Load32S(bound(offset + 4)));
        self.get(bounds);
        self.emit(Instruction::I64Load32S(bound(offset)));
        self.emit(Instruction::I64Sub);
        self.emit(Instruction::I64Const(1));
        self.emit(Instruction::I64Add);
        self.set(count);
        let ty = self.held_as(index.ty);
        self.expression(index);
        if value_type(ty) == ValType::I32 {
            let signed = ty.is_signed();
            self.emit(if signed { Instruction::I64ExtendI32S } else { Instruction::I64ExtendI32U });
        }
        self.get(bounds);
        self.emit(Instruction::I64Load32S(bound(offset)));
        self.emit(Instruction::I64Sub);
        self.tee(difference);
        self.get(count);
        self.emit(Instruction::I64GeU);
        self.fault_if(FaultKind::IndexOutOfRange, span);
        self.get(number);
        self.get(count);
        self.emit(Instruction::I64Mul);
        self.get(difference);
        self.emit(Instruction::I64Add);
        self.set(number);
        self.release(difference);
        self.release(count);
    }
}
