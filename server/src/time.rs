//! Virtual time: integer nanoseconds since the session's start. Never a float, never the wall clock.

use std::fmt;
use std::num::NonZeroU64;
use std::ops::{Add, Sub};
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A point in virtual time, `t_v` in seed 004: nanoseconds since the session's start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct VirtualTime(u64);

impl VirtualTime {
    /// The session's start.
    pub const ZERO: Self = Self(0);
    /// The last representable instant, some 584 years after the start.
    pub const MAX: Self = Self(u64::MAX);

    /// The instant `ns` nanoseconds after the session's start.
    pub const fn from_nanos(ns: u64) -> Self {
        Self(ns)
    }

    /// Nanoseconds since the session's start.
    pub const fn as_nanos(self) -> u64 {
        self.0
    }

    /// Seconds since the session's start; for people and plots, never for arithmetic.
    pub fn as_secs_f64(self) -> f64 {
        self.0 as f64 / 1e9
    }

    /// This instant plus a span, `None` past the end of representable time.
    pub const fn checked_add(self, span: TimeSpan) -> Option<Self> {
        match self.0.checked_add(span.as_nanos()) {
            Some(ns) => Some(Self(ns)),
            None => None,
        }
    }

    /// This instant less a span, zero at the earliest.
    pub const fn saturating_sub(self, span: TimeSpan) -> Self {
        Self(self.0.saturating_sub(span.as_nanos()))
    }

    /// True on the grid of `span`: a multiple of it since the session's start.
    pub const fn is_multiple_of(self, span: TimeSpan) -> bool {
        self.0.is_multiple_of(span.as_nanos())
    }
}

impl Add<TimeSpan> for VirtualTime {
    type Output = Self;

    /// Saturates at [`VirtualTime::MAX`]; a session ends before it gets there.
    fn add(self, span: TimeSpan) -> Self {
        Self(self.0.saturating_add(span.as_nanos()))
    }
}

impl Sub for VirtualTime {
    type Output = u64;

    /// Nanoseconds between two instants, zero if `earlier` is the later one.
    fn sub(self, earlier: Self) -> u64 {
        self.0.saturating_sub(earlier.0)
    }
}

impl fmt::Display for VirtualTime {
    /// Seconds with as many decimals as the instant needs, three at least: `0.120 s`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (seconds, nanos) = (self.0 / 1_000_000_000, self.0 % 1_000_000_000);
        let digits = format!("{nanos:09}");
        let kept = digits.trim_end_matches('0').len().max(3);
        write!(f, "{seconds}.{} s", &digits[..kept])
    }
}

/// A non-zero span of virtual time in nanoseconds: a step, a period.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct TimeSpan(NonZeroU64);

impl TimeSpan {
    /// A span of `ns` nanoseconds, `None` for zero.
    pub const fn from_nanos(ns: u64) -> Option<Self> {
        match NonZeroU64::new(ns) {
            Some(ns) => Some(Self(ns)),
            None => None,
        }
    }

    /// A span of `ms` milliseconds, `None` for zero and beyond 584 years.
    pub const fn from_millis(ms: u64) -> Option<Self> {
        match ms.checked_mul(1_000_000) {
            Some(ns) => Self::from_nanos(ns),
            None => None,
        }
    }

    /// The span in nanoseconds.
    pub const fn as_nanos(self) -> u64 {
        self.0.get()
    }

    /// The span in seconds, the `dt` of an integrator.
    pub fn as_secs_f64(self) -> f64 {
        self.0.get() as f64 / 1e9
    }

    /// True if this span is a whole number of `step`s.
    pub const fn is_multiple_of(self, step: Self) -> bool {
        self.as_nanos().is_multiple_of(step.as_nanos())
    }

    /// This span `count` times, `None` for zero and beyond 584 years.
    pub const fn times(self, count: u64) -> Option<Self> {
        match self.as_nanos().checked_mul(count) {
            Some(ns) => Self::from_nanos(ns),
            None => None,
        }
    }
}

impl fmt::Display for TimeSpan {
    /// In the largest unit that leaves a whole number: `10 ms`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ns = self.as_nanos();
        let (unit, name) = UNITS.iter().rev().find(|(unit, _)| ns.is_multiple_of(*unit)).unwrap_or(&UNITS[0]);
        write!(f, "{} {name}", ns / unit)
    }
}

/// The number of a step, counted from 1; 0 is the initial write. It is also the sequence number of
/// the step's grants on the wire.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct StepCount(pub u64);

impl fmt::Display for StepCount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

const UNITS: [(u64, &str); 6] = [
    (1, "ns"),
    (1_000, "us"),
    (1_000_000, "ms"),
    (1_000_000_000, "s"),
    (60_000_000_000, "min"),
    (3_600_000_000_000, "h"),
];

/// Why a text is not a time.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum TimeParseError {
    /// No number with a unit.
    #[error("`{0}` is not a time: write a number and a unit, as in `10ms`, `2.5s` or `1min`")]
    Form(String),
    /// A unit that is none of ours.
    #[error("`{unit}` in `{text}` is not a unit of time: use ns, us, ms, s, min or h")]
    Unit {
        /// The whole text.
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

/// Nanoseconds in `text`, exact: a decimal number and a unit, white space between them allowed.
fn parse_nanos(text: &str) -> Result<u64, TimeParseError> {
    let form = || TimeParseError::Form(text.to_owned());
    let range = || TimeParseError::Range(text.to_owned());
    let trimmed = text.trim();
    let split = trimmed.find(|c: char| !c.is_ascii_digit() && c != '.' && c != '_').ok_or_else(form)?;
    let (number, unit) = (trimmed[..split].replace('_', ""), trimmed[split..].trim());
    let (whole, fraction) = number.split_once('.').unwrap_or((&number, ""));
    if whole.is_empty() || fraction.contains('.') || (number.ends_with('.')) {
        return Err(form());
    }
    let unit_ns = UNITS
        .iter()
        .find(|(_, name)| *name == unit)
        .map(|(ns, _)| u128::from(*ns))
        .ok_or_else(|| TimeParseError::Unit { text: text.to_owned(), unit: unit.to_owned() })?;
    if fraction.len() > 18 {
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

impl FromStr for VirtualTime {
    type Err = TimeParseError;

    fn from_str(text: &str) -> Result<Self, TimeParseError> {
        parse_nanos(text).map(Self)
    }
}

impl FromStr for TimeSpan {
    type Err = TimeParseError;

    fn from_str(text: &str) -> Result<Self, TimeParseError> {
        Self::from_nanos(parse_nanos(text)?).ok_or_else(|| TimeParseError::Zero(text.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn span(text: &str) -> Result<u64, TimeParseError> {
        text.parse::<TimeSpan>().map(TimeSpan::as_nanos)
    }

    #[test]
    fn times_are_read_exactly() {
        assert_eq!(span("10ms"), Ok(10_000_000));
        assert_eq!(span(" 2.5 s "), Ok(2_500_000_000));
        assert_eq!(span("0.1ms"), Ok(100_000));
        assert_eq!(span("1_000us"), Ok(1_000_000));
        assert_eq!(span("1.5h"), Ok(5_400_000_000_000));
    }

    #[test]
    fn what_is_not_a_time_is_refused_by_its_fault() {
        assert!(matches!(span("10"), Err(TimeParseError::Form(_))));
        assert!(matches!(span("ms"), Err(TimeParseError::Form(_))));
        assert!(matches!(span("1.ms"), Err(TimeParseError::Form(_))));
        assert!(matches!(span("1.2.3ms"), Err(TimeParseError::Form(_))));
        assert!(matches!(span("10 sec"), Err(TimeParseError::Unit { .. })));
        assert!(matches!(span("0.5ns"), Err(TimeParseError::Range(_))));
        assert!(matches!(span("99999999999h"), Err(TimeParseError::Range(_))));
        assert!(matches!(span("0ms"), Err(TimeParseError::Zero(_))));
    }

    #[test]
    fn times_print_for_people() {
        assert_eq!(VirtualTime::from_nanos(120_000_000).to_string(), "0.120 s");
        assert_eq!(VirtualTime::from_nanos(1_000_000_001).to_string(), "1.000000001 s");
        assert_eq!(TimeSpan::from_millis(10).map(|s| s.to_string()), Some("10 ms".to_owned()));
        assert_eq!(TimeSpan::from_nanos(1_500).map(|s| s.to_string()), Some("1500 ns".to_owned()));
    }

    proptest! {
        #[test]
        fn a_printed_span_reads_back(ns in 1u64..) {
            let span = TimeSpan::from_nanos(ns).expect("not zero");
            prop_assert_eq!(span.to_string().parse::<TimeSpan>(), Ok(span));
        }

        #[test]
        fn reading_never_panics(text in ".*") {
            let _ = text.parse::<VirtualTime>();
        }
    }
}
