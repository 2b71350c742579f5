//! References and pointers: checked before what they lead to is touched.

use wasm_encoder::{Instruction, ValType};

use super::emitter::Emitter;
use crate::compile::fault::FaultKind;
use onescan_iec::ir::{Expr, TypeId};
use onescan_iec::syntax::Span;

impl Emitter<'_, '_> {
    /// Pushes the address that a reference has: not NULL, and `target` ends in memory.
    pub(crate) fn referred(&mut self, reference: &Expr, target: TypeId, span: Span) {
        self.referred_bytes(reference, self.size_of(target), span);
    }

    /// The same, so many bytes of the target. Of an array that is indexed none need be there: `pt^[0]` of a pointer to
    /// a great array is the element alone, and [`Self::ends_in_memory`] looks at that.
    pub(crate) fn referred_bytes(&mut self, reference: &Expr, bytes: u32, span: Span) {
        let last = self.shared().memory_size().saturating_sub(bytes);
        let address = self.scratch(ValType::I32);
        self.expression(reference);
        self.tee(address);
        self.emit(Instruction::I32Eqz);
        self.fault_if(FaultKind::NullReference, span);
        self.get(address);
        self.emit(Instruction::I32Const(last.cast_signed()));
        self.emit(Instruction::I32GtU);
        self.fault_if(FaultKind::InvalidPointer, span);
        self.get(address);
        self.release(address);
    }

    /// Checks that so many bytes from the address on the stack end in memory, and leaves it there. It has been made of
    /// one in memory and of positions in a type, which no 32 bits overflow.
    pub(crate) fn ends_in_memory(&mut self, bytes: u64, span: Span) {
        let room = u64::from(self.shared().memory_size()).saturating_sub(bytes);
        let last = u32::try_from(room).unwrap_or(u32::MAX);
        let address = self.scratch(ValType::I32);
        self.tee(address);
        self.emit(Instruction::I32Const(last.cast_signed()));
        self.emit(Instruction::I32GtU);
        self.fault_if(FaultKind::InvalidPointer, span);
        self.get(address);
        self.release(address);
    }
}
