//! Arithmetic of durations, dates and times of day (2nd ed. 2.5.1.5.7 Table 30, 3rd ed. Table 35).

use crate::check::body::Body;
use crate::check::standard::timed::TimedFunction;
use crate::check::types::operand::{Operand, constant, converted};
use crate::ir::elementary::Kind;
use crate::ir::{Binary, ElementaryType as E, Expr, ExprKind, Intrinsic, Rounding, Value};
use crate::syntax::Span;
use crate::syntax::calendar::DAY_NS;

/// The remainder of `value` by a day, never negative.
pub(in crate::check::body) fn within_day(value: Expr) -> Expr {
    day_part(Intrinsic::FloorRemainder, value)
}

/// Midnight before or at `value`.
pub(in crate::check::body) fn day_start(value: Expr) -> Expr {
    day_part(Intrinsic::FloorMultiple, value)
}

fn day_part(kind: Intrinsic, value: Expr) -> Expr {
    let (ty, span) = (value.ty, value.span);
    let day = constant(Value::Int(i128::from(DAY_NS)), E::Lint, span);
    Expr { kind: ExprKind::Intrinsic(kind, vec![value, day]), ty, span }
}

fn is_long(ty: E) -> bool {
    matches!(ty, E::Ltime | E::Ldate | E::Ltod | E::Ldt)
}

impl Body<'_, '_> {
    pub(in crate::check) fn is_calendar(&self, operand: &Operand) -> bool {
        matches!(operand, Operand::Typed(expr) if self.plain_elementary(expr).is_some_and(E::is_calendar))
    }

    pub(in crate::check::body) fn timed_function(
        &mut self,
        function: TimedFunction,
        left: Operand,
        right: Operand,
        span: Span,
    ) -> Option<Operand> {
        let left = Operand::Typed(self.coerce(left, function.left.into())?);
        let right = match function.right {
            Some(ty) => Operand::Typed(self.coerce(right, ty.into())?),
            None => right,
        };
        self.operation(function.operator, left, right, span)
    }

    /// `+` and `-` where a date or time of day takes part.
    pub(super) fn calendar_operation(
        &mut self,
        operator: Binary,
        left: Operand,
        right: Operand,
        span: Span,
    ) -> Option<Operand> {
        let (Operand::Typed(first), Operand::Typed(second)) = (&left, &right) else {
            return self.invalid_operands(&left, &right, span);
        };
        let types = (self.plain_elementary(first), self.plain_elementary(second));
        let (Some(first_ty), Some(second_ty)) = types else {
            return self.invalid_operands(&left, &right, span);
        };
        let long = is_long(first_ty) || is_long(second_ty);
        let pick = |short: E, wide: E| Some(if long { wide } else { short });
        let ty = match (operator, first_ty.kind(), second_ty.kind()) {
            (Binary::Subtract, a, b) if a == b => pick(E::Time, E::Ltime),
            (Binary::Add | Binary::Subtract, Kind::TimeOfDay, Kind::Duration) => pick(E::Tod, E::Ltod),
            (Binary::Add | Binary::Subtract, Kind::DateTime, Kind::Duration)
            | (Binary::Add, Kind::Date, Kind::TimeOfDay) => pick(E::Dt, E::Ldt),
            _ => None,
        };
        let Some(ty) = ty else {
            return self.invalid_operands(&left, &right, span);
        };
        let (Operand::Typed(left), Operand::Typed(right)) = (left, right) else {
            return None;
        };
        // All of them count nanoseconds.
        let [left, right] = [left, right].map(|expr| converted(expr, E::Lint, Rounding::NearestEven));
        let kind = ExprKind::Binary(operator, Box::new(left), Box::new(right));
        let mut count = Expr { kind, ty: E::Lint.into(), span };
        if ty.kind() == Kind::TimeOfDay {
            // A time of day passes midnight.
            count = within_day(count);
        }
        Some(Operand::Typed(converted(count, ty, Rounding::NearestEven)))
    }
}
