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

use super::vendor::of_pointer_width;
use crate::dialect::WordSize;
use crate::ir::elementary::Kind;
use crate::ir::{ElementaryType, Rounding};

/// A conversion function, by what its name says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::check) struct Conversion {
    /// Nothing for the overloaded forms of the 3rd edition.
    pub(in crate::check) from: Option<ElementaryType>,
    pub(in crate::check) to: ElementaryType,
    pub(in crate::check) rounding: Rounding,
    /// True if `to` stands for any integer type that the place wants.
    pub(in crate::check) takes_context: bool,
}

/// The conversion that `key`, in capitals, names.
pub(in crate::check) fn find(key: &str) -> Option<Conversion> {
    if let Some((_, rounding)) = WHOLE.into_iter().find(|(name, _)| *name == key) {
        // 2nd ed. Table 22: ANY_INT, as the place wants it; vendors give DINT.
        return Some(Conversion { from: None, to: ElementaryType::Dint, rounding, takes_context: true });
    }
    let overloaded = |name: &str, rounding| {
        let to = key.strip_prefix(name)?.strip_prefix('_')?;
        // Of vendors' names with underscores; what has 64 bits narrows to fewer with a conversion only.
        let wide = || of_pointer_width(to, WordSize::default()).filter(|_| to.starts_with("__"));
        let to = ElementaryType::find(to).or_else(wide)?;
        let exists = matches!(name, "TO" | "ANY_TO") || to.is_integer();
        exists.then_some(Conversion { from: None, to, rounding, takes_context: false })
    };
    let values = [("TO", Rounding::NearestEven), ("ANY_TO", Rounding::NearestEven)];
    let found = values.into_iter().chain(WHOLE).find_map(|(name, rounding)| overloaded(name, rounding));
    found.or_else(|| {
        let marks = [("_TO_", Rounding::NearestEven), ("_TRUNC_", Rounding::Truncate)];
        marks.into_iter().find_map(|(mark, rounding)| {
            let (from, to) = key.split_once(mark)?;
            let (from, to) = (ElementaryType::find(from)?, ElementaryType::find(to)?);
            let is_loose = is_mixed(from, to) || is_between_times(from, to);
            let exists = is_allowed(from, to, rounding) || is_loose && rounding == Rounding::NearestEven;
            exists.then_some(Conversion { from: Some(from), to, rounding, takes_context: false })
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
pub(in crate::check) fn is_mixed(from: ElementaryType, to: ElementaryType) -> bool {
    let bits = |ty: ElementaryType| ty.kind() == Kind::Bits;
    from.is_real() && bits(to) || bits(from) && to.is_real()
}

/// True for two of durations, dates and times of day, or a BOOL and one of these, that only vendors convert: both count
/// from 1970 or from midnight.
pub(in crate::check) fn is_between_times(from: ElementaryType, to: ElementaryType) -> bool {
    let counts = |ty: ElementaryType| ty.is_duration() || ty.is_calendar();
    let is_number = |ty: ElementaryType| ty == ElementaryType::Bool;
    let is_pair = counts(from) && counts(to) || is_number(from) && counts(to) || counts(from) && is_number(to);
    is_pair && from != to && !is_defined(from, to)
}

/// True if `from_TO_to` exists.
pub(in crate::check) fn is_defined(from: ElementaryType, to: ElementaryType) -> bool {
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

pub(in crate::check) fn is_allowed(from: ElementaryType, to: ElementaryType, rounding: Rounding) -> bool {
    is_defined(from, to) && (rounding == Rounding::NearestEven || from.is_real() && to.is_integer())
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
        assert_eq!(find("TO___UXINT").map(|found| found.to), Some(ElementaryType::Ulint));
        assert!(find("INT_TO_INT").is_none() && is_of_vendors("REAL_TO_WORD") && !is_of_vendors("REAL_TO_DWORD"));
        assert!(find("INT_TRUNC_SINT").is_none() && find("GOTO_INT").is_none());
    }
}
