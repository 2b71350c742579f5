//! Expressions.

use wasm_encoder::{BlockType, Ieee32, Ieee64, Instruction, ValType};

use super::emitter::{Emitter, value_type};
use super::fault::{Callee, FaultKind};
use crate::ir::{Argument, Binary, ElementaryType, Expr, ExprKind, FunctionCall, Place, Unary, Value};
use crate::syntax::Span;

impl Emitter<'_, '_> {
    /// Pushes the expression's value; an aggregate's address.
    pub(super) fn expression(&mut self, expr: &Expr) {
        match &expr.kind {
            ExprKind::Constant(value) => {
                let ty = self.held_as(expr.ty);
                self.constant(ty, *value);
            }
            ExprKind::Load(place) => self.load(place),
            ExprKind::Address(place) => self.full_address(place),
            ExprKind::Unary(Unary::Negate, operand) => self.negate(operand),
            ExprKind::Unary(Unary::Not, operand) => self.complement(operand),
            ExprKind::Binary(operator, left, right) => {
                let ty = self.held_as(left.ty);
                self.expression(left);
                self.expression(right);
                self.operation(*operator, ty, expr.span);
            }
            ExprKind::Convert(rounding, operand) => {
                let (from, to) = (self.held_as(operand.ty), self.held_as(expr.ty));
                self.expression(operand);
                self.convert(from, to, *rounding);
            }
            ExprKind::Conditional(parts) => self.conditional(parts),
            ExprKind::Limited(low, high, operand) => self.limited(*low, *high, operand),
            ExprKind::Intrinsic(intrinsic, operands) => {
                self.intrinsic(*intrinsic, operands, expr);
            }
            ExprKind::Text(call) => self.text_call(call, expr),
            ExprKind::Call(call) => self.call_function(call, expr.span),
            ExprKind::Cast(cast) => self.cast(cast),
            ExprKind::After(statements, value) => {
                self.side_statements(statements);
                if let Some(value) = value {
                    self.expression(value);
                }
            }
        }
    }

    fn conditional(&mut self, parts: &[Expr; 3]) {
        let [condition, then, otherwise] = parts;
        let held = value_type(self.held_as(then.ty));
        self.expression(condition);
        self.emit(Instruction::If(BlockType::Result(held)));
        self.expression(then);
        self.emit(Instruction::Else);
        self.expression(otherwise);
        self.emit(Instruction::End);
    }

    pub(super) fn constant(&mut self, ty: ElementaryType, value: Value) {
        self.emit(match value_type(ty) {
            ValType::F32 => {
                let value = if let Value::Real(value) = value { value } else { value.as_f64() as f32 };
                Instruction::F32Const(Ieee32::new(value.to_bits()))
            }
            ValType::F64 => Instruction::F64Const(Ieee64::new(value.as_f64().to_bits())),
            ValType::I64 => Instruction::I64Const(value.as_int().unwrap_or(0) as i64),
            _ => Instruction::I32Const(value.as_int().unwrap_or(0) as i32),
        });
    }

    /// Stops the PLC unless the value lies between the two, which the type's own limits do not
    /// need.
    fn limited(&mut self, low: i128, high: i128, operand: &Expr) {
        let ty = self.held_as(operand.ty);
        let (least, greatest) = ty.range().unwrap_or((low, high));
        self.expression(operand);
        let value = self.scratch(value_type(ty));
        self.set(value);
        let bounds = [(low, Binary::Less, low > least), (high, Binary::Greater, high < greatest)];
        for (bound, beyond, needed) in bounds {
            if needed {
                self.get(value);
                self.constant(ty, Value::Int(bound));
                self.operation(beyond, ty, operand.span);
                self.fault_if(FaultKind::OutOfSubrange, operand.span);
            }
        }
        self.get(value);
        self.release(value);
    }

    fn call_function(&mut self, call: &FunctionCall, span: Span) {
        if let Some(receiver) = &call.receiver {
            self.receiver(receiver);
        }
        self.side_statements(&call.before);
        if let Some(receiver) = &call.receiver {
            self.get(receiver.pointer);
        }
        for argument in &call.arguments {
            match argument {
                Argument::Value(expr) => self.expression(expr),
                Argument::Reference(place) => self.full_address(place),
            }
        }
        match &call.receiver {
            Some(receiver) => self.call_on(receiver.pointer, receiver.dispatch, call.pou, (Callee::Function, span)),
            None => {
                self.mark_call(Callee::Function, span);
                self.call(call.pou);
            }
        }
        if let Some(place) = &call.result {
            self.keep_result(place);
        }
        self.side_statements(&call.outputs);
    }

    /// Copies the aggregate whose address is on the stack to `place` and pushes that address.
    fn keep_result(&mut self, place: &Place) {
        let source = self.scratch(ValType::I32);
        self.set(source);
        self.full_address(place);
        self.get(source);
        self.release(source);
        let size = self.shared.types.size(place.ty);
        self.emit(Instruction::I32Const(size as i32));
        self.emit(Instruction::MemoryCopy { src_mem: 0, dst_mem: 0 });
        self.full_address(place);
    }
}
