//! Vendors' functions on bytes at addresses.

use wasm_encoder::{Instruction, MemArg, ValType};

use super::emitter::Emitter;
use crate::compile::analyse::Register;
use crate::compile::fault::FaultKind;
use onescan_iec::ir::{Expr, MemoryFunction};
use onescan_iec::syntax::Span;

const BYTE: MemArg = MemArg { offset: 0, align: 0, memory_index: 0 };

impl Emitter<'_, '_> {
    /// Pushes what the function gives. All that it touches must lie in memory.
    pub(crate) fn memory_function(&mut self, function: MemoryFunction, operands: &[Expr], span: Span) {
        let [first, second, count] = operands else { return self.impossible(span) };
        let registers = [(); 3].map(|()| self.scratch(ValType::I32));
        let [left, right, length] = registers;
        for (operand, register) in [(first, left), (second, right), (count, length)] {
            self.expression(operand);
            self.set(register);
        }
        self.require_memory(left, length, span);
        if function != MemoryFunction::Fill {
            self.require_memory(right, length, span);
        }
        match function {
            MemoryFunction::Compare => self.compare_memory(left, right, length),
            MemoryFunction::Copy | MemoryFunction::Fill => {
                for register in registers {
                    self.get(register);
                }
                self.emit(match function {
                    MemoryFunction::Fill => Instruction::MemoryFill(0),
                    _ => Instruction::MemoryCopy { src_mem: 0, dst_mem: 0 },
                });
                self.changed(None);
                self.get(length);
            }
        }
        for register in registers {
            self.release(register);
        }
    }

    /// A fault unless `length` bytes at `address`, which is not NULL, lie in memory.
    fn require_memory(&mut self, address: Register, length: Register, span: Span) {
        self.get(address);
        self.emit(Instruction::I32Eqz);
        self.fault_if(FaultKind::NullReference, span);
        for register in [address, length] {
            self.get(register);
            self.emit(Instruction::I64ExtendI32U);
        }
        self.emit(Instruction::I64Add);
        self.emit(Instruction::I64Const(i64::from(self.shared().memory_size())));
        self.emit(Instruction::I64GtU);
        self.fault_if(FaultKind::InvalidPointer, span);
    }

    /// Pushes how the first bytes that differ are ordered.
    fn compare_memory(&mut self, left: Register, right: Register, length: Register) {
        let order = self.scratch(ValType::I32);
        self.emit(Instruction::I32Const(0));
        self.set(order);
        let end = self.open_block();
        let turn = self.open_loop();
        self.get(length);
        self.emit(Instruction::I32Eqz);
        self.branch_if(end);
        for comparison in [Instruction::I32GtU, Instruction::I32LtU] {
            for register in [left, right] {
                self.get(register);
                self.emit(Instruction::I32Load8U(BYTE));
            }
            self.emit(comparison);
        }
        self.emit(Instruction::I32Sub);
        self.tee(order);
        self.branch_if(end);
        for (register, step) in [(left, 1), (right, 1), (length, -1)] {
            self.get(register);
            self.emit(Instruction::I32Const(step));
            self.emit(Instruction::I32Add);
            self.set(register);
        }
        self.branch(turn);
        self.close();
        self.close();
        self.get(order);
        self.release(order);
    }
}
