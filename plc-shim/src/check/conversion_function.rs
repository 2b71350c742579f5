//! `X_TO_Y`, `X_TRUNC_Y`, `TO_Y`, `TRUNC` (2nd ed. Table 22, 3rd ed. Tables 22 to 27), and of vendors
//! `ANY_TO_Y`, `ROUND`, `CEIL`, `FLOOR`, `ROUND_Y`, `CEIL_Y`, `FLOOR_Y`.
//!
//! | from, to | value |
//! |---|---|
//! | integer, narrower integer | low-order bits |
//! | real, integer | nearest, ties to even; saturates; NaN becomes 0 |
//! | bit string, BOOL | rightmost bit |
//! | number, BOOL | FALSE for 0 |
//! | REAL, DWORD and LREAL, LWORD | the same bits; other pairs of reals and bit strings do not exist |
//! | real and bit string where bit strings are numbers (CODESYS, TwinCAT) | the number |
//! | TIME, number | milliseconds |
//! | TOD, number | milliseconds |
//! | DATE, DT, number | seconds |
//! | LTIME, LDATE, LTOD, LDT, number | nanoseconds |
//! | number, DATE or TOD | the day it lies in, the time of its day |

use super::calendar::{day_start, within_day};
use super::convert::{Operand, constant, converted};
use super::dialect::as_number;
use super::scope::Body;
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::Feature;
use crate::ir::elementary::Kind;
use crate::ir::{Binary, ElementaryType, Expr, ExprKind, Intrinsic, Rounding, Value};
use crate::syntax::Span;

/// A conversion function, by what its name says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Conversion {
    /// Nothing for the overloaded forms of the 3rd edition.
    pub(super) from: Option<ElementaryType>,
    pub(super) to: ElementaryType,
    pub(super) rounding: Rounding,
}

/// The conversion that `key`, in capitals, names.
pub(super) fn find(key: &str) -> Option<Conversion> {
    if let Some((_, rounding)) = WHOLE.into_iter().find(|(name, _)| *name == key) {
        // 2nd ed. Table 22 leaves the result's type to the context; vendors give DINT.
        return Some(Conversion { from: None, to: ElementaryType::Dint, rounding });
    }
    let overloaded = |name: &str, rounding| {
        let to = ElementaryType::find(key.strip_prefix(name)?.strip_prefix('_')?)?;
        let exists = matches!(name, "TO" | "ANY_TO") || to.is_integer();
        exists.then_some(Conversion { from: None, to, rounding })
    };
    let values = [("TO", Rounding::NearestEven), ("ANY_TO", Rounding::NearestEven)];
    let found = values.into_iter().chain(WHOLE).find_map(|(name, rounding)| overloaded(name, rounding));
    found.or_else(|| {
        let marks = [("_TO_", Rounding::NearestEven), ("_TRUNC_", Rounding::Truncate)];
        marks.into_iter().find_map(|(mark, rounding)| {
            let (from, to) = key.split_once(mark)?;
            let (from, to) = (ElementaryType::find(from)?, ElementaryType::find(to)?);
            let exists = is_allowed(from, to, rounding) || is_mixed(from, to) && rounding == Rounding::NearestEven;
            exists.then_some(Conversion { from: Some(from), to, rounding })
        })
    })
}

/// What makes integers of real numbers.
const WHOLE: [(&str, Rounding); 4] = [
    ("TRUNC", Rounding::Truncate),
    ("ROUND", Rounding::NearestEven),
    ("CEIL", Rounding::Up),
    ("FLOOR", Rounding::Down),
];

/// True for conversions that a user's own unit of the same name goes before.
pub(super) fn is_of_vendors(key: &str) -> bool {
    let between = |from| find(key).is_some_and(|found| !is_defined(from, found.to));
    ["ROUND", "CEIL", "FLOOR", "ANY_TO_"].into_iter().any(|name| key.starts_with(name))
        || find(key).and_then(|found| found.from).is_some_and(between)
}

/// True for a real and a bit string, of which vendors convert the number.
fn is_mixed(from: ElementaryType, to: ElementaryType) -> bool {
    let bits = |ty: ElementaryType| ty.kind() == Kind::Bits;
    from.is_real() && bits(to) || bits(from) && to.is_real()
}

/// True if `from_TO_to` exists.
pub(super) fn is_defined(from: ElementaryType, to: ElementaryType) -> bool {
    let bits = |ty: ElementaryType| ty.kind() == Kind::Bits;
    let numeric = |ty: ElementaryType| ty.is_number() || bits(ty);
    if from == to {
        return false;
    }
    match (from.kind(), to.kind()) {
        // A date and time has both parts; neither part has the other.
        (Kind::DateTime, _) if to.is_calendar() => true,
        (Kind::Date, Kind::Date | Kind::DateTime)
        | (Kind::TimeOfDay, Kind::TimeOfDay | Kind::Duration)
        | (Kind::Duration, Kind::TimeOfDay)
        | (Kind::Character, Kind::Character) => true,
        _ if from.is_calendar() => numeric(to),
        _ if to.is_calendar() => numeric(from),
        _ if from.is_character() => to.is_integer() || bits(to),
        _ if to.is_character() => from.is_integer() || bits(from),
        _ if from.is_real() && bits(to) || bits(from) && to.is_real() => from.size() == to.size(),
        _ => true,
    }
}

fn is_allowed(from: ElementaryType, to: ElementaryType, rounding: Rounding) -> bool {
    is_defined(from, to) && (rounding == Rounding::NearestEven || from.is_real() && to.is_integer())
}

impl Body<'_, '_> {
    pub(super) fn conversion(&mut self, conversion: Conversion, operand: Operand, span: Span) -> Option<Operand> {
        let Conversion { from, to, rounding } = conversion;
        let expr = match from {
            Some(from) => self.coerce(operand, from.into())?,
            None => self.settle(operand)?,
        };
        if self.shape(expr.ty).is_some() && rounding == Rounding::NearestEven {
            return self.parsed(expr, to, span);
        }
        let Some(from) = self.elementary(expr.ty) else {
            let found = self.type_name(expr.ty);
            return self.mismatch("an elementary value", &found, expr.span);
        };
        if is_mixed(from, to) && self.checker.dialect(span).has(Feature::BitArithmetic) {
            return Some(Operand::Typed(self.as_numbers_do(expr, (from, to), rounding)));
        }
        if from != to && !is_allowed(from, to, rounding) {
            let message = format!("there is no conversion from {from} to {to}");
            let found = Diagnostic::error(Code::InvalidOperand, span, message);
            self.report(found.with_help("convert to an integer type on the way"));
            return None;
        }
        let rounding =
            if rounding == Rounding::NearestEven { self.checker.dialect(span).ties().into() } else { rounding };
        let value = Expr { span, ..lower(expr, from, to, rounding) };
        Some(Operand::Typed(self.time_value(value)))
    }

    /// A bit string as the number it is, from a real or to one.
    fn as_numbers_do(&self, expr: Expr, (from, to): (ElementaryType, ElementaryType), rounding: Rounding) -> Expr {
        let rounding =
            if rounding == Rounding::NearestEven { self.checker.dialect(expr.span).ties().into() } else { rounding };
        let number = converted(expr, as_number(from), Rounding::NearestEven);
        let there = lower(number, as_number(from), as_number(to), rounding);
        converted(there, to, Rounding::NearestEven)
    }
}

/// Nanoseconds of the unit in which a duration or date becomes a number.
fn unit_ns(ty: ElementaryType) -> i128 {
    match ty {
        ElementaryType::Date | ElementaryType::Dt => 1_000_000_000,
        ElementaryType::Time | ElementaryType::Tod => 1_000_000,
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

fn lower(expr: Expr, from: ElementaryType, to: ElementaryType, rounding: Rounding) -> Expr {
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
        (Kind::DateTime, Kind::Date) => converted(day_start(expr), to, rounding),
        (Kind::DateTime | Kind::Duration, Kind::TimeOfDay) => converted(within_day(expr), to, rounding),
        _ if counts(from) && counts(to) => converted(expr, to, rounding),
        (_, Kind::Real) if counts(from) => {
            let ns = converted(expr, ElementaryType::Lreal, rounding);
            converted(joined(Binary::Divide, ns, lreal(unit_ns(from))), to, rounding)
        }
        (_, Kind::Signed | Kind::Unsigned | Kind::Bits) if counts(from) => {
            let ns = converted(expr, ElementaryType::Lint, rounding);
            converted(joined(Binary::Divide, ns, lint(unit_ns(from))), to, rounding)
        }
        (Kind::Real, _) if counts(to) => {
            let number = converted(expr, ElementaryType::Lreal, rounding);
            normalised(converted(joined(Binary::Multiply, number, lreal(unit_ns(to))), to, rounding), to)
        }
        (Kind::Bool | Kind::Signed | Kind::Unsigned | Kind::Bits, _) if counts(to) => {
            let number = converted(expr, ElementaryType::Lint, rounding);
            normalised(converted(joined(Binary::Multiply, number, lint(unit_ns(to))), to, rounding), to)
        }
        (Kind::Bits, Kind::Bool) => {
            let one = constant(Value::Int(1), from, span);
            converted(joined(Binary::And, expr, one), to, rounding)
        }
        _ => converted(expr, to, rounding),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_taken_apart() {
        let found = find("INT_TO_REAL").map(|found| (found.from, found.to));
        assert_eq!(found, Some((Some(ElementaryType::Int), ElementaryType::Real)));
        let found = find("LREAL_TRUNC_DINT").map(|found| found.rounding);
        assert_eq!(found, Some(Rounding::Truncate));
        assert_eq!(find("TO_SINT").and_then(|found| found.from), None);
        assert!(find("INT_TO_INT").is_none() && is_of_vendors("REAL_TO_WORD") && !is_of_vendors("REAL_TO_DWORD"));
        assert!(find("INT_TRUNC_SINT").is_none() && find("GOTO_INT").is_none());
    }
}
