//! References and pointers: checked before what they lead to is touched.

use wasm_encoder::{Instruction, ValType};

use super::emitter::Emitter;
use crate::compile::fault::FaultKind;
use crate::ir::{Expr, TypeId};
use crate::syntax::Span;

impl Emitter<'_, '_> {
    /// Pushes the address that a reference has: not NULL, and `target` ends in memory.
    pub(crate) fn referred(&mut self, reference: &Expr, target: TypeId, span: Span) {
        let last = self.shared().memory_size().saturating_sub(self.size_of(target));
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
}
