//! `1d2h3m4s5ms6us7ns`: the body of a duration literal of IEC 61131-3 (2nd ed. 2.2.3.1), behind `T#` or `LT#`.

use std::fmt;
use std::str::FromStr;

use thiserror::Error;

/// The units in the order that the standard wants, the greatest first, with their nanoseconds.
const UNITS: [(&str, u64); 7] = [
    ("d", 86_400_000_000_000),
    ("h", 3_600_000_000_000),
    ("m", 60_000_000_000),
    ("s", 1_000_000_000),
    ("ms", 1_000_000),
    ("us", 1_000),
    ("ns", 1),
];

/// A duration in nanoseconds, in the standard's text form.
///
/// It prints every unit that is not 0, the greatest first. Before reading, cut off the `T#`.
///
/// ```
/// use onescan_base::duration::IecDuration;
///
/// let duration: IecDuration = "1.5s".parse()?;
/// assert_eq!(duration.nanos(), 1_500_000_000);
/// assert_eq!(format!("T#{duration}"), "T#1s500ms");
/// assert_eq!(format!("T#{}", duration.in_millis()), "T#1500ms");
/// # Ok::<(), onescan_base::duration::IecDurationError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct IecDuration(i64);

impl IecDuration {
    /// A duration of `ns` nanoseconds.
    pub const fn from_nanos(ns: i64) -> Self {
        Self(ns)
    }

    /// The nanoseconds.
    pub const fn nanos(self) -> i64 {
        self.0
    }

    /// The nanoseconds of a duration that has no sign, and so may be twice as long.
    ///
    /// ```
    /// use onescan_base::duration::IecDuration;
    ///
    /// let longest = "213503d23h34m33s709ms551us615ns";
    /// assert!(longest.parse::<IecDuration>().is_err());
    /// assert_eq!(IecDuration::unsigned_nanos(longest), Ok(u64::MAX));
    /// assert_eq!(IecDuration::display_unsigned(u64::MAX).to_string(), longest);
    /// ```
    ///
    /// # Errors
    /// It is none, or too long.
    pub fn unsigned_nanos(text: &str) -> Result<u64, IecDurationError> {
        u64::try_from(total(text)?).map_err(|_| IecDurationError::TooLong)
    }

    /// The text of a duration that has no sign.
    pub fn display_unsigned(ns: u64) -> impl fmt::Display {
        Units(ns)
    }

    /// The duration as milliseconds only, with a fraction where it needs one: `1500ms`, `0.25ms`. Some tools read
    /// only one unit.
    pub fn in_millis(self) -> impl fmt::Display {
        InMillis(self.0)
    }
}

struct InMillis(i64);

impl fmt::Display for InMillis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (sign, ns) = (if self.0 < 0 { "-" } else { "" }, self.0.unsigned_abs());
        write!(f, "{sign}{}", ns / 1_000_000)?;
        let fraction = format!("{:06}", ns % 1_000_000);
        match fraction.trim_end_matches('0') {
            "" => f.write_str("ms"),
            fraction => write!(f, ".{fraction}ms"),
        }
    }
}

impl fmt::Display for IecDuration {
    /// `1h30m`, `-2ms`; zero is `0s`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0 < 0 {
            f.write_str("-")?;
        }
        Units(self.0.unsigned_abs()).fmt(f)
    }
}

/// So many nanoseconds, in every unit that is not 0.
struct Units(u64);

impl fmt::Display for Units {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0 == 0 {
            return f.write_str("0s");
        }
        let mut rest = self.0;
        for (name, unit) in UNITS {
            if rest >= unit {
                write!(f, "{}{name}", rest / unit)?;
                rest %= unit;
            }
        }
        Ok(())
    }
}

/// Why a text is not the body of a duration literal.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum IecDurationError {
    /// A number without a unit behind it.
    #[error("unit is missing")]
    NoUnit,
    /// A unit that the standard does not have.
    #[error("`{0}` is not a unit of time")]
    UnknownUnit(String),
    /// A unit behind a smaller one, or behind itself.
    #[error("unit `{0}` is out of order")]
    Order(String),
    #[error("duration is empty")]
    Empty,
    /// More than 64 bits of nanoseconds.
    #[error("duration is too long")]
    TooLong,
    /// A fraction in front of another part.
    #[error("only the last unit may have a fraction")]
    Fraction,
    /// A unit without a number in front of it.
    #[error("number is missing")]
    NoNumber,
    /// Something else than digits.
    #[error("`{0}` is not a number")]
    Number(String),
    /// A leading, trailing or double underscore.
    #[error("an underscore stands between two digits only")]
    Underscore,
}

impl FromStr for IecDuration {
    type Err = IecDurationError;

    /// Only the last unit may have a fraction; what it has below a nanosecond is cut off.
    fn from_str(text: &str) -> Result<Self, IecDurationError> {
        i64::try_from(total(text)?).map(Self).map_err(|_| IecDurationError::TooLong)
    }
}

/// The nanoseconds of a text.
fn total(text: &str) -> Result<i128, IecDurationError> {
    let lower = text.to_ascii_lowercase();
    let (negative, mut rest) = lower.strip_prefix('-').map_or((false, &*lower), |rest| (true, rest));
    rest = rest.strip_prefix('+').unwrap_or(rest);
    let mut total: i128 = 0;
    let mut last_unit = None;
    while !rest.is_empty() {
        let end = rest.find(|first: char| first.is_ascii_alphabetic()).ok_or(IecDurationError::NoUnit)?;
        let (number, tail) = rest.split_at(end);
        let end = tail.find(|first: char| !first.is_ascii_alphabetic()).unwrap_or(tail.len());
        let (unit, tail) = tail.split_at(end);
        let index = UNITS.iter().position(|(name, _)| *name == unit);
        let index = index.ok_or_else(|| IecDurationError::UnknownUnit(unit.to_owned()))?;
        if last_unit.is_some_and(|last| last >= index) {
            return Err(IecDurationError::Order(unit.to_owned()));
        }
        last_unit = Some(index);
        let tail = tail.strip_prefix('_').unwrap_or(tail);
        total = total.saturating_add(scaled(number, UNITS[index].1, tail.is_empty())?);
        rest = tail;
    }
    if last_unit.is_none() {
        return Err(IecDurationError::Empty);
    }
    Ok(if negative { -total } else { total })
}

/// `number` times `unit_ns`, a fraction below a nanosecond cut off.
fn scaled(number: &str, unit_ns: u64, fraction_allowed: bool) -> Result<i128, IecDurationError> {
    let (whole, fraction) = number.split_once('.').unwrap_or((number, ""));
    if !fraction.is_empty() && !fraction_allowed {
        return Err(IecDurationError::Fraction);
    }
    let unit_ns = i128::from(unit_ns);
    let whole: i128 = without_underscores(whole)?.parse().map_err(|_| IecDurationError::NoNumber)?;
    let mut value = whole.checked_mul(unit_ns).ok_or(IecDurationError::TooLong)?;
    let digits = if fraction.is_empty() { String::new() } else { without_underscores(fraction)? };
    if !digits.bytes().all(|digit| digit.is_ascii_digit()) {
        return Err(IecDurationError::Number(number.to_owned()));
    }
    let mut weight = unit_ns;
    for digit in digits.bytes() {
        // Remainders below a nanosecond are beyond the type's resolution.
        weight /= 10;
        value += i128::from(digit.wrapping_sub(b'0')) * weight;
    }
    Ok(value)
}

/// Single underscores between digits mean nothing (2nd ed. 2.2.1).
fn without_underscores(text: &str) -> Result<String, IecDurationError> {
    if text.starts_with('_') || text.ends_with('_') || text.contains("__") {
        return Err(IecDurationError::Underscore);
    }
    Ok(text.replace('_', ""))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn nanos(text: &str) -> Result<i64, IecDurationError> {
        text.parse().map(IecDuration::nanos)
    }

    #[test]
    fn durations_add_their_units() {
        assert_eq!(nanos("1d2h3m4s5ms6us7ns"), Ok(93_784_005_006_007));
        assert_eq!(nanos("1.5s"), Ok(1_500_000_000));
        assert_eq!(nanos("-1s_500ms"), Ok(-1_500_000_000));
        assert_eq!(nanos("25h"), Ok(90_000_000_000_000));
        assert_eq!(nanos("0.0000000009s"), Ok(0));
        assert_eq!(nanos("0.333333333333s"), Ok(333_333_333));
        for wrong in ["", "5", "1.5s2ms", "1ms2s", "1s1s", "1x", "s", "300000d", "1.5.3s"] {
            assert!(nanos(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn durations_print_their_units() {
        let shown = |ns| IecDuration(ns).to_string();
        assert_eq!([0, 5_400_000_000_000, -1_500_000_000].map(shown), ["0s", "1h30m", "-1s500ms"]);
        assert_eq!(shown(i64::MIN), "-106751d23h47m16s854ms775us808ns");
        let in_millis = |ns| IecDuration(ns).in_millis().to_string();
        assert_eq!([0, 10_000_000, 250_000, -1].map(in_millis), ["0ms", "10ms", "0.25ms", "-0.000001ms"]);
    }

    proptest! {
        #[test]
        fn what_is_printed_reads_back(ns: i64) {
            prop_assert_eq!(nanos(&IecDuration(ns).to_string()), Ok(ns));
            prop_assert_eq!(nanos(&IecDuration(ns).in_millis().to_string()), Ok(ns));
        }

        #[test]
        fn reading_never_panics(text in ".*") {
            // The result does not matter here: reading is total.
            let _ = nanos(&text);
        }
    }
}
