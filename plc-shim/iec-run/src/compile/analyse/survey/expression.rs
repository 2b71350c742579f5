//! Expressions.

use super::Walk;
use crate::compile::analyse::nan::may_be_any_nan;
use crate::compile::analyse::price;
use onescan_iec::ir::text::{TextCall, TextFunction};
use onescan_iec::ir::{Expr, ExprKind, Intrinsic, MemoryFunction, Unary};

impl Walk<'_, '_> {
    pub(super) fn settled(&mut self, expr: &Expr) {
        self.expression(expr);
        if may_be_any_nan(&self.scope, expr) {
            self.charge(price::CANONICAL);
        }
    }

    pub(super) fn expression(&mut self, expr: &Expr) {
        match &expr.kind {
            ExprKind::Constant(_) => self.charge(1),
            ExprKind::Load(place) => self.load(place),
            ExprKind::Address(place) => self.full_address(place),
            ExprKind::Unary(Unary::Negate, operand) if self.scope.held_as(operand.ty).is_real() => {
                self.settled(operand);
                self.charge(1);
            }
            ExprKind::Unary(_, operand) => {
                self.expression(operand);
                self.charge(price::unary(self.scope.held_as(operand.ty)));
            }
            ExprKind::Binary(operator, left, right) => {
                self.expression(left);
                self.expression(right);
                let by_constant = matches!(right.kind, ExprKind::Constant(_));
                self.charge(price::binary(*operator, self.scope.held_as(left.ty), by_constant));
            }
            ExprKind::Convert(_, operand) | ExprKind::FromRegister(operand) => {
                self.expression(operand);
                self.charge(price::conversion(self.scope.held_as(operand.ty), self.scope.held_as(expr.ty)));
            }
            ExprKind::Conditional(parts) => {
                self.expressions(&parts[..]);
                self.charge(price::BRANCH);
            }
            ExprKind::Limited(_, _, operand) => {
                self.expression(operand);
                self.charge(price::LIMITS);
            }
            ExprKind::Intrinsic(intrinsic, operands) => self.intrinsic(*intrinsic, operands, expr),
            ExprKind::Text(call) => self.text(call),
            ExprKind::Call(call) => self.call_function(call),
            ExprKind::Cast(cast) => self.cast(cast),
            ExprKind::After(statements, value) => {
                self.statements(statements);
                if let Some(value) = value {
                    self.expression(value);
                }
            }
        }
    }

    pub(super) fn expressions(&mut self, list: &[Expr]) {
        for expr in list {
            self.expression(expr);
        }
    }

    pub(super) fn intrinsic(&mut self, intrinsic: Intrinsic, operands: &[Expr], whole: &Expr) {
        let shift = matches!(intrinsic, Intrinsic::ShiftLeft | Intrinsic::ShiftRight);
        match operands {
            // The count is part of the instruction.
            [value, Expr { kind: ExprKind::Constant(_), .. }] if shift => {
                self.expression(value);
                self.charge(3);
                return;
            }
            _ => self.expressions(operands),
        }
        self.charge(price::intrinsic(intrinsic, operands.len() as u64, self.scope.held_as(whole.ty)));
        if let Intrinsic::Memory(MemoryFunction::Copy | MemoryFunction::Fill) = intrinsic {
            self.changed(None);
        }
    }

    pub(super) fn text(&mut self, call: &TextCall) {
        self.expressions(&call.operands);
        if let Some(target) = &call.target {
            self.full_address(target);
        }
        self.charge(if call.function == TextFunction::Length { 6 } else { price::TEXT_CALL });
        let makes =
            matches!(call.function, TextFunction::Edit(_) | TextFunction::Format(_) | TextFunction::FormatLongTime);
        if makes {
            self.changed(call.target.as_ref().and_then(|target| self.scope.extent(target)));
        }
    }
}
