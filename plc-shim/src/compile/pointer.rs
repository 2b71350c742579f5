//! References and pointers: checked before what they lead to is touched.

use wasm_encoder::{BlockType, Instruction, ValType};

use super::emitter::Emitter;
use super::fault::FaultKind;
use crate::ir::{Expr, TypeId};
use crate::syntax::Span;

impl Emitter<'_, '_> {
    /// Pushes the address that a reference has, after one comparison: the address less 1 is below the
    /// last at which `target` fits, and NULL less 1 is the greatest of all.
    pub(super) fn pointer(&mut self, reference: &Expr, target: TypeId, span: Span) {
        let places = self.shared.memory_size.saturating_sub(self.shared.types.size(target));
        let address = self.scratch(ValType::I32);
        self.expression(reference);
        self.tee(address);
        self.emit(Instruction::I32Const(1));
        self.emit(Instruction::I32Sub);
        self.emit(Instruction::I32Const(places.cast_signed()));
        self.emit(Instruction::I32GeU);
        self.emit(Instruction::If(BlockType::Empty));
        self.get(address);
        self.emit(Instruction::I32Eqz);
        self.fault_if(FaultKind::NullReference, span);
        self.mark_fault(FaultKind::InvalidPointer, span);
        self.emit(Instruction::Unreachable);
        self.emit(Instruction::End);
        self.get(address);
        self.release(address);
    }
}
