//! Character strings: calls of the host, which works on the PLC's memory.

use wasm_encoder::{Instruction, MemArg, ValType};

use super::emitter::{Emitter, value_type};
use crate::compile::text_host::{LONG_TIME, TextImport};
use onescan_iec::dialect::StringMemory;
use onescan_iec::ir::text::{Edit, TextCall, TextFunction, TextShape};
use onescan_iec::ir::{ElementaryType, Expr};
use onescan_iec::syntax::Span;

/// What a call of the host costs, in instructions.
const CALL_COST: u64 = 20;

/// Number of a type in calls of the host.
fn type_number(ty: ElementaryType) -> i32 {
    ty as i32
}

impl Emitter<'_, '_> {
    /// Pushes what the function gives: a number, or the address of its target.
    pub(crate) fn text_call(&mut self, call: &TextCall, whole: &Expr) {
        match call.function {
            TextFunction::Length => self.text_length(&call.operands, whole.span),
            TextFunction::Compare => self.text_pair(&call.operands, TextImport::Compare),
            TextFunction::Find => self.text_pair(&call.operands, TextImport::Find),
            TextFunction::Edit(edit) => self.edit(edit, call),
            TextFunction::Format(ty) => self.format(ty, type_number(ty), call),
            TextFunction::FormatLongTime => self.format(ElementaryType::Ltime, LONG_TIME, call),
            TextFunction::Parse(ty) => {
                self.emit(Instruction::I32Const(type_number(ty)));
                self.text_operands(&call.operands);
                self.host(TextImport::Parse);
                self.narrow_from_bits(self.held_as(whole.ty));
            }
        }
    }

    /// The host pays for long strings from the budget.
    fn host(&mut self, import: TextImport) {
        self.put_budget_back();
        self.emit(Instruction::Call(import.index()));
        self.charge(CALL_COST);
        self.take_budget();
    }

    /// The target of a function that makes a string has been written.
    fn text_made(&mut self, call: &TextCall) {
        let extent = call.target.as_ref().and_then(|target| self.extent(target));
        self.changed(extent);
    }

    /// The shape of a string, which the checker has seen to be one.
    fn shape_of(&mut self, expr: &Expr) -> TextShape {
        self.scope().types().text(expr.ty).unwrap_or_else(|| {
            self.impossible(expr.span);
            TextShape { wide: false, capacity: 0, memory: StringMemory::Counted }
        })
    }

    /// Pushes address and shape of each string.
    fn text_operands(&mut self, operands: &[Expr]) {
        for operand in operands {
            self.expression(operand);
            let shape = self.shape_of(operand);
            self.emit(Instruction::I32Const(shape.code()));
        }
    }

    fn text_pair(&mut self, operands: &[Expr], import: TextImport) {
        self.text_operands(operands);
        self.host(import);
    }

    /// The count in use; never more than there is room for, whatever stands in memory.
    fn text_length(&mut self, operands: &[Expr], span: Span) {
        let [operand] = operands else { return self.impossible(span) };
        let shape = self.shape_of(operand);
        if shape.memory == StringMemory::ZeroTerminated {
            self.text_operands(operands);
            return self.host(TextImport::Length);
        }
        let capacity = shape.capacity.cast_signed();
        let used = self.scratch(ValType::I32);
        self.expression(operand);
        self.emit(Instruction::I32Load16U(MemArg { offset: 0, align: 0, memory_index: 0 }));
        self.tee(used);
        self.emit(Instruction::I32Const(capacity));
        self.get(used);
        self.emit(Instruction::I32Const(capacity));
        self.emit(Instruction::I32LtU);
        self.emit(Instruction::Select);
        self.release(used);
    }

    fn edit(&mut self, edit: Edit, call: &TextCall) {
        self.emit(Instruction::I32Const(edit as i32));
        let (strings, numbers) = call.operands.split_at(edit.strings().min(call.operands.len()));
        self.text_operands(strings);
        for _ in strings.len()..2 {
            self.emit(Instruction::I32Const(0));
            self.emit(Instruction::I32Const(0));
        }
        let mut numbers = numbers.iter();
        for present in [edit.has_length(), edit.has_position()] {
            match if present { numbers.next() } else { None } {
                Some(number) => self.expression(number),
                None => self.emit(Instruction::I64Const(0)),
            }
        }
        self.text_target(call);
        self.host(TextImport::Edit);
        self.text_made(call);
    }

    fn text_target(&mut self, call: &TextCall) {
        let Some(target) = &call.target else { return };
        self.full_address(target);
        let shape = self.scope().types().text(target.ty);
        self.emit(Instruction::I32Const(shape.map_or(0, TextShape::code)));
    }

    /// `form` is the number of the type, or what stands for another text of its values.
    fn format(&mut self, ty: ElementaryType, form: i32, call: &TextCall) {
        self.emit(Instruction::I32Const(form));
        for operand in &call.operands {
            self.settled(operand);
        }
        self.widen_to_bits(ty);
        self.text_target(call);
        self.host(TextImport::Format);
        self.text_made(call);
    }

    /// Widens the value on the stack to 64 bits.
    pub(crate) fn widen_to_bits(&mut self, ty: ElementaryType) {
        match value_type(ty) {
            ValType::F32 => {
                self.emit(Instruction::I32ReinterpretF32);
                self.emit(Instruction::I64ExtendI32U);
            }
            ValType::F64 => self.emit(Instruction::I64ReinterpretF64),
            ValType::I64 => {}
            _ if ty.is_signed() => self.emit(Instruction::I64ExtendI32S),
            _ => self.emit(Instruction::I64ExtendI32U),
        }
    }

    /// The other way round; the bits are those of a value of the type.
    pub(crate) fn narrow_from_bits(&mut self, ty: ElementaryType) {
        match value_type(ty) {
            ValType::F32 => {
                self.emit(Instruction::I32WrapI64);
                self.emit(Instruction::F32ReinterpretI32);
            }
            ValType::F64 => self.emit(Instruction::F64ReinterpretI64),
            ValType::I64 => {}
            _ => self.emit(Instruction::I32WrapI64),
        }
    }

    /// The greater or lesser of two strings: the address of one of them (2nd ed. Table 27).
    pub(crate) fn text_extreme(&mut self, operands: &[Expr], greatest: bool, span: Span) {
        let [left, right] = operands else { return self.impossible(span) };
        let (first, second) = (self.scratch(ValType::I32), self.scratch(ValType::I32));
        let (left_code, right_code) = (self.shape_of(left).code(), self.shape_of(right).code());
        self.expression(left);
        self.set(first);
        self.expression(right);
        self.set(second);
        for register in [first, second, first] {
            self.get(register);
        }
        self.emit(Instruction::I32Const(left_code));
        self.get(second);
        self.emit(Instruction::I32Const(right_code));
        self.host(TextImport::Compare);
        self.emit(Instruction::I32Const(0));
        self.emit(if greatest { Instruction::I32GtS } else { Instruction::I32LtS });
        self.emit(Instruction::Select);
        self.release(first);
        self.release(second);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_host_knows_each_form_by_its_number() {
        let numbers = Edit::ALL.iter().map(|edit| *edit as usize);
        assert!(numbers.eq(0..Edit::ALL.len()));
    }
}
