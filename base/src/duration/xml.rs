//! `PT0.02S`: a duration as XML Schema has it (`xs:duration`), in PLCopen XML. Days and longer units are not used
//! there: their length in time is not fixed, or not needed for an interval.

use std::fmt;
use std::str::FromStr;

use thiserror::Error;

use super::plain;

/// A duration in nanoseconds, in the text form of XML Schema.
///
/// ```
/// use onescan_base::duration::XmlDuration;
///
/// let duration: XmlDuration = "PT1M0.5S".parse()?;
/// assert_eq!(duration.nanos(), 60_500_000_000);
/// assert_eq!(duration.to_string(), "PT60.5S");
/// # Ok::<(), onescan_base::duration::xml::NotXmlDuration>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct XmlDuration(u64);

/// A text that is not a duration of hours, minutes and seconds.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("`{0}` is not a duration of XML Schema in hours, minutes and seconds, as in `PT0.02S`")]
pub struct NotXmlDuration(pub String);

impl XmlDuration {
    /// A duration of `ns` nanoseconds.
    pub const fn from_nanos(ns: u64) -> Self {
        Self(ns)
    }

    /// The nanoseconds.
    pub const fn nanos(self) -> u64 {
        self.0
    }
}

impl fmt::Display for XmlDuration {
    /// In seconds only: `PT90.5S`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "PT{}S", plain::seconds(self.0, 0))
    }
}

impl FromStr for XmlDuration {
    type Err = NotXmlDuration;

    /// What it has below a nanosecond is cut off.
    fn from_str(text: &str) -> Result<Self, NotXmlDuration> {
        nanos(text).map(Self).ok_or_else(|| NotXmlDuration(text.to_owned()))
    }
}

fn nanos(text: &str) -> Option<u64> {
    let mut rest = text.strip_prefix("PT").filter(|rest| !rest.is_empty())?;
    let mut total: u64 = 0;
    while !rest.is_empty() {
        let end = rest.find(|one: char| one.is_ascii_alphabetic())?;
        let (number, unit) = rest.split_at(end);
        let seconds = match unit.chars().next()? {
            'H' => 3600,
            'M' => 60,
            'S' => 1,
            _ => return None,
        };
        let (whole, fraction) = number.split_once('.').unwrap_or((number, ""));
        if !fraction.bytes().all(|digit| digit.is_ascii_digit()) {
            return None;
        }
        let digits = format!("{fraction:0<9}");
        let fraction: u64 = digits.get(..9)?.parse().ok()?;
        let ns = whole.parse::<u64>().ok()?.checked_mul(1_000_000_000)?.checked_add(fraction)?;
        total = total.checked_add(ns.checked_mul(seconds)?)?;
        rest = unit.get(1..)?;
    }
    Some(total)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn hours_minutes_and_seconds_are_read() {
        for (text, ns) in [("PT0.02S", 20_000_000), ("PT1M30S", 90_000_000_000), ("PT1H", 3_600_000_000_000)] {
            assert_eq!(text.parse(), Ok(XmlDuration(ns)), "{text}");
        }
        for text in ["", "PT", "T#20ms", "PTxS", "PT1D", "P1D", "PT1", "PT1.+5S", "PT-1S", "PT99999999999H"] {
            assert!(text.parse::<XmlDuration>().is_err(), "{text}");
        }
    }

    proptest! {
        #[test]
        fn what_is_printed_reads_back(ns: u64) {
            prop_assert_eq!(XmlDuration(ns).to_string().parse(), Ok(XmlDuration(ns)));
        }

        #[test]
        fn reading_never_panics(text in "(PT)?.*") {
            // The result does not matter here: reading is total.
            let _ = nanos(&text);
        }
    }
}
