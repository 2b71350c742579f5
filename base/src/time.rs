//! Virtual time: integer nanoseconds since the session's start. Never a float, never the wall clock.

use std::fmt;
use std::num::NonZeroU64;
use std::ops::{Add, Sub};
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::duration::{DurationError, plain};

/// A point in virtual time, `t_v`: nanoseconds since the session's start.
///
/// ```
/// use onescan_base::{TimeSpan, VirtualTime};
///
/// let step: TimeSpan = "10ms".parse()?;
/// let now = VirtualTime::ZERO + step + step;
/// assert_eq!(now, VirtualTime::from_nanos(20_000_000));
/// assert_eq!(now.to_string(), "0.020 s");
/// # Ok::<(), onescan_base::duration::DurationError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct VirtualTime(u64);

impl VirtualTime {
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
    #[must_use]
    pub const fn checked_add(self, span: TimeSpan) -> Option<Self> {
        match self.0.checked_add(span.as_nanos()) {
            Some(ns) => Some(Self(ns)),
            None => None,
        }
    }

    /// This instant less a span, zero at the earliest.
    #[must_use]
    pub const fn saturating_sub(self, span: TimeSpan) -> Self {
        Self(self.0.saturating_sub(span.as_nanos()))
    }

    /// True on the grid of `span`: a multiple of it since the session's start.
    ///
    /// ```
    /// # use onescan_base::{TimeSpan, VirtualTime};
    /// let step = TimeSpan::from_millis(10).expect("not zero");
    /// assert!(VirtualTime::from_nanos(30_000_000).is_multiple_of(step));
    /// assert!(!VirtualTime::from_nanos(35_000_000).is_multiple_of(step));
    /// ```
    pub const fn is_multiple_of(self, span: TimeSpan) -> bool {
        self.0.is_multiple_of(span.as_nanos())
    }

    /// The first instant after `now` on the grid that goes through this instant in steps of `span`; this instant
    /// itself if it is later than `now`. `None` past the end of representable time.
    ///
    /// ```
    /// # use onescan_base::{TimeSpan, VirtualTime};
    /// let at = VirtualTime::from_nanos;
    /// let ten = TimeSpan::from_nanos(10).expect("not zero");
    /// assert_eq!(at(5).next_after(at(4), ten), Some(at(5)));
    /// assert_eq!(at(5).next_after(at(5), ten), Some(at(15)));
    /// assert_eq!(at(5).next_after(at(36), ten), Some(at(45)));
    /// ```
    #[must_use]
    pub const fn next_after(self, now: Self, span: TimeSpan) -> Option<Self> {
        if self.0 > now.0 {
            return Some(self);
        }
        // The last instant on the grid that is not later than `now`.
        let last = now.0 - (now.0 - self.0) % span.as_nanos();
        Self(last).checked_add(span)
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
        write!(f, "{} s", plain::seconds(self.0, 3))
    }
}

impl FromStr for VirtualTime {
    type Err = DurationError;

    fn from_str(text: &str) -> Result<Self, DurationError> {
        plain::parse(text).map(Self)
    }
}

/// A non-zero span of virtual time in nanoseconds: a step, a period, the interval of a task.
///
/// ```
/// use onescan_base::TimeSpan;
///
/// let span: TimeSpan = "2.5 ms".parse()?;
/// assert_eq!(span.as_nanos(), 2_500_000);
/// assert_eq!(span.to_string(), "2500 us");
/// assert!("0ms".parse::<TimeSpan>().is_err());
/// # Ok::<(), onescan_base::duration::DurationError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct TimeSpan(NonZeroU64);

impl TimeSpan {
    /// A span of `ns` nanoseconds, `None` for zero.
    #[must_use]
    pub const fn from_nanos(ns: u64) -> Option<Self> {
        match NonZeroU64::new(ns) {
            Some(ns) => Some(Self(ns)),
            None => None,
        }
    }

    /// A span of `MS` milliseconds that is known when the program is built; 0 does not compile.
    ///
    /// ```
    /// # use onescan_base::TimeSpan;
    /// const CYCLE: TimeSpan = TimeSpan::millis::<10>();
    /// assert_eq!(CYCLE.to_string(), "10 ms");
    /// ```
    #[must_use]
    pub const fn millis<const MS: u64>() -> Self {
        const { Self::from_millis(MS).expect("a span is not zero and fits 584 years") }
    }

    /// A span of `NS` nanoseconds that is known when the program is built; 0 does not compile.
    #[must_use]
    pub const fn nanos<const NS: u64>() -> Self {
        const { Self::from_nanos(NS).expect("a span is not zero") }
    }

    /// A span of `us` microseconds, `None` for zero and beyond 584 years.
    #[must_use]
    pub const fn from_micros(us: u64) -> Option<Self> {
        match us.checked_mul(1_000) {
            Some(ns) => Self::from_nanos(ns),
            None => None,
        }
    }

    /// A span of `ms` milliseconds, `None` for zero and beyond 584 years.
    #[must_use]
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
    #[must_use]
    pub const fn times(self, count: u64) -> Option<Self> {
        match self.as_nanos().checked_mul(count) {
            Some(ns) => Self::from_nanos(ns),
            None => None,
        }
    }

    /// The greatest span of which both are whole multiples: tasks of these intervals are due only at multiples of it.
    ///
    /// ```
    /// # use onescan_base::TimeSpan;
    /// let ms = |count| TimeSpan::from_millis(count).expect("not zero");
    /// assert_eq!(ms(10).common_divisor(ms(15)), ms(5));
    /// ```
    #[must_use]
    pub const fn common_divisor(self, other: Self) -> Self {
        let (mut divisor, mut rest) = (self.0, other.0.get());
        while let Some(next) = NonZeroU64::new(rest) {
            rest = divisor.get() % next.get();
            divisor = next;
        }
        Self(divisor)
    }
}

impl fmt::Display for TimeSpan {
    /// In the largest unit that leaves a whole number: `10 ms`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        plain::write(f, self.as_nanos())
    }
}

impl FromStr for TimeSpan {
    type Err = DurationError;

    fn from_str(text: &str) -> Result<Self, DurationError> {
        Self::from_nanos(plain::parse(text)?).ok_or_else(|| DurationError::Zero(text.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn times_print_for_people() {
        assert_eq!(VirtualTime::from_nanos(120_000_000).to_string(), "0.120 s");
        assert_eq!(VirtualTime::from_nanos(1_000_000_001).to_string(), "1.000000001 s");
        assert_eq!(TimeSpan::from_millis(10).map(|s| s.to_string()), Some("10 ms".to_owned()));
        assert_eq!(TimeSpan::from_nanos(1_500).map(|s| s.to_string()), Some("1500 ns".to_owned()));
    }

    #[test]
    fn a_span_is_not_zero() {
        assert_eq!("0ms".parse::<TimeSpan>(), Err(DurationError::Zero("0ms".to_owned())));
        assert_eq!("0ms".parse(), Ok(VirtualTime::ZERO));
        assert_eq!([TimeSpan::from_nanos(0), TimeSpan::from_millis(u64::MAX)], [None, None]);
    }

    proptest! {
        #[test]
        fn a_printed_span_reads_back(ns in 1u64..) {
            let span = TimeSpan::from_nanos(ns).expect("not zero");
            prop_assert_eq!(span.to_string().parse::<TimeSpan>(), Ok(span));
        }

        #[test]
        fn a_printed_instant_reads_back(ns: u64) {
            let instant = VirtualTime::from_nanos(ns);
            prop_assert_eq!(instant.to_string().parse::<VirtualTime>(), Ok(instant));
        }

        #[test]
        fn a_common_divisor_divides_both_and_is_symmetric(a in 1u64.., b in 1u64..) {
            let (a, b) = (TimeSpan::from_nanos(a).expect("not zero"), TimeSpan::from_nanos(b).expect("not zero"));
            let common = a.common_divisor(b);
            prop_assert!(a.is_multiple_of(common) && b.is_multiple_of(common));
            prop_assert_eq!(common, b.common_divisor(a));
        }

        #[test]
        fn the_next_instant_on_a_grid_is_later_and_within_one_span(due: u32, now: u32, span in 1u32..) {
            let (due, now) = (VirtualTime::from_nanos(due.into()), VirtualTime::from_nanos(now.into()));
            let span = TimeSpan::from_nanos(span.into()).expect("not zero");
            let next = due.next_after(now, span).expect("far from the end of time");
            prop_assert!(next > now && next >= due);
            prop_assert!(next == due || next - now <= span.as_nanos());
            prop_assert_eq!((next - due) % span.as_nanos(), 0);
        }
    }
}
