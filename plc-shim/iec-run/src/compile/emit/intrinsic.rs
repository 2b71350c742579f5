//! Standard functions that are not made of other expressions.

use wasm_encoder::{Instruction, ValType};

use super::emitter::{Emitter, value_type};
use crate::compile::analyse::Register;
use crate::compile::fault::FaultKind;
use crate::compile::host;
use onescan_iec::ir::{Binary, ElementaryType, Expr, ExprKind, Intrinsic, Value};
use onescan_iec::syntax::Span;

/// True if the function has so many operands; the checker gives it no others.
fn takes(kind: Intrinsic, operands: usize) -> bool {
    match kind {
        Intrinsic::Abs
        | Intrinsic::Sqrt
        | Intrinsic::Ln
        | Intrinsic::Log
        | Intrinsic::Exp
        | Intrinsic::Sin
        | Intrinsic::Cos
        | Intrinsic::Tan
        | Intrinsic::Asin
        | Intrinsic::Acos
        | Intrinsic::Atan
        | Intrinsic::Fraction
        | Intrinsic::SwapBytes
        | Intrinsic::Reinterpret => operands == 1,
        Intrinsic::Atan2
        | Intrinsic::Power
        | Intrinsic::Max
        | Intrinsic::Min
        | Intrinsic::ShiftLeft
        | Intrinsic::ShiftRight
        | Intrinsic::RotateLeft
        | Intrinsic::RotateRight
        | Intrinsic::FloorRemainder
        | Intrinsic::FloorMultiple => operands == 2,
        Intrinsic::Select | Intrinsic::Memory(_) => operands == 3,
        Intrinsic::Multiplex => operands >= 2,
    }
}

impl Emitter<'_, '_> {
    pub(crate) fn intrinsic(&mut self, kind: Intrinsic, operands: &[Expr], whole: &Expr) {
        let ty = self.held_as(whole.ty);
        if !takes(kind, operands.len()) {
            return self.impossible(whole.span);
        }
        match kind {
            Intrinsic::Abs => self.absolute(operands, ty, whole.span),
            Intrinsic::Sqrt => {
                self.all(operands);
                let single = ty == ElementaryType::Real;
                self.emit(if single { Instruction::F32Sqrt } else { Instruction::F64Sqrt });
            }
            Intrinsic::Max | Intrinsic::Min if self.scope().types().text(whole.ty).is_some() => {
                self.text_extreme(operands, kind == Intrinsic::Max, whole.span);
            }
            Intrinsic::Max | Intrinsic::Min => self.extreme(kind, operands, ty, whole.span),
            Intrinsic::Select => self.select(operands, ty),
            Intrinsic::Multiplex => self.multiplex(operands, ty, whole.span),
            Intrinsic::ShiftLeft | Intrinsic::ShiftRight | Intrinsic::RotateLeft | Intrinsic::RotateRight => {
                self.shift(kind, operands, ty);
            }
            Intrinsic::Reinterpret => {
                if let [operand] = operands {
                    self.settled(operand);
                    self.widen_to_bits(self.held_as(operand.ty));
                    self.narrow_from_bits(ty);
                }
            }
            Intrinsic::Memory(function) => self.memory_function(function, operands, whole.span),
            Intrinsic::SwapBytes => self.swapped_bytes(operands, ty),
            Intrinsic::Fraction => self.fraction(operands, ty),
            Intrinsic::FloorRemainder | Intrinsic::FloorMultiple => self.floored(kind, operands),
            _ => {
                self.all(operands);
                match host::index(kind, ty == ElementaryType::Real) {
                    Some(index) => self.emit(Instruction::Call(index)),
                    None => self.impossible(whole.span),
                }
            }
        }
    }

    fn all_settled(&mut self, operands: &[Expr]) {
        for operand in operands {
            self.settled(operand);
        }
    }

    fn all(&mut self, operands: &[Expr]) {
        for operand in operands {
            self.expression(operand);
        }
    }

    /// Evaluates the operands into registers.
    fn in_registers(&mut self, operands: &[Expr]) -> Vec<Register> {
        let mut registers = Vec::with_capacity(operands.len());
        for operand in operands {
            let held = value_type(self.held_as(operand.ty));
            self.expression(operand);
            let register = self.scratch(held);
            self.set(register);
            registers.push(register);
        }
        registers
    }

    fn release_all(&mut self, registers: Vec<Register>) {
        for register in registers {
            self.release(register);
        }
    }

    fn absolute(&mut self, operands: &[Expr], ty: ElementaryType, span: Span) {
        match value_type(ty) {
            ValType::F32 => {
                self.all_settled(operands);
                self.emit(Instruction::F32Abs);
            }
            ValType::F64 => {
                self.all_settled(operands);
                self.emit(Instruction::F64Abs);
            }
            _ if !ty.is_signed() => self.all(operands),
            _ => {
                let registers = self.in_registers(operands);
                if let [value] = registers[..] {
                    self.constant(ty, Value::Int(0));
                    self.get(value);
                    self.operation(Binary::Subtract, ty, span);
                    self.get(value);
                    self.get(value);
                    self.constant(ty, Value::Int(0));
                    self.operation(Binary::Less, ty, span);
                    self.emit(Instruction::Select);
                }
                self.release_all(registers);
            }
        }
    }

    fn extreme(&mut self, kind: Intrinsic, operands: &[Expr], ty: ElementaryType, span: Span) {
        let max = kind == Intrinsic::Max;
        match value_type(ty) {
            ValType::F32 => {
                self.all(operands);
                self.emit(if max { Instruction::F32Max } else { Instruction::F32Min });
            }
            ValType::F64 => {
                self.all(operands);
                self.emit(if max { Instruction::F64Max } else { Instruction::F64Min });
            }
            _ => {
                let registers = self.in_registers(operands);
                if let [left, right] = registers[..] {
                    for register in [left, right, left, right] {
                        self.get(register);
                    }
                    self.operation(if max { Binary::Greater } else { Binary::Less }, ty, span);
                    self.emit(Instruction::Select);
                }
                self.release_all(registers);
            }
        }
    }

    /// Both values are evaluated, as the arguments of any function are.
    fn select(&mut self, operands: &[Expr], ty: ElementaryType) {
        let registers = self.in_registers(operands);
        if let [selector, if_false, if_true] = registers[..] {
            self.get(if_true);
            self.get(if_false);
            self.get(selector);
            self.emit(Instruction::TypedSelect(value_type(ty)));
        }
        self.release_all(registers);
    }

    fn multiplex(&mut self, operands: &[Expr], ty: ElementaryType, span: Span) {
        let registers = self.in_registers(operands);
        if let [selector, values @ .., last] = &registers[..] {
            self.get(*selector);
            self.emit(Instruction::I64Const(values.len() as i64));
            self.emit(Instruction::I64GtU);
            self.fault_if(FaultKind::SelectorOutOfRange, span);
            for (index, value) in values.iter().enumerate() {
                self.get(*value);
                self.get(*last);
                self.get(*selector);
                self.emit(Instruction::I64Const(index as i64));
                self.emit(Instruction::I64Eq);
                self.emit(Instruction::TypedSelect(value_type(ty)));
                self.set(*last);
            }
            self.get(*last);
        }
        self.release_all(registers);
    }

    /// 2nd ed. Table 25. A count of the type's width or more shifts everything out; a negative
    /// one, which is an error there, does too; of a signed integer, which only vendors shift, the sign is left. Rotation takes the count modulo the width.
    fn shift(&mut self, kind: Intrinsic, operands: &[Expr], ty: ElementaryType) {
        if let [value, Expr { kind: ExprKind::Constant(Value::Int(count)), .. }] = operands
            && matches!(kind, Intrinsic::ShiftLeft | Intrinsic::ShiftRight)
        {
            self.shift_by_constant(kind == Intrinsic::ShiftLeft, value, *count, ty);
            return;
        }
        let registers = self.in_registers(operands);
        if let [value, count] = registers[..] {
            let bits = if ty == ElementaryType::Bool { 1 } else { i64::from(ty.size()) * 8 };
            match kind {
                Intrinsic::ShiftLeft | Intrinsic::ShiftRight => {
                    self.shifted(value, count, ty, kind == Intrinsic::ShiftLeft);
                    self.shifted_out(value, ty);
                    self.get(count);
                    self.emit(Instruction::I64Const(bits));
                    self.emit(Instruction::I64LtU);
                    self.emit(Instruction::Select);
                }
                _ => {
                    self.rotation_count(count, bits);
                    let left = kind == Intrinsic::RotateLeft;
                    self.shifted(value, count, ty, left);
                    self.emit(Instruction::I64Const(bits));
                    self.get(count);
                    self.emit(Instruction::I64Sub);
                    self.rotation_count_on_stack(count, bits);
                    self.shifted(value, count, ty, !left);
                    let wide = ty.size() == 8;
                    self.emit(if wide { Instruction::I64Or } else { Instruction::I32Or });
                }
            }
        }
        self.release_all(registers);
    }

    fn shift_by_constant(&mut self, left: bool, value: &Expr, count: i128, ty: ElementaryType) {
        let bits = if ty == ElementaryType::Bool { 1 } else { i128::from(ty.size()) * 8 };
        self.expression(value);
        let inside = (0..bits).contains(&count);
        // What is left of a signed integer that is shifted out is its sign.
        let count = if inside || !ty.is_signed() { count } else { bits - 1 };
        if !inside && !ty.is_signed() {
            self.emit(Instruction::Drop);
            self.constant(ty, Value::Int(0));
        } else if ty.size() == 8 {
            self.emit(Instruction::I64Const(count as i64));
            self.emit(shift_instruction(ty, left));
        } else if count > 0 {
            self.emit(Instruction::I32Const(count as i32));
            self.emit(shift_instruction(ty, left));
            self.wrap(ty);
        }
    }

    /// Pushes what is left of a value whose bits are all shifted out.
    fn shifted_out(&mut self, value: Register, ty: ElementaryType) {
        if !ty.is_signed() {
            self.constant(ty, Value::Int(0));
            return;
        }
        self.get(value);
        let sign = i64::from(ty.size()) * 8 - 1;
        self.emit(if ty.size() == 8 { Instruction::I64Const(sign) } else { Instruction::I32Const(sign as i32) });
        self.emit(shift_instruction(ty, false));
    }

    /// Of 64 bit numbers; the divisor is a constant greater than 0.
    fn floored(&mut self, kind: Intrinsic, operands: &[Expr]) {
        let registers = self.in_registers(operands);
        if let [value, divisor] = registers[..] {
            let rest = self.scratch(ValType::I64);
            self.get(value);
            self.get(value);
            self.get(divisor);
            self.emit(Instruction::I64RemS);
            self.tee(rest);
            self.get(divisor);
            self.emit(Instruction::I64Const(0));
            self.get(rest);
            self.emit(Instruction::I64Const(0));
            self.emit(Instruction::I64LtS);
            self.emit(Instruction::Select);
            self.emit(Instruction::I64Add);
            self.set(rest);
            if kind == Intrinsic::FloorRemainder {
                self.emit(Instruction::Drop);
                self.get(rest);
            } else {
                self.get(rest);
                self.emit(Instruction::I64Sub);
            }
            self.release(rest);
        }
        self.release_all(registers);
    }

    fn rotation_count(&mut self, count: Register, bits: i64) {
        self.get(count);
        self.rotation_count_on_stack(count, bits);
    }

    /// Widths are powers of two, so that the remainder is a mask.
    fn rotation_count_on_stack(&mut self, count: Register, bits: i64) {
        self.emit(Instruction::I64Const(bits - 1));
        self.emit(Instruction::I64And);
        self.set(count);
    }

    /// Pushes the value shifted by the low bits of `count`.
    fn shifted(&mut self, value: Register, count: Register, ty: ElementaryType, left: bool) {
        self.get(value);
        self.get(count);
        if ty.size() == 8 {
            self.emit(shift_instruction(ty, left));
            return;
        }
        self.emit(Instruction::I32WrapI64);
        self.emit(shift_instruction(ty, left));
        self.wrap(ty);
    }
}

/// Bit strings are held without a sign, so that zeros move in from the left.
fn shift_instruction(ty: ElementaryType, left: bool) -> Instruction<'static> {
    match (left, ty.size() == 8, ty.is_signed()) {
        (true, true, _) => Instruction::I64Shl,
        (true, false, _) => Instruction::I32Shl,
        (false, true, true) => Instruction::I64ShrS,
        (false, true, false) => Instruction::I64ShrU,
        (false, false, true) => Instruction::I32ShrS,
        (false, false, false) => Instruction::I32ShrU,
    }
}
