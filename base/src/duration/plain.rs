//! `10ms`, `2.5 s`: one decimal number and one unit, as scenario files and the command line have it.

use std::fmt;

use thiserror::Error;

/// The units from the smallest to the largest, with their nanoseconds.
const UNITS: [(u64, &str); 6] = [
    (1, "ns"),
    (1_000, "us"),
    (1_000_000, "ms"),
    (1_000_000_000, "s"),
    (60_000_000_000, "min"),
    (3_600_000_000_000, "h"),
];

/// The most decimals that are read. More than nanoseconds need, and few enough for 128 bits.
const DECIMALS_MAX: usize = 18;

/// Why a text is not a time.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum DurationError {
    /// No number with a unit.
    #[error("`{0}` is not a time: write a number and a unit, as in `10ms`, `2.5s` or `1min`")]
    Form(String),
    /// A unit that is none of ours.
    #[error("`{unit}` in `{text}` is not a unit of time: use ns, us, ms, s, min or h")]
    Unit {
        text: String,
        /// The unit as written.
        unit: String,
    },
    /// More decimals than nanoseconds, or too large.
    #[error("`{0}` is not a whole number of nanoseconds below 584 years")]
    Range(String),
    /// Zero where a span is asked for.
    #[error("`{0}` is zero; a positive time is needed here")]
    Zero(String),
}

/// The nanoseconds in `text`, exactly: a decimal number and a unit, with white space between them if you like.
///
/// # Errors
/// A text of another form, an unknown unit, fractions of a nanosecond, 584 years and more.
///
/// ```
/// use onescan_base::duration::plain;
///
/// assert_eq!(plain::parse("2.5 ms"), Ok(2_500_000));
/// assert!(plain::parse("10 sec").is_err());
/// assert!(plain::parse("0bananas").is_err());
/// ```
pub fn parse(text: &str) -> Result<u64, DurationError> {
    let form = || DurationError::Form(text.to_owned());
    let range = || DurationError::Range(text.to_owned());
    let trimmed = text.trim();
    let split = trimmed.find(|c: char| !c.is_ascii_digit() && c != '.' && c != '_').ok_or_else(form)?;
    let (number, unit) = (trimmed[..split].replace('_', ""), trimmed[split..].trim());
    let (whole, fraction) = number.split_once('.').unwrap_or((&number, ""));
    if whole.is_empty() || fraction.contains('.') || number.ends_with('.') {
        return Err(form());
    }
    let unit_ns = UNITS
        .iter()
        .find(|(_, name)| *name == unit)
        .map(|(ns, _)| u128::from(*ns))
        .ok_or_else(|| DurationError::Unit { text: text.to_owned(), unit: unit.to_owned() })?;
    if fraction.len() > DECIMALS_MAX {
        return Err(range());
    }
    let scale = 10u128.pow(fraction.len() as u32);
    let digits: u128 = format!("{whole}{fraction}").parse().map_err(|_| range())?;
    let scaled = digits.checked_mul(unit_ns).ok_or_else(range)?;
    if scaled % scale != 0 {
        return Err(range());
    }
    u64::try_from(scaled / scale).map_err(|_| range())
}

/// The nanoseconds in `text`, which may have a sign: the value of a TIME. Zero needs no unit.
///
/// # Errors
/// As [`parse`]; also a value beyond 292 years.
///
/// ```
/// use onescan_base::duration::plain;
///
/// assert_eq!(plain::parse_signed("-1.5ms"), Ok(-1_500_000));
/// assert_eq!(plain::parse_signed("0"), Ok(0));
/// assert!(plain::parse_signed("0bananas").is_err());
/// ```
pub fn parse_signed(text: &str) -> Result<i64, DurationError> {
    let trimmed = text.trim();
    let (sign, magnitude) = trimmed.strip_prefix('-').map_or((1, trimmed), |magnitude| (-1, magnitude));
    if magnitude == "0" {
        return Ok(0);
    }
    i64::try_from(sign * i128::from(parse(magnitude)?)).map_err(|_| DurationError::Range(text.to_owned()))
}

/// `ns` nanoseconds as seconds without a unit, with as many decimals as the value needs and `decimals_min` at least.
///
/// ```
/// use onescan_base::duration::plain;
///
/// assert_eq!(plain::seconds(1_500_000_000, 0).to_string(), "1.5");
/// assert_eq!(plain::seconds(2_000_000_000, 0).to_string(), "2");
/// assert_eq!(plain::seconds(120_000_000, 3).to_string(), "0.120");
/// ```
pub fn seconds(ns: u64, decimals_min: usize) -> impl fmt::Display {
    Seconds { ns, decimals_min }
}

struct Seconds {
    ns: u64,
    decimals_min: usize,
}

impl fmt::Display for Seconds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (whole, nanos) = (self.ns / 1_000_000_000, self.ns % 1_000_000_000);
        let digits = format!("{nanos:09}");
        // There are no decimals beyond nanoseconds.
        let kept = digits.trim_end_matches('0').len().max(self.decimals_min.min(digits.len()));
        if kept == 0 { write!(f, "{whole}") } else { write!(f, "{whole}.{}", &digits[..kept]) }
    }
}

/// Writes `ns` nanoseconds in the largest unit that leaves a whole number: `10 ms`.
///
/// # Errors
/// Only those of the formatter.
pub(crate) fn write(f: &mut fmt::Formatter<'_>, ns: u64) -> fmt::Result {
    let fitting = UNITS.iter().rev().find(|(unit, _)| ns.is_multiple_of(*unit));
    let (unit, name) = fitting.unwrap_or(&UNITS[0]);
    write!(f, "{} {name}", ns / unit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn times_are_read_exactly() {
        assert_eq!(parse("10ms"), Ok(10_000_000));
        assert_eq!(parse(" 2.5 s "), Ok(2_500_000_000));
        assert_eq!(parse("0.1ms"), Ok(100_000));
        assert_eq!(parse("1_000us"), Ok(1_000_000));
        assert_eq!(parse("1.5h"), Ok(5_400_000_000_000));
        assert_eq!(parse("0s"), Ok(0));
    }

    #[test]
    fn what_is_not_a_time_is_refused_by_its_fault() {
        for text in ["", "10", "ms", "1.ms", "1.2.3ms", "-1ms"] {
            assert!(matches!(parse(text), Err(DurationError::Form(_))), "{text}");
        }
        for text in ["10 sec", "0bananas", "5bananas", "1msx"] {
            assert!(matches!(parse(text), Err(DurationError::Unit { .. })), "{text}");
        }
        for text in ["0.5ns", "99999999999h"] {
            assert!(matches!(parse(text), Err(DurationError::Range(_))), "{text}");
        }
    }

    #[test]
    fn a_signed_time_has_one_sign() {
        assert_eq!(parse_signed(" -2s "), Ok(-2_000_000_000));
        assert_eq!(parse_signed("-0"), Ok(0));
        for text in ["--1s", "-", "0bananas", "-0bananas", "00", "300000000h"] {
            assert!(parse_signed(text).is_err(), "{text}");
        }
    }

    proptest! {
        #[test]
        fn seconds_read_back(ns: u64, decimals_min in 0_usize..12) {
            prop_assert_eq!(parse(&format!("{}s", seconds(ns, decimals_min))), Ok(ns));
        }

        #[test]
        fn signed_seconds_read_back(ns: i64) {
            let sign = if ns < 0 { "-" } else { "" };
            prop_assert_eq!(parse_signed(&format!("{sign}{}s", seconds(ns.unsigned_abs(), 0))), Ok(ns));
        }

        #[test]
        fn reading_never_panics(text in ".*") {
            // The result does not matter here: both are total.
            let _ = (parse(&text), parse_signed(&text));
        }
    }
}
