//! Throughput: how many in each of equal windows of virtual time.
//!
//! A run may be of any length, and nobody knows it before. So windows become wider when there are too many of them:
//! neighbours are added up, and what is kept never grows.

use onescan_server::time::TimeSpan;
use schemars::JsonSchema;
use serde::Serialize;

const SECOND_NS: u64 = 1_000_000_000;
const HOUR_NS: u64 = 3600 * SECOND_NS;
/// Widths for people; each is a multiple of the one before.
const WIDTHS_NS: [u64; 17] = [
    SECOND_NS / 10,
    SECOND_NS / 5,
    SECOND_NS,
    2 * SECOND_NS,
    10 * SECOND_NS,
    20 * SECOND_NS,
    60 * SECOND_NS,
    120 * SECOND_NS,
    600 * SECOND_NS,
    1200 * SECOND_NS,
    HOUR_NS,
    2 * HOUR_NS,
    10 * HOUR_NS,
    20 * HOUR_NS,
    100 * HOUR_NS,
    1000 * HOUR_NS,
    10_000 * HOUR_NS,
];
/// So many windows of a width that was not asked for: enough for a curve, and each with something in it.
const WINDOWS_MAX: usize = 120;
/// So many windows of a width that the scenario gives: the minutes of a day.
const WINDOWS_GIVEN_MAX: usize = 1440;
/// A window has so many steps at least, unless the scenario gives its width.
const STEPS_MIN: u64 = 10;

/// How many in each of equal windows.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Throughput {
    /// Width of a window in nanoseconds of virtual time. The last one ends with the run.
    pub window_ns: u64,
    /// How many in each window, from the beginning of the report on.
    pub counts: Vec<u64>,
}

/// Windows while they fill.
#[derive(Clone, Debug)]
pub(super) struct Windows {
    begin_ns: u64,
    width_ns: u64,
    is_given: bool,
    counts: Vec<u64>,
}

impl Windows {
    /// Windows of the given width, else of one that suits the step.
    pub(super) fn new(begin_ns: u64, given: Option<TimeSpan>, step: TimeSpan) -> Self {
        let least_ns = step.as_nanos().saturating_mul(STEPS_MIN);
        let fitting = || WIDTHS_NS.into_iter().find(|width_ns| *width_ns >= least_ns).unwrap_or(least_ns);
        let width_ns = given.map_or_else(fitting, TimeSpan::as_nanos);
        Self { begin_ns, width_ns, is_given: given.is_some(), counts: Vec::new() }
    }

    /// Adds what has come with the step that ends at `t_ns`: the end of a window belongs to it, its beginning does not.
    pub(super) fn add(&mut self, t_ns: u64, count: u64) {
        let window = self.reach(t_ns);
        if let Some(counted) = self.counts.get_mut(window) {
            *counted += count;
        }
    }

    /// What there is at the end of a run.
    pub(super) fn until(&self, end_ns: u64) -> Throughput {
        let mut all = self.clone();
        if end_ns > all.begin_ns {
            all.reach(end_ns);
        }
        Throughput { window_ns: all.width_ns, counts: all.counts }
    }

    /// The window of `t_ns`, after making room for it.
    fn reach(&mut self, t_ns: u64) -> usize {
        loop {
            let window = t_ns.saturating_sub(self.begin_ns).saturating_sub(1) / self.width_ns;
            let max = if self.is_given { WINDOWS_GIVEN_MAX } else { WINDOWS_MAX };
            match usize::try_from(window) {
                Ok(window) if window < max => {
                    if self.counts.len() <= window {
                        self.counts.resize(window + 1, 0);
                    }
                    return window;
                }
                _ => self.widen(),
            }
        }
    }

    fn widen(&mut self) {
        let wider = WIDTHS_NS.into_iter().find(|width_ns| *width_ns > self.width_ns);
        let times = match wider {
            Some(wider_ns) if !self.is_given && wider_ns.is_multiple_of(self.width_ns) => wider_ns / self.width_ns,
            _ => 2,
        };
        self.width_ns = self.width_ns.saturating_mul(times);
        self.counts = self.counts.chunks(times as usize).map(|windows| windows.iter().sum()).collect();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP: TimeSpan = TimeSpan::millis::<10>();

    #[test]
    fn the_end_of_a_window_belongs_to_it() {
        let mut windows = Windows::new(5, TimeSpan::from_nanos(10), STEP);
        for t_ns in [6, 15, 16, 36] {
            windows.add(t_ns, 1);
        }
        assert_eq!(windows.until(36), Throughput { window_ns: 10, counts: vec![2, 1, 0, 1] });
        assert_eq!(windows.until(46).counts.len(), 5, "empty windows are windows");
        assert!(Windows::new(5, None, STEP).until(5).counts.is_empty());
    }

    #[test]
    fn windows_widen_as_the_run_goes_and_nothing_is_lost() {
        let mut windows = Windows::new(0, None, STEP);
        for second in 1..=3600 {
            windows.add(second * SECOND_NS, 1);
        }
        let hour = windows.until(HOUR_NS);
        assert_eq!((hour.window_ns, hour.counts), (60 * SECOND_NS, vec![60; 60]));
        let century = windows.until(876_000 * HOUR_NS);
        assert!(century.counts.len() <= WINDOWS_MAX && century.counts.iter().sum::<u64>() == 3600, "{century:?}");
        let endless = windows.until(u64::MAX);
        assert!(endless.counts.len() <= WINDOWS_MAX && endless.counts.iter().sum::<u64>() == 3600, "{endless:?}");
    }

    #[test]
    fn each_width_is_a_multiple_of_the_one_before() {
        assert!(WIDTHS_NS.windows(2).all(|pair| pair[1].is_multiple_of(pair[0]) && pair[1] > pair[0]));
    }

    #[test]
    fn a_slow_step_has_wide_windows() {
        let slow = TimeSpan::millis::<250>();
        assert_eq!(Windows::new(0, None, slow).until(1).window_ns, 10 * SECOND_NS);
    }
}
