//! Equal windows of virtual time, each with something in it.
//!
//! A run may be of any length, and nobody knows it before. So windows become wider when there are too many of them:
//! neighbours are added up, and what is kept never grows.

use onescan_server::time::TimeSpan;

pub(super) const SECOND_NS: u64 = 1_000_000_000;
pub(super) const HOUR_NS: u64 = 3600 * SECOND_NS;
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
pub(super) const WINDOWS_MAX: usize = 120;
/// So many windows of a width that the scenario gives: the minutes of a day, the days of nearly four years.
pub(super) const WINDOWS_GIVEN_MAX: usize = 1440;
/// A window has so many steps at least, unless the scenario gives its width.
const STEPS_MIN: u64 = 10;

/// What a window has in it: nothing by default.
pub(super) trait Content: Clone + Default {
    /// This and what the next window has.
    fn add(&mut self, next: &Self);
}

impl Content for u64 {
    fn add(&mut self, next: &Self) {
        *self = self.saturating_add(*next);
    }
}

/// Windows while they fill.
#[derive(Clone, Debug)]
pub(super) struct Windows<C> {
    begin_ns: u64,
    width_ns: u64,
    is_given: bool,
    contents: Vec<C>,
}

impl<C: Content> Windows<C> {
    /// Windows of the given width, else of one that suits the step.
    pub(super) fn new(begin_ns: u64, given: Option<TimeSpan>, step: TimeSpan) -> Self {
        let least_ns = step.as_nanos().saturating_mul(STEPS_MIN);
        let fitting = || WIDTHS_NS.into_iter().find(|width_ns| *width_ns >= least_ns).unwrap_or(least_ns);
        let width_ns = given.map_or_else(fitting, TimeSpan::as_nanos);
        Self { begin_ns, width_ns, is_given: given.is_some(), contents: Vec::new() }
    }

    /// How wide a window is, ns.
    pub(super) fn width_ns(&self) -> u64 {
        self.width_ns
    }

    /// What the windows have, from the first on.
    pub(super) fn contents(&self) -> &[C] {
        &self.contents
    }

    /// The window in which the step lies that ends at `t_ns`: the end of a window belongs to it, its beginning does not.
    pub(super) fn at(&mut self, t_ns: u64) -> Option<&mut C> {
        let window = self.reach(t_ns);
        self.contents.get_mut(window)
    }

    /// The windows that a span of time touches, each with how long it does, ns.
    pub(super) fn within(&mut self, from_ns: u64, to_ns: u64) -> impl Iterator<Item = (&mut C, u64)> {
        let last = if to_ns > from_ns { self.reach(to_ns) + 1 } else { 0 };
        let (begin_ns, width_ns) = (self.begin_ns, self.width_ns);
        let first = usize::try_from(from_ns.saturating_sub(begin_ns) / width_ns).unwrap_or(usize::MAX);
        let touched = match self.contents.get_mut(first..last) {
            Some(touched) => touched,
            None => &mut [],
        };
        (first as u64..).zip(touched).map(move |(window, content)| {
            let starts_ns = begin_ns.saturating_add(window.saturating_mul(width_ns));
            let ends_ns = starts_ns.saturating_add(width_ns);
            (content, to_ns.min(ends_ns).saturating_sub(from_ns.max(starts_ns)))
        })
    }

    /// The same at the end of a run: all windows up to it, also those with nothing.
    pub(super) fn until(&self, end_ns: u64) -> Self {
        let mut all = self.clone();
        if end_ns > all.begin_ns {
            all.reach(end_ns);
        }
        all
    }

    /// The window of `t_ns`, after making room for it.
    fn reach(&mut self, t_ns: u64) -> usize {
        loop {
            let window = t_ns.saturating_sub(self.begin_ns).saturating_sub(1) / self.width_ns;
            let max = if self.is_given { WINDOWS_GIVEN_MAX } else { WINDOWS_MAX };
            match usize::try_from(window) {
                Ok(window) if window < max => {
                    if self.contents.len() <= window {
                        self.contents.resize(window + 1, C::default());
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
        let together = |windows: &[C]| {
            let mut sum = C::default();
            for window in windows {
                sum.add(window);
            }
            sum
        };
        self.contents = self.contents.chunks(times as usize).map(together).collect();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP: TimeSpan = TimeSpan::millis::<10>();

    fn windows(begin_ns: u64, given_ns: u64) -> Windows<u64> {
        Windows::new(begin_ns, TimeSpan::from_nanos(given_ns), STEP)
    }

    fn add(windows: &mut Windows<u64>, t_ns: u64) {
        *windows.at(t_ns).expect("room") += 1;
    }

    #[test]
    fn the_end_of_a_window_belongs_to_it() {
        let mut windows = windows(5, 10);
        for t_ns in [6, 15, 16, 36] {
            add(&mut windows, t_ns);
        }
        assert_eq!((windows.width_ns(), windows.until(36).contents()), (10, &[2, 1, 0, 1][..]));
        assert_eq!(windows.until(46).contents().len(), 5, "empty windows are windows");
        assert!(self::windows(5, 0).until(5).contents().is_empty());
    }

    #[test]
    fn a_span_is_shared_among_the_windows_that_it_touches() {
        let mut windows = windows(5, 10);
        let mut shared = |from_ns, to_ns| {
            windows.within(from_ns, to_ns).for_each(|(content, length_ns)| *content += length_ns);
            windows.contents().to_vec()
        };
        assert_eq!(shared(8, 8), [] as [u64; 0]);
        assert_eq!(shared(8, 15), [7]);
        assert_eq!(shared(15, 40), [7, 10, 10, 5]);
        assert_eq!(shared(41, 42), [7, 10, 10, 6]);
        // wider windows, as there would be too many: nothing is lost
        assert_eq!(shared(42, 20_005).iter().sum::<u64>(), 33 + 19_963);
        assert_eq!((windows.width_ns(), windows.contents().len()), (20, 1000));
    }

    #[test]
    fn windows_widen_as_the_run_goes_and_nothing_is_lost() {
        let mut windows = windows(0, 0);
        for second in 1..=3600 {
            add(&mut windows, second * SECOND_NS);
        }
        let hour = windows.until(HOUR_NS);
        assert_eq!((hour.width_ns(), hour.contents()), (60 * SECOND_NS, &[60; 60][..]));
        for end_ns in [876_000 * HOUR_NS, u64::MAX] {
            let long = windows.until(end_ns);
            assert!(long.contents().len() <= WINDOWS_MAX && long.contents().iter().sum::<u64>() == 3600, "{long:?}");
        }
    }

    #[test]
    fn each_width_is_a_multiple_of_the_one_before() {
        assert!(WIDTHS_NS.windows(2).all(|pair| pair[1].is_multiple_of(pair[0]) && pair[1] > pair[0]));
    }

    #[test]
    fn a_slow_step_has_wide_windows() {
        let slow = TimeSpan::millis::<250>();
        assert_eq!(Windows::<u64>::new(0, None, slow).until(1).width_ns(), 10 * SECOND_NS);
    }
}
