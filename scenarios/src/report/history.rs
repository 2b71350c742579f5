//! Histories: the lowest, the mean and the highest value of signals in each of equal windows of virtual time.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use onescan_server::time::TimeSpan;

use super::held::{Held, Seen};
use super::windows::{Content, Windows};

/// What has a history, by name.
#[derive(Clone, Debug)]
pub(super) struct Past {
    pub(super) name: String,
    /// Width of a window; one that suits the run if absent.
    pub(super) every: Option<TimeSpan>,
    pub(super) seen: Vec<Seen>,
}

/// The history of signals. Its JSON form is a contract: fields are added, never changed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HistoryReport {
    /// Its name in the scenario, unique among histories.
    pub name: String,
    /// Width of a window in nanoseconds of virtual time. The last one ends with the run.
    pub window_ns: u64,
    /// Its signals, in the order of the scenario.
    pub signals: Vec<SignalHistory>,
}

/// The history of one signal: a value a window, from the beginning of the report on. A window in which the signal was
/// never a finite number has none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SignalHistory {
    /// The signal.
    pub signal: String,
    /// The unit of its values; absent if it has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// The lowest value in each window.
    pub min: Vec<Option<f64>>,
    /// The mean over time in each window.
    pub mean: Vec<Option<f64>>,
    /// The highest value in each window.
    pub max: Vec<Option<f64>>,
}

/// Values in a window.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Stretch {
    /// The lowest and the highest; nothing before one has held.
    bounds: Option<(f64, f64)>,
    /// Each value times how long it held, s.
    sum: f64,
    held_ns: u64,
}

impl Stretch {
    fn hold(&mut self, value: f64, length_ns: u64) {
        let (low, high) = self.bounds.unwrap_or((value, value));
        self.bounds = Some((low.min(value), high.max(value)));
        self.sum += value * seconds(length_ns);
        self.held_ns += length_ns;
    }

    /// Lowest, mean and highest.
    fn values(&self) -> Option<[f64; 3]> {
        let (low, high) = self.bounds?;
        // a mean of equal values is this value, whatever has been rounded
        Some([low, (self.sum / seconds(self.held_ns)).clamp(low, high), high])
    }
}

impl Content for Stretch {
    fn add(&mut self, next: &Self) {
        self.bounds = match (self.bounds, next.bounds) {
            (Some((low, high)), Some((lower, higher))) => Some((low.min(lower), high.max(higher))),
            (bounds, others) => bounds.or(others),
        };
        self.sum += next.sum;
        self.held_ns += next.held_ns;
    }
}

fn seconds(length_ns: u64) -> f64 {
    length_ns as f64 / 1e9
}

/// A history while the run goes.
#[derive(Clone, Debug)]
pub(super) struct History {
    past: Past,
    signals: Vec<(Held, Windows<Stretch>)>,
}

impl History {
    pub(super) fn new(past: Past, begin_ns: u64, step: TimeSpan) -> Self {
        let signals = past.seen.iter().map(|_| (Held::default(), Windows::new(begin_ns, past.every, step))).collect();
        Self { past, signals }
    }

    /// Takes the image of `t_ns`.
    pub(super) fn push(&mut self, t_ns: u64, values: &[f64]) {
        for (seen, (held, windows)) in self.past.seen.iter().zip(&mut self.signals) {
            if let Some((value, from_ns)) = held.push(t_ns, seen.value(values)) {
                hold(windows, value, (from_ns, t_ns));
            }
        }
    }

    /// What there is at the end of a run.
    pub(super) fn until(&self, end_ns: u64) -> HistoryReport {
        let ended = self.signals.iter().map(|(held, windows)| {
            let mut all = windows.until(end_ns);
            if let Some((value, from_ns)) = held.value() {
                hold(&mut all, value, (from_ns, end_ns));
            }
            all
        });
        let ended: Vec<Windows<Stretch>> = ended.collect();
        let signal = |(seen, windows): (&Seen, &Windows<Stretch>)| {
            let values: Vec<Option<[f64; 3]>> = windows.contents().iter().map(Stretch::values).collect();
            let each = |place: usize| values.iter().map(|values| values.map(|values| values[place])).collect();
            let [min, mean, max] = [0, 1, 2].map(each);
            SignalHistory { signal: seen.signal.clone(), unit: seen.unit.clone(), min, mean, max }
        };
        HistoryReport {
            name: self.past.name.clone(),
            window_ns: ended.first().map_or(0, Windows::width_ns),
            signals: self.past.seen.iter().zip(&ended).map(signal).collect(),
        }
    }
}

/// A value holds over a span; what is not finite is not a value.
fn hold(windows: &mut Windows<Stretch>, value: f64, (from_ns, to_ns): (u64, u64)) {
    for (stretch, length_ns) in windows.within(from_ns, to_ns) {
        if value.is_finite() {
            stretch.hold(value, length_ns);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::windows::WINDOWS_GIVEN_MAX;

    const STEP: TimeSpan = TimeSpan::millis::<10>();

    fn history(every_ns: u64) -> History {
        let seen = Seen { signal: "T".to_owned(), unit: None, column: 0, factor: (1.0, 1.0) };
        let past = Past { name: "past".to_owned(), every: TimeSpan::from_nanos(every_ns), seen: vec![seen] };
        History::new(past, 0, STEP)
    }

    fn of(history: &History, end_ns: u64) -> (u64, SignalHistory) {
        let HistoryReport { window_ns, mut signals, .. } = history.until(end_ns);
        (window_ns, signals.remove(0))
    }

    #[test]
    fn a_ramp_has_its_closed_form_in_each_window() {
        // T = k from 10k to 10(k+1) ns: in a window of 100 ns ten values from 10 w to 10 w + 9
        let mut history = history(100);
        for k in 0..50_u32 {
            history.push(u64::from(k) * 10, &[f64::from(k)]);
        }
        let (window_ns, signal) = of(&history, 500);
        assert_eq!((window_ns, signal.min.len()), (100, 5));
        for window in 0..5 {
            let low = 10.0 * window as f64;
            assert_eq!((signal.min[window], signal.max[window]), (Some(low), Some(low + 9.0)));
            assert!((signal.mean[window].expect("values") - (low + 4.5)).abs() < 1e-12);
        }
    }

    #[test]
    fn a_value_counts_as_long_as_it_holds() {
        let mut history = history(100);
        history.push(0, &[2.0]);
        history.push(75, &[6.0]);
        history.push(250, &[9.0]);
        // 9 has come with the last image and has not held yet
        let (_, signal) = of(&history, 250);
        assert_eq!(signal.mean, [Some(3.0), Some(6.0), Some(6.0)]);
        assert_eq!((signal.min[0], signal.max[0], signal.max[2]), (Some(2.0), Some(6.0), Some(6.0)));
    }

    #[test]
    fn what_is_not_a_number_is_left_out() {
        let mut history = history(100);
        for (t_ns, value) in [(0, f64::NAN), (150, 4.0), (175, f64::INFINITY), (300, f64::NAN)] {
            history.push(t_ns, &[value]);
        }
        let (_, signal) = of(&history, 400);
        assert_eq!(signal.mean, [None, Some(4.0), None, None]);
    }

    #[test]
    fn a_run_without_length_has_no_window_and_a_window_longer_than_it_is_one() {
        let mut one = history(100);
        one.push(0, &[1.0]);
        assert_eq!(of(&one, 0).1.mean, [] as [Option<f64>; 0]);
        let mut wide = history(u64::MAX);
        wide.push(0, &[1.0]);
        assert_eq!(of(&wide, 10).1.mean, [Some(1.0)]);
    }

    #[test]
    fn what_is_kept_does_not_grow_with_the_run() {
        let mut history = history(100);
        for k in 0..1_000_000_u64 {
            history.push(k * 100, &[if k % 2 == 0 { 1.0 } else { 3.0 }]);
        }
        let (window_ns, signal) = of(&history, 100_000_000);
        assert!(signal.mean.len() <= WINDOWS_GIVEN_MAX && window_ns == 102_400, "{window_ns}");
        assert!(signal.mean[..976].iter().flatten().all(|mean| (mean - 2.0).abs() < 1e-9), "{:?}", signal.mean);
    }
}
