//! `X_TO_Y`, `X_TRUNC_Y`, `TO_Y`, `TRUNC` (2nd ed. Table 22, 3rd ed. Tables 22 to 27), and of vendors
//! `ANY_TO_Y`, `ROUND`, `CEIL`, `FLOOR`, `ROUND_Y`, `CEIL_Y`, `FLOOR_Y`.
//!
//! | from, to | value |
//! |---|---|
//! | integer, narrower integer | low-order bits |
//! | real, integer | nearest, ties to even; saturates; NaN becomes 0 |
//! | bit string, BOOL | rightmost bit; FALSE for 0 alone where the dialect says so |
//! | number, BOOL | FALSE for 0 |
//! | REAL, DWORD and LREAL, LWORD | the same bits; other pairs of reals and bit strings do not exist |
//! | real and bit string as numbers (2nd edition, CODESYS, TwinCAT) | the number |
//! | TIME, number | milliseconds; seconds in matiec |
//! | TOD, number | milliseconds; seconds in matiec |
//! | DATE, DT, number | seconds |
//! | LTIME, LDATE, LTOD, LDT, number | nanoseconds |
//! | number, DATE or TOD | the day it lies in, the time of its day |
//! | TIME, DATE, TOD, DT among them (CODESYS, TwinCAT) | the same time since 1970 or midnight |

use crate::check::body::Body;
use crate::check::body::expression::calendar::{day_start, within_day};
use crate::check::standard::conversion::{Conversion, is_allowed, is_between_times, is_mixed};
use crate::check::types::number::as_number;
use crate::check::types::operand::{Operand, constant, converted};
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::{Dialect, Feature, Truth};
use crate::ir::elementary::Kind;
use crate::ir::{Binary, ElementaryType, Expr, ExprKind, Intrinsic, Rounding, Value};
use crate::syntax::Span;

impl Body<'_, '_> {
    pub(in crate::check) fn conversion(
        &mut self,
        conversion: Conversion,
        operand: Operand,
        span: Span,
    ) -> Option<Operand> {
        let Conversion { from, mut to, rounding, takes_context } = conversion;
        if takes_context {
            to = self.context.filter(|wanted| wanted.is_integer()).unwrap_or(to);
        }
        let expr = match from {
            Some(from) if to.is_integer() => {
                let known = self.declarations.mark();
                let value = self.coerce(operand, from.into());
                // What becomes an integer again was meant to lose it.
                self.declarations.forget_lost_fractions(known);
                value?
            }
            Some(from) => self.coerce(operand, from.into())?,
            None => self.settle(operand)?,
        };
        if self.shape(expr.ty).is_some() && rounding == Rounding::NearestEven {
            return self.parsed(expr, to, span);
        }
        let expr = self.whole(expr);
        let Some(from) = self.elementary(expr.ty) else {
            let found = self.type_name(expr.ty);
            return self.mismatch("an elementary value", &found, expr.span);
        };
        self.warn_of_cut_product(&expr, from, to);
        if is_mixed(from, to) && self.declarations.dialect(span).has(Feature::BitsAsReals) {
            return Some(Operand::Typed(self.as_numbers_do(expr, (from, to), rounding)));
        }
        // What is whole already has nothing to cut off.
        let rounding = if from.is_integer() && to.is_integer() { Rounding::NearestEven } else { rounding };
        let is_between_times = rounding == Rounding::NearestEven
            && is_between_times(from, to)
            && self.declarations.dialect(span).has(Feature::TimesAsDates);
        if from != to && !is_allowed(from, to, rounding) && !is_between_times {
            let message = format!("there is no conversion from {from} to {to}");
            let found = Diagnostic::error(Code::InvalidOperand, span, message);
            self.report(found.with_help("convert to an integer type on the way"));
            return None;
        }
        let rounding =
            if rounding == Rounding::NearestEven { self.declarations.dialect(span).ties().into() } else { rounding };
        let value = Expr { span, ..lower(expr, (from, to), rounding, self.declarations.dialect(span)) };
        Some(Operand::Typed(self.time_value(value)))
    }

    /// A bit string as the number it is, from a real or to one.
    fn as_numbers_do(&self, expr: Expr, (from, to): (ElementaryType, ElementaryType), rounding: Rounding) -> Expr {
        let rounding = if rounding == Rounding::NearestEven {
            self.declarations.dialect(expr.span).ties().into()
        } else {
            rounding
        };
        let number = converted(expr, as_number(from), Rounding::NearestEven);
        let dialect = self.declarations.dialect(number.span);
        let there = lower(number, (as_number(from), as_number(to)), rounding, dialect);
        converted(there, to, Rounding::NearestEven)
    }
}

/// Nanoseconds of the unit in which a duration or date becomes a number.
fn unit_ns(ty: ElementaryType, dialect: Dialect) -> i128 {
    match ty {
        ElementaryType::Date | ElementaryType::Dt => 1_000_000_000,
        ElementaryType::Time | ElementaryType::Tod => dialect.time_number_ns().into(),
        _ => 1,
    }
}

fn joined(operator: Binary, left: Expr, right: Expr) -> Expr {
    let (ty, span) = (left.ty, left.span);
    Expr { kind: ExprKind::Binary(operator, Box::new(left), Box::new(right)), ty, span }
}

/// A DATE is a midnight, a TOD less than a day.
fn normalised(expr: Expr, ty: ElementaryType) -> Expr {
    match ty.kind() {
        Kind::Date => day_start(expr),
        Kind::TimeOfDay => within_day(expr),
        _ => expr,
    }
}

fn lower(expr: Expr, (from, to): (ElementaryType, ElementaryType), rounding: Rounding, dialect: Dialect) -> Expr {
    let span = expr.span;
    let lint = |value| constant(Value::Int(value), ElementaryType::Lint, span);
    let lreal = |value: i128| constant(Value::Lreal(value as f64), ElementaryType::Lreal, span);
    let counts = |ty: ElementaryType| ty.is_duration() || ty.is_calendar();
    match (from.kind(), to.kind()) {
        // 3rd ed. Table 25: the bits are transferred, between types of one size only.
        (Kind::Real, Kind::Bits) | (Kind::Bits, Kind::Real) => {
            let kind = ExprKind::Intrinsic(Intrinsic::Reinterpret, vec![expr]);
            Expr { kind, ty: to.into(), span }
        }
        (Kind::DateTime | Kind::Duration | Kind::TimeOfDay, Kind::Date) if from.kind() != to.kind() => {
            converted(day_start(expr), to, rounding)
        }
        (Kind::DateTime | Kind::Duration | Kind::Date, Kind::TimeOfDay) => converted(within_day(expr), to, rounding),
        (Kind::Duration | Kind::TimeOfDay, Kind::DateTime) if to == ElementaryType::Dt => {
            let second = lint(unit_ns(to, dialect));
            let whole =
                Expr { kind: ExprKind::Intrinsic(Intrinsic::FloorMultiple, vec![expr, second]), ty: from.into(), span };
            converted(whole, to, rounding)
        }
        _ if counts(from) && counts(to) => converted(expr, to, rounding),
        (_, Kind::Real) if counts(from) => {
            let ns = converted(expr, ElementaryType::Lreal, rounding);
            converted(joined(Binary::Divide, ns, lreal(unit_ns(from, dialect))), to, rounding)
        }
        (_, Kind::Signed | Kind::Unsigned | Kind::Bits) if counts(from) => {
            let ns = converted(expr, ElementaryType::Lint, rounding);
            converted(joined(Binary::Divide, ns, lint(unit_ns(from, dialect))), to, rounding)
        }
        (Kind::Real, _) if counts(to) => {
            let number = converted(expr, ElementaryType::Lreal, rounding);
            normalised(converted(joined(Binary::Multiply, number, lreal(unit_ns(to, dialect))), to, rounding), to)
        }
        (Kind::Bool | Kind::Signed | Kind::Unsigned | Kind::Bits, _) if counts(to) => {
            let number = converted(expr, ElementaryType::Lint, rounding);
            normalised(converted(joined(Binary::Multiply, number, lint(unit_ns(to, dialect))), to, rounding), to)
        }
        (Kind::Bits, Kind::Bool) if dialect.truth() == Truth::LowestBit => {
            let one = constant(Value::Int(1), from, span);
            converted(joined(Binary::And, expr, one), to, rounding)
        }
        _ => converted(expr, to, rounding),
    }
}
