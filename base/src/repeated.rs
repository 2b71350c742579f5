//! Events that others cause as often as they like: each kind is reported the first time, and then the 10th, the 100th and
//! so on. So nobody fills a log by connecting again and again, and how often it happened is in it all the same.

use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering};

/// How often something has happened.
#[derive(Debug, Default)]
pub struct Repeated(AtomicU64);

/// The number of an event that is to be reported; as text what follows its report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Times(u64);

impl Repeated {
    /// It has not happened yet.
    #[must_use]
    pub const fn new() -> Self {
        Self(AtomicU64::new(0))
    }

    /// It happens once more; gives its number if that is to be reported.
    pub fn again(&self) -> Option<Times> {
        let number = self.0.fetch_add(1, Ordering::Relaxed).saturating_add(1);
        (10_u64.pow(number.ilog10()) == number).then_some(Times(number))
    }
}

impl fmt::Display for Times {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            1 => Ok(()),
            times => write!(f, " ({times} times by now; reported again after {} times)", times.saturating_mul(10)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thousand_events_are_four_reports() {
        let repeated = Repeated::new();
        let reports: Vec<_> = (0..1_000).filter_map(|_| repeated.again()).map(|times| times.to_string()).collect();
        let later = |times: u32| format!(" ({times} times by now; reported again after {} times)", 10 * times);
        assert_eq!(reports, [String::new(), later(10), later(100), later(1_000)]);
    }
}
