//! Expressions.

use wasm_encoder::{BlockType, Ieee32, Ieee64, Instruction, ValType};

use super::emitter::{Emitter, value_type};
use crate::compile::fault::FaultKind;
use onescan_iec::ir::{Binary, ElementaryType, Expr, ExprKind, Rounding, Unary, Value};

impl Emitter<'_, '_> {
    /// Pushes the expression's value; an aggregate's address.
    pub(crate) fn expression(&mut self, expr: &Expr) {
        match &expr.kind {
            ExprKind::Constant(value) => {
                let ty = self.held_as(expr.ty);
                self.constant(ty, *value);
            }
            ExprKind::Load(place) => {
                self.trace_read(place, expr.span);
                self.load(place);
            }
            ExprKind::Address(place) => {
                self.trace_read(place, expr.span);
                self.full_address(place);
            }
            ExprKind::Unary(Unary::Negate, operand) => self.negate(operand),
            ExprKind::Unary(Unary::Not, operand) => self.complement(operand),
            ExprKind::Binary(operator, left, right) => {
                self.binary(*operator, left, right, expr);
            }
            ExprKind::Convert(rounding, operand) => {
                let to = self.held_as(expr.ty);
                self.expression(operand);
                self.convert(operand, to, *rounding);
            }
            ExprKind::FromRegister(operand) => {
                let to = self.held_as(expr.ty);
                self.expression(operand);
                self.convert(operand, to, Rounding::NearestEven);
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
        let (mut ways, other) = (self.open_ways(), self.way());
        self.expression(then);
        self.end_way(&mut ways, other);
        self.emit(Instruction::Else);
        self.expression(otherwise);
        self.close_ways(ways);
        self.emit(Instruction::End);
    }

    pub(crate) fn constant(&mut self, ty: ElementaryType, value: Value) {
        self.emit(match value_type(ty) {
            ValType::F32 => {
                let value = if let Value::Real(value) = value { value } else { value.as_f64() as f32 };
                Instruction::F32Const(Ieee32::new(value.to_bits()))
            }
            ValType::F64 => Instruction::F64Const(Ieee64::new(value.as_f64().to_bits())),
            // The checker gives integers no real constants.
            held => match (value.as_int(), held) {
                (Some(value), ValType::I64) => Instruction::I64Const(value as i64),
                (Some(value), _) => Instruction::I32Const(value as i32),
                (None, _) => Instruction::Unreachable,
            },
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
}
