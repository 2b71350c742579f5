//! Round numbers along an axis, and how they are written.
//!
//! A tick is an integer times a power of ten and stays one up to its label, so that 0.3 is never
//! written 0.30000000000000004. The exponent is read off the number's decimal form, which is exact
//! on every machine; a logarithm is not.

use super::lettering::{TICK_PX, shortened};
use super::range::ValueRange;

/// Beyond this many steps from zero, a double no longer distinguishes ticks.
const STEPS_FROM_ZERO_MAX: f64 = 1e14;

/// So many names have room beside each other on an axis.
const NAMES_MAX: usize = 9;
/// The room of a name.
const NAME_MAX_PX: i64 = 150;

/// Which numbers may be ticks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Numbers {
    Real,
    Whole,
}

/// One mark on an axis.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tick {
    pub(super) value: f64,
    pub(super) label: String,
}

/// The marks of an axis.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Ticks {
    pub(super) marks: Vec<Tick>,
    /// The power of ten that labels have to be multiplied with; 0 in most cases.
    pub(super) exponent: i32,
}

impl Ticks {
    /// About `count` ticks, at most one more, whose distance is 1, 2 or 5 times a power of ten.
    ///
    /// A range in which no such numbers can be distinguished has none.
    pub(super) fn within(range: ValueRange, count: u32, numbers: Numbers) -> Self {
        Self::round(range, count, numbers).unwrap_or_default()
    }

    /// The two ticks of a BOOL.
    pub(super) fn of_bool() -> Self {
        let mark = |value: f64, label: &str| Tick { value, label: label.to_owned() };
        Self { marks: vec![mark(0.0, "0"), mark(1.0, "1")], exponent: 0 }
    }

    /// A tick at each value that has a name; nothing if there are too many to be kept apart.
    pub(super) fn named(range: ValueRange, names: &[(i64, String)]) -> Option<Self> {
        let shown = |(value, _): &&(i64, String)| (range.low..=range.high).contains(&(*value as f64));
        let mut names: Vec<&(i64, String)> = names.iter().filter(shown).collect();
        names.sort();
        names.dedup_by_key(|(value, _)| *value);
        let mark = |(value, name): &(i64, String)| Tick {
            value: *value as f64,
            label: shortened(&format!("{value} {name}"), TICK_PX, NAME_MAX_PX),
        };
        let fits = (1..=NAMES_MAX).contains(&names.len());
        fits.then(|| Self { marks: names.into_iter().map(mark).collect(), exponent: 0 })
    }

    fn round(range: ValueRange, count: u32, numbers: Numbers) -> Option<Self> {
        let count = f64::from(count.max(1));
        let (digit, exponent) = round_up(range.high / count - range.low / count, numbers)?;
        let step = decimal(digit, exponent)?;
        // A step further than the quotients say: they are rounded, the decimals compared below are not.
        let first = (range.low / step).floor() - 1.0;
        let last = (range.high / step).ceil() + 1.0;
        if first.abs().max(last.abs()) > STEPS_FROM_ZERO_MAX || last - first > 2.0 * count + 4.0 {
            return None;
        }
        let inside = |steps: i64| {
            let value = decimal(steps * digit, exponent)?;
            (range.low <= value && value <= range.high).then_some((steps * digit, value))
        };
        let multiples: Vec<(i64, f64)> = (first as i64..=last as i64).filter_map(inside).collect();
        let written = written_exponent(&multiples, exponent);
        let mark = |(multiple, value)| Tick { value, label: label(multiple, exponent - written) };
        Some(Self { marks: multiples.into_iter().map(mark).collect(), exponent: written })
    }
}

/// The smallest 1, 2 or 5 times a power of ten that is not below `length`: digit and exponent.
fn round_up(length: f64, numbers: Numbers) -> Option<(i64, i32)> {
    if !(length.is_finite() && length > 0.0) {
        return None;
    }
    let scientific = format!("{length:e}");
    let (mantissa, exponent) = scientific.split_once('e')?;
    let mantissa: f64 = mantissa.parse().ok()?;
    let exponent: i32 = exponent.parse().ok()?;
    if numbers == Numbers::Whole && exponent < 0 {
        return Some((1, 0));
    }
    Some(match mantissa {
        m if m <= 1.0 => (1, exponent),
        m if m <= 2.0 => (2, exponent),
        m if m <= 5.0 => (5, exponent),
        _ => (1, exponent + 1),
    })
}

/// The double nearest to `multiple` times ten to the `exponent`, if it is one.
fn decimal(multiple: i64, exponent: i32) -> Option<f64> {
    format!("{multiple}e{exponent}").parse().ok().filter(|value: &f64| value.is_finite())
}

/// The power of ten to leave out of labels: none from 0.001 to 999,999, else a multiple of three.
fn written_exponent(multiples: &[(i64, f64)], exponent: i32) -> i32 {
    let largest = multiples.iter().map(|(multiple, _)| multiple.unsigned_abs()).max().unwrap_or(0);
    let Some(digits) = largest.checked_ilog10() else { return 0 };
    let leading = exponent + digits as i32;
    if (-3..=5).contains(&leading) { 0 } else { 3 * leading.div_euclid(3) }
}

/// `multiple` times ten to the `exponent`, with as many decimals as the exponent asks for.
fn label(multiple: i64, exponent: i32) -> String {
    let sign = if multiple < 0 { "\u{2212}" } else { "" };
    let digits = multiple.unsigned_abs().to_string();
    if multiple == 0 && exponent >= 0 {
        return digits;
    }
    let zeros = usize::try_from(exponent).unwrap_or(0);
    let decimals = usize::try_from(exponent.saturating_neg()).unwrap_or(0);
    if decimals == 0 {
        return format!("{sign}{digits}{}", "0".repeat(zeros));
    }
    let padded = format!("{digits:0>width$}", width = decimals + 1);
    let (whole, fraction) = padded.split_at(padded.len() - decimals);
    format!("{sign}{whole}.{fraction}")
}

/// A power of ten as it is written beside a unit: `10⁻³`.
pub(super) fn power_of_ten(exponent: i32) -> String {
    let raised = |c: char| match c {
        '-' => '\u{207b}',
        '1' => '\u{b9}',
        '2' => '\u{b2}',
        '3' => '\u{b3}',
        digit => char::from_u32(0x2070 + digit.to_digit(10).unwrap_or(0)).unwrap_or(digit),
    };
    format!("10{}", exponent.to_string().chars().map(raised).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn labels(low: f64, high: f64, count: u32) -> (String, i32) {
        let ticks = Ticks::within(ValueRange { low, high }, count, Numbers::Real);
        let labels: Vec<String> = ticks.marks.into_iter().map(|mark| mark.label).collect();
        (labels.join(" "), ticks.exponent)
    }

    #[test]
    fn labels_are_round_and_equally_precise() {
        assert_eq!(labels(0.0, 0.6, 6), ("0.0 0.1 0.2 0.3 0.4 0.5 0.6".to_owned(), 0));
        assert_eq!(labels(-1.06, 1.06, 4), ("\u{2212}1 0 1".to_owned(), 0));
        assert_eq!(labels(0.0, 1200.0, 8), ("0 200 400 600 800 1000 1200".to_owned(), 0));
        assert_eq!(labels(12.3456, 12.3461, 4), ("12.3456 12.3458 12.3460".to_owned(), 0));
    }

    #[test]
    fn a_common_power_of_ten_replaces_zeros() {
        assert_eq!(labels(0.0, 0.000_04, 4), ("0 10 20 30 40".to_owned(), -6));
        assert_eq!(labels(0.0, 4e7, 4), ("0 10 20 30 40".to_owned(), 6));
        assert_eq!(power_of_ten(-12), "10\u{207b}\u{b9}\u{b2}");
        assert_eq!(power_of_ten(306), "10\u{b3}\u{2070}\u{2076}");
    }

    #[test]
    fn whole_numbers_have_no_ticks_between_them() {
        let ticks = Ticks::within(ValueRange { low: -0.1, high: 1.9 }, 10, Numbers::Whole);
        assert_eq!(ticks.marks.iter().map(|mark| mark.value).collect::<Vec<_>>(), [0.0, 1.0]);
    }

    proptest! {
        #[test]
        fn ticks_lie_in_their_range_in_order(low: f64, high: f64, count in 1_u32..12) {
            let ticks = Ticks::within(ValueRange { low, high }, count, Numbers::Real).marks;
            prop_assert!(ticks.len() <= count as usize + 1);
            prop_assert!(ticks.windows(2).all(|pair| pair[0].value < pair[1].value));
            prop_assert!(ticks.iter().all(|tick| low <= tick.value && tick.value <= high));
        }
    }
}
