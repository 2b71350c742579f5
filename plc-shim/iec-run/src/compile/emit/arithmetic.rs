//! Operators. Integers wrap at their type's width, two's complement.

use wasm_encoder::{BlockType, Instruction, ValType};

use super::emitter::{Emitter, value_type};
use crate::compile::fault::FaultKind;
use onescan_iec::ir::elementary::Kind;
use onescan_iec::ir::{Binary, ElementaryType, Expr, ExprKind, Value};
use onescan_iec::syntax::Span;

impl Emitter<'_, '_> {
    /// Cuts the `i32` on the stack to the width of `ty`.
    pub(crate) fn wrap(&mut self, ty: ElementaryType) {
        match (ty.kind(), ty.size()) {
            (Kind::Signed, 1) => self.emit(Instruction::I32Extend8S),
            (Kind::Signed, 2) => self.emit(Instruction::I32Extend16S),
            (Kind::Unsigned | Kind::Bits, 1) => self.mask(0xff),
            (Kind::Unsigned | Kind::Bits, 2) => self.mask(0xffff),
            _ => {}
        }
    }

    fn mask(&mut self, bits: i32) {
        self.emit(Instruction::I32Const(bits));
        self.emit(Instruction::I32And);
    }

    pub(crate) fn negate(&mut self, operand: &Expr) {
        let ty = self.held_as(operand.ty);
        match value_type(ty) {
            ValType::F32 => {
                self.settled(operand);
                self.emit(Instruction::F32Neg);
            }
            ValType::F64 => {
                self.settled(operand);
                self.emit(Instruction::F64Neg);
            }
            _ => {
                self.constant(ty, Value::Int(0));
                self.expression(operand);
                self.operation(Binary::Subtract, ty, operand.span);
            }
        }
    }

    pub(crate) fn complement(&mut self, operand: &Expr) {
        let ty = self.held_as(operand.ty);
        self.expression(operand);
        match (ty.kind(), ty.size()) {
            (Kind::Bool, _) => self.emit(Instruction::I32Eqz),
            (_, 8) => {
                self.emit(Instruction::I64Const(-1));
                self.emit(Instruction::I64Xor);
            }
            _ => {
                self.emit(Instruction::I32Const(-1));
                self.emit(Instruction::I32Xor);
                self.wrap(ty);
            }
        }
    }

    /// Joins the two values on the stack, both of type `ty`.
    pub(crate) fn operation(&mut self, operator: Binary, ty: ElementaryType, span: Span) {
        match value_type(ty) {
            ValType::F32 => self.single(operator, span),
            ValType::F64 => self.double(operator, span),
            ValType::I64 => self.wide(operator, ty, span),
            _ => {
                self.narrow(operator, ty, span);
                if !operator.is_comparison() {
                    self.wrap(ty);
                }
            }
        }
    }

    /// Like [`Self::operation`] where the result is known to lie in the type.
    pub(crate) fn unwrapped(&mut self, operator: Binary, ty: ElementaryType, span: Span) {
        match value_type(ty) {
            ValType::I64 => self.wide(operator, ty, span),
            _ => self.narrow(operator, ty, span),
        }
    }

    /// A binary expression; what its constants and ranges make unnecessary is left out.
    pub(crate) fn binary(&mut self, operator: Binary, left: &Expr, right: &Expr, whole: &Expr) {
        let ty = self.held_as(left.ty);
        let divides = matches!(operator, Binary::Divide | Binary::Modulo);
        self.expression(left);
        self.expression(right);
        match right.kind {
            ExprKind::Constant(Value::Int(divisor)) if divides && divisor > 0 => {
                self.by_constant(operator, left, ty);
            }
            ExprKind::Constant(Value::Lreal(divisor)) if operator == Binary::Divide && divisor != 0.0 => {
                self.emit(Instruction::F64Div);
            }
            ExprKind::Constant(Value::Real(divisor)) if operator == Binary::Divide && divisor != 0.0 => {
                self.emit(Instruction::F32Div);
            }
            _ if self.fits(operator, left, right) => self.unwrapped(operator, ty, whole.span),
            _ => self.operation(operator, ty, whole.span),
        }
    }

    /// Division by a constant greater than 0 neither traps nor leaves the type. What is never
    /// negative is divided as an unsigned number, which often is a shift.
    fn by_constant(&mut self, operator: Binary, dividend: &Expr, ty: ElementaryType) {
        let wide = ty.size() == 8;
        let signed = ty.is_signed() && self.interval(dividend).is_none_or(|(least, _)| least < 0);
        self.emit(match (operator == Binary::Divide, wide, signed) {
            (true, false, true) => Instruction::I32DivS,
            (true, false, false) => Instruction::I32DivU,
            (true, true, true) => Instruction::I64DivS,
            (true, true, false) => Instruction::I64DivU,
            (false, false, true) => Instruction::I32RemS,
            (false, false, false) => Instruction::I32RemU,
            (false, true, true) => Instruction::I64RemS,
            (false, true, false) => Instruction::I64RemU,
        });
    }

    /// Division of reals by zero is an error (2nd ed. Annex E), so it stops the PLC too.
    fn check_divisor(&mut self, zero: Instruction<'static>, held: ValType, span: Span) {
        let divisor = self.scratch(held);
        self.tee(divisor);
        self.get(divisor);
        let single = held == ValType::F32;
        self.emit(zero);
        self.emit(if single { Instruction::F32Eq } else { Instruction::F64Eq });
        self.fault_if(FaultKind::DivisionByZero, span);
        self.release(divisor);
    }

    fn single(&mut self, operator: Binary, span: Span) {
        if operator == Binary::Divide {
            let zero = Instruction::F32Const(wasm_encoder::Ieee32::new(0));
            self.check_divisor(zero, ValType::F32, span);
        }
        self.emit(match operator {
            Binary::Add => Instruction::F32Add,
            Binary::Subtract => Instruction::F32Sub,
            Binary::Multiply => Instruction::F32Mul,
            Binary::Divide | Binary::DivideAnyway => Instruction::F32Div,
            Binary::Equal => Instruction::F32Eq,
            Binary::NotEqual => Instruction::F32Ne,
            Binary::Less => Instruction::F32Lt,
            Binary::LessEqual => Instruction::F32Le,
            Binary::Greater => Instruction::F32Gt,
            Binary::GreaterEqual => Instruction::F32Ge,
            // The checker lets no other operator pass for reals.
            Binary::Modulo | Binary::And | Binary::Or | Binary::Xor => Instruction::Unreachable,
        });
    }

    fn double(&mut self, operator: Binary, span: Span) {
        if operator == Binary::Divide {
            let zero = Instruction::F64Const(wasm_encoder::Ieee64::new(0));
            self.check_divisor(zero, ValType::F64, span);
        }
        self.emit(match operator {
            Binary::Add => Instruction::F64Add,
            Binary::Subtract => Instruction::F64Sub,
            Binary::Multiply => Instruction::F64Mul,
            Binary::Divide | Binary::DivideAnyway => Instruction::F64Div,
            Binary::Equal => Instruction::F64Eq,
            Binary::NotEqual => Instruction::F64Ne,
            Binary::Less => Instruction::F64Lt,
            Binary::LessEqual => Instruction::F64Le,
            Binary::Greater => Instruction::F64Gt,
            Binary::GreaterEqual => Instruction::F64Ge,
            Binary::Modulo | Binary::And | Binary::Or | Binary::Xor => Instruction::Unreachable,
        });
    }

    fn narrow(&mut self, operator: Binary, ty: ElementaryType, span: Span) {
        let signed = ty.is_signed();
        let instruction = match operator {
            Binary::Divide => return self.divide(ty, span),
            Binary::DivideAnyway => return self.divide_anyway(ty, span),
            Binary::Modulo => return self.remainder(ty),
            Binary::Add => Instruction::I32Add,
            Binary::Subtract => Instruction::I32Sub,
            Binary::Multiply => Instruction::I32Mul,
            Binary::And => Instruction::I32And,
            Binary::Or => Instruction::I32Or,
            Binary::Xor => Instruction::I32Xor,
            Binary::Equal => Instruction::I32Eq,
            Binary::NotEqual => Instruction::I32Ne,
            Binary::Less if signed => Instruction::I32LtS,
            Binary::Less => Instruction::I32LtU,
            Binary::LessEqual if signed => Instruction::I32LeS,
            Binary::LessEqual => Instruction::I32LeU,
            Binary::Greater if signed => Instruction::I32GtS,
            Binary::Greater => Instruction::I32GtU,
            Binary::GreaterEqual if signed => Instruction::I32GeS,
            Binary::GreaterEqual => Instruction::I32GeU,
        };
        self.emit(instruction);
    }

    fn wide(&mut self, operator: Binary, ty: ElementaryType, span: Span) {
        let signed = ty.is_signed();
        let instruction = match operator {
            Binary::Divide => return self.divide(ty, span),
            Binary::DivideAnyway => return self.divide_anyway(ty, span),
            Binary::Modulo => return self.remainder(ty),
            Binary::Add => Instruction::I64Add,
            Binary::Subtract => Instruction::I64Sub,
            Binary::Multiply => Instruction::I64Mul,
            Binary::And => Instruction::I64And,
            Binary::Or => Instruction::I64Or,
            Binary::Xor => Instruction::I64Xor,
            Binary::Equal => Instruction::I64Eq,
            Binary::NotEqual => Instruction::I64Ne,
            Binary::Less if signed => Instruction::I64LtS,
            Binary::Less => Instruction::I64LtU,
            Binary::LessEqual if signed => Instruction::I64LeS,
            Binary::LessEqual => Instruction::I64LeU,
            Binary::Greater if signed => Instruction::I64GtS,
            Binary::Greater => Instruction::I64GtU,
            Binary::GreaterEqual if signed => Instruction::I64GeS,
            Binary::GreaterEqual => Instruction::I64GeU,
        };
        self.emit(instruction);
    }

    /// The smallest number divided by -1 wraps to itself; WebAssembly would trap. Division by
    /// zero traps of its own.
    fn divide(&mut self, ty: ElementaryType, span: Span) {
        let wide = ty.size() == 8;
        if !ty.is_signed() {
            self.mark_fault(FaultKind::DivisionByZero, span);
            self.emit(if wide { Instruction::I64DivU } else { Instruction::I32DivU });
            return;
        }
        let held = value_type(ty);
        let (left, right) = (self.scratch(held), self.scratch(held));
        self.set(right);
        self.set(left);
        self.get(right);
        self.constant(ty, Value::Int(-1));
        self.emit(if wide { Instruction::I64Eq } else { Instruction::I32Eq });
        self.emit(Instruction::If(BlockType::Result(held)));
        self.constant(ty, Value::Int(0));
        self.get(left);
        self.emit(if wide { Instruction::I64Sub } else { Instruction::I32Sub });
        self.emit(Instruction::Else);
        self.get(left);
        self.get(right);
        self.mark_fault(FaultKind::DivisionByZero, span);
        self.emit(if wide { Instruction::I64DivS } else { Instruction::I32DivS });
        self.emit(Instruction::End);
        self.release(left);
        self.release(right);
    }

    /// As [`Self::divide`], but 0 for a division by zero.
    fn divide_anyway(&mut self, ty: ElementaryType, span: Span) {
        let held = value_type(ty);
        let (left, right) = (self.scratch(held), self.scratch(held));
        self.set(right);
        self.set(left);
        self.get(right);
        self.emit(if ty.size() == 8 { Instruction::I64Eqz } else { Instruction::I32Eqz });
        self.emit(Instruction::If(BlockType::Result(held)));
        self.constant(ty, Value::Int(0));
        self.emit(Instruction::Else);
        self.get(left);
        self.get(right);
        self.divide(ty, span);
        self.emit(Instruction::End);
        self.release(left);
        self.release(right);
    }

    /// 2nd ed. Table 24: the result of MOD 0 is 0, otherwise `IN1 - (IN1/IN2)*IN2`.
    fn remainder(&mut self, ty: ElementaryType) {
        let wide = ty.size() == 8;
        let held = value_type(ty);
        let (left, right) = (self.scratch(held), self.scratch(held));
        self.set(right);
        self.set(left);
        self.get(right);
        self.emit(if wide { Instruction::I64Eqz } else { Instruction::I32Eqz });
        self.emit(Instruction::If(BlockType::Result(held)));
        self.constant(ty, Value::Int(0));
        self.emit(Instruction::Else);
        self.get(left);
        self.get(right);
        self.emit(match (wide, ty.is_signed()) {
            (false, true) => Instruction::I32RemS,
            (false, false) => Instruction::I32RemU,
            (true, true) => Instruction::I64RemS,
            (true, false) => Instruction::I64RemU,
        });
        self.emit(Instruction::End);
        self.release(left);
        self.release(right);
    }
}
