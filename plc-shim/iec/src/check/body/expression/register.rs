//! Integers where the target computes them in registers that are wider than their types: a result is cut to its type
//! where it is assigned, handed over or converted, and nowhere before.
//!
//! A result is held in its own type, as elsewhere. That is exact for `+`, `-`, `*` and a sign, whose low-order bits do
//! not depend on the others. What looks at all bits (`/`, `MOD`, a comparison, a wider type, a function) takes the
//! operation once more, in the register's type.

use crate::check::body::Body;
use crate::check::types::operand::{Operand, converted};
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::IntegerWidth;
use crate::ir::{Binary, ElementaryType, Expr, ExprKind, Rounding, TypeId, Unary};
use crate::syntax::Span;

/// True for operations whose result may have more bits than its operands.
fn is_arithmetic(operator: Binary) -> bool {
    matches!(
        operator,
        Binary::Add | Binary::Subtract | Binary::Multiply | Binary::Divide | Binary::DivideAnyway | Binary::Modulo
    )
}

fn is_bitwise(operator: Binary) -> bool {
    matches!(operator, Binary::And | Binary::Or | Binary::Xor)
}

impl Body<'_, '_> {
    /// The type of a register that holds an integer of type `ty`, if a register has more bits.
    pub(in crate::check::body) fn register_of(&self, ty: ElementaryType, span: Span) -> Option<ElementaryType> {
        let computes = self.declarations.dialect(span).integers() == IntegerWidth::Register;
        let register = self.declarations.word_size(span).register(ty.is_signed());
        let is_number = ty.is_integer() || ty.is_bits() && ty != ElementaryType::Bool;
        (computes && is_number && ty.size() < register.size()).then_some(register)
    }

    /// The register that holds the result of an operation, whose bits beyond its type are still there.
    pub(in crate::check::body) fn held_in_register(&self, expr: &Expr) -> Option<ElementaryType> {
        let register = self.register_of(self.plain_elementary(expr)?, expr.span)?;
        let holds = match &expr.kind {
            ExprKind::FromRegister(_) | ExprKind::Unary(Unary::Negate, _) => true,
            ExprKind::Binary(operator, left, right) => {
                is_arithmetic(*operator)
                    || is_bitwise(*operator)
                        && (self.held_in_register(left).is_some() || self.held_in_register(right).is_some())
            }
            _ => false,
        };
        holds.then_some(register)
    }

    /// The value as a register of type `register` has it.
    pub(in crate::check::body) fn in_register(&self, expr: Expr, register: ElementaryType) -> Expr {
        let (holds, span) = (self.held_in_register(&expr).is_some(), expr.span);
        let again = |operand: Box<Expr>| Box::new(self.in_register(*operand, register));
        let kind = match expr.kind {
            ExprKind::FromRegister(held) if holds => return converted(*held, register, Rounding::NearestEven),
            ExprKind::Unary(operator, operand) if holds => ExprKind::Unary(operator, again(operand)),
            ExprKind::Binary(operator, left, right) if holds => ExprKind::Binary(operator, again(left), again(right)),
            kind => return converted(Expr { kind, ..expr }, register, Rounding::NearestEven),
        };
        Expr { kind, ty: register.into(), span }
    }

    /// A value as one of `wanted`, which takes what a register holds beyond the value's own type.
    pub(in crate::check::body) fn taken_as(&self, expr: Expr, wanted: ElementaryType) -> Expr {
        let Some(register) = self.held_in_register(&expr) else {
            return converted(expr, wanted, Rounding::NearestEven);
        };
        let span = expr.span;
        let held = self.in_register(expr, register);
        if self.register_of(wanted, span).is_none() {
            return converted(held, wanted, Rounding::NearestEven);
        }
        Expr { kind: ExprKind::FromRegister(Box::new(held)), ty: wanted.into(), span }
    }

    /// A value all of whose bits count: as a register has it, if that holds more than the value's type.
    pub(in crate::check::body) fn whole(&self, value: Expr) -> Expr {
        match self.held_in_register(&value) {
            Some(register) => self.in_register(value, register),
            None => value,
        }
    }

    /// Two operands of one type, both in a register if it holds more of one of them than that type.
    pub(in crate::check::body) fn whole_operands(&self, left: Expr, right: Expr) -> (Expr, Expr) {
        match self.held_in_register(&left).or_else(|| self.held_in_register(&right)) {
            Some(register) => (self.in_register(left, register), self.in_register(right, register)),
            None => (left, right),
        }
    }

    /// The same of any number of values of one type.
    pub(in crate::check::body) fn whole_values(&self, values: Vec<Expr>) -> Vec<Expr> {
        match values.iter().find_map(|value| self.held_in_register(value)) {
            Some(register) => values.into_iter().map(|value| self.in_register(value, register)).collect(),
            None => values,
        }
    }

    /// An operation on values that are [whole](Self::whole) and held as one of `held`, in the type that it has.
    pub(in crate::check::body) fn cut(kind: ExprKind, held: TypeId, ty: TypeId, span: Span) -> Operand {
        let whole = Expr { kind, ty: held, span };
        let is_cut = held != ty;
        Operand::Typed(if is_cut { Expr { kind: ExprKind::FromRegister(Box::new(whole)), ty, span } } else { whole })
    }

    /// Warns of a difference that is compared with the sign or the bits that a register gives it, where another target
    /// would compare a number of its type: `now - last >= limit` after the counter has begun again.
    pub(super) fn warn_of_uncut_difference(&mut self, operand: &Expr) {
        let is_difference = matches!(operand.kind, ExprKind::Binary(Binary::Subtract, ..));
        let Some(ty) = self.plain_elementary(operand).filter(|ty| is_difference && !ty.is_signed()) else { return };
        if self.register_of(ty, operand.span).is_some() {
            let bits = self.declarations.word_size(operand.span);
            let message = format!(
                "below 0 this difference is not cut to {ty} before it is compared: the target compares {bits} bits"
            );
            let found = Diagnostic::warning(Code::UncutDifference, operand.span, message);
            self.report(found.with_help(format!("`TO_{ty}(..)` cuts it, on every target")));
        }
    }
}
