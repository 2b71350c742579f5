//! Times, counted by their length.
//!
//! Virtual time is a number of whole steps, so times are counted exactly, step by step, as long as there are few different
//! ones. When there are too many, two neighbours become one, and again: what is kept never grows.

use std::collections::BTreeMap;

use onescan_server::time::TimeSpan;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// So many different lengths are distinguished.
const LENGTHS_MAX: usize = 4096;
/// About so many bins in a histogram.
const BINS: u64 = 24;

/// How long something took, in nanoseconds of virtual time.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Times {
    /// The arithmetic mean.
    pub mean_ns: u64,
    /// The standard deviation of the sample, by n - 1; absent for a single time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sigma_ns: Option<u64>,
    /// The shortest.
    pub min_ns: u64,
    /// The shortest time that half of all do not exceed.
    pub median_ns: u64,
    /// The shortest time that 95 % of all do not exceed.
    pub p95_ns: u64,
    /// The longest.
    pub max_ns: u64,
    /// How exactly median, 95 % and histogram are known: a step, unless there were too many different times.
    pub resolution_ns: u64,
}

/// How many times of which length.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Histogram {
    /// Where the first bin begins, in nanoseconds of virtual time.
    pub from_ns: u64,
    /// Width of a bin, in nanoseconds of virtual time. A bin holds its lower edge, not its upper one.
    pub bin_ns: u64,
    /// How many in each bin.
    pub counts: Vec<u64>,
    /// How many are shorter than all bins: a few that lie far away.
    pub shorter: u64,
    /// How many are longer than all bins.
    pub longer: u64,
}

/// Times while they come.
#[derive(Clone, Debug)]
pub(super) struct Distribution {
    /// What the keys of `lengths` are multiples of.
    unit_ns: u64,
    lengths: BTreeMap<u64, u64>,
    count: u64,
    sum_ns: u128,
    least_ns: u64,
    most_ns: u64,
    /// Mean and sum of squared deviations (Welford): nothing is lost where times are long and nearly alike.
    running: (f64, f64),
}

impl Distribution {
    pub(super) fn new(step: TimeSpan) -> Self {
        Self {
            unit_ns: step.as_nanos(),
            lengths: BTreeMap::new(),
            count: 0,
            sum_ns: 0,
            least_ns: u64::MAX,
            most_ns: 0,
            running: (0.0, 0.0),
        }
    }

    pub(super) fn add(&mut self, length_ns: u64) {
        *self.lengths.entry(length_ns / self.unit_ns).or_insert(0) += 1;
        while self.lengths.len() > LENGTHS_MAX {
            self.coarsen();
        }
        self.count += 1;
        self.sum_ns += u128::from(length_ns);
        self.least_ns = self.least_ns.min(length_ns);
        self.most_ns = self.most_ns.max(length_ns);
        let (mean, squares) = &mut self.running;
        let off = length_ns as f64 - *mean;
        *mean += off / self.count as f64;
        *squares += off * (length_ns as f64 - *mean);
    }

    fn coarsen(&mut self) {
        self.unit_ns = self.unit_ns.saturating_mul(2);
        for (length, count) in std::mem::take(&mut self.lengths) {
            *self.lengths.entry(length / 2).or_insert(0) += count;
        }
    }

    pub(super) fn count(&self) -> u64 {
        self.count
    }

    /// Nothing if there is no time.
    pub(super) fn times(&self) -> Option<Times> {
        let count = u128::from(self.count);
        let mean_ns = (self.sum_ns + count / 2).checked_div(count)?;
        let variance = (self.count > 1).then(|| self.running.1.max(0.0) / (self.count - 1) as f64);
        Some(Times {
            mean_ns: u64::try_from(mean_ns).unwrap_or(u64::MAX),
            sigma_ns: variance.map(|variance| variance.sqrt().round() as u64),
            min_ns: self.least_ns,
            median_ns: self.reached_by(50),
            p95_ns: self.reached_by(95),
            max_ns: self.most_ns,
            resolution_ns: self.unit_ns,
        })
    }

    /// The shortest time that so many per cent of all do not exceed.
    fn reached_by(&self, per_cent: u64) -> u64 {
        // The nearest-rank percentile: a time that has occurred, never one between two.
        let rank = (u128::from(self.count) * u128::from(per_cent)).div_ceil(100).max(1);
        let mut seen = 0;
        let reached = self.lengths.iter().find(|(_, count)| {
            seen += u128::from(**count);
            seen >= rank
        });
        let length_ns = reached.map_or(0, |(length, _)| length.saturating_mul(self.unit_ns));
        length_ns.clamp(self.least_ns.min(self.most_ns), self.most_ns)
    }

    /// Nothing if there is no time.
    pub(super) fn histogram(&self) -> Option<Histogram> {
        let (low, high) = self.bulk()?;
        let width = round_up((high - low + 1).div_ceil(BINS));
        let first = low / width;
        let bins = usize::try_from(high / width - first + 1).ok()?;
        let mut histogram = Histogram {
            from_ns: (first * width).saturating_mul(self.unit_ns),
            bin_ns: width.saturating_mul(self.unit_ns),
            counts: vec![0; bins],
            shorter: 0,
            longer: 0,
        };
        for (length, count) in &self.lengths {
            let bin = (length / width).checked_sub(first).map(usize::try_from);
            let counted = match bin {
                None => &mut histogram.shorter,
                Some(bin) => bin.ok().and_then(|bin| histogram.counts.get_mut(bin)).unwrap_or(&mut histogram.longer),
            };
            *counted += count;
        }
        Some(histogram)
    }

    /// The lengths that bins reach over: all of them, without the outermost hundredths where these lie so far away that the
    /// others would share a bin or two.
    fn bulk(&self) -> Option<(u64, u64)> {
        let (least, most) = (*self.lengths.first_key_value()?.0, *self.lengths.last_key_value()?.0);
        let (low, high) = (self.reached_by(1) / self.unit_ns, self.reached_by(99) / self.unit_ns);
        let span = (high - low).max(1);
        let is_far = |distance: u64| distance > span.saturating_mul(2);
        Some((if is_far(low - least) { low } else { least }, if is_far(most - high) { high } else { most }))
    }
}

/// The smallest 1, 2 or 5 times a power of ten that is not below a number.
fn round_up(number: u64) -> u64 {
    let mut power = 1_u64;
    loop {
        for digit in [1, 2, 5] {
            let round = power.saturating_mul(digit);
            if round >= number {
                return round;
            }
        }
        power = power.saturating_mul(10);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP: TimeSpan = TimeSpan::nanos::<10>();

    fn of(lengths_ns: impl IntoIterator<Item = u64>) -> Distribution {
        let mut distribution = Distribution::new(STEP);
        lengths_ns.into_iter().for_each(|length_ns| distribution.add(length_ns));
        distribution
    }

    #[test]
    fn a_few_times_by_hand() {
        // Mean 30, deviations -20, -10, 0, 10, 20: variance 1000 / 4.
        let times = of([10, 50, 30, 20, 40]).times().expect("times");
        let by_hand = Times {
            mean_ns: 30,
            sigma_ns: Some(16),
            min_ns: 10,
            median_ns: 30,
            p95_ns: 50,
            max_ns: 50,
            resolution_ns: 10,
        };
        assert_eq!(times, by_hand);
        assert_eq!(of([10, 20]).times().map(|times| times.median_ns), Some(10), "half of two is one");
        assert_eq!(of([70]).times().map(|times| (times.sigma_ns, times.p95_ns)), Some((None, 70)));
        assert_eq!(of([]).times(), None);
        assert_eq!(of([]).histogram(), None);
        assert_eq!(of((1..=100).map(|n| n * 10)).times().map(|times| times.p95_ns), Some(950));
    }

    #[test]
    fn nearly_alike_times_keep_their_deviation() {
        let hour = 3_600_000_000_000;
        let times = of((0..1000).map(|n| hour + n % 2 * 10)).times().expect("times");
        assert_eq!((times.mean_ns, times.sigma_ns), (hour + 5, Some(5)));
    }

    #[test]
    fn bins_are_whole_steps_and_hold_all() {
        let histogram = of((0..100).map(|n| 1000 + n * 10)).histogram().expect("times");
        assert_eq!((histogram.from_ns, histogram.bin_ns), (1000, 50));
        assert_eq!(histogram.counts, [5; 20]);
        let one = of([40, 40]).histogram().expect("times");
        assert_eq!((one.from_ns, one.bin_ns, &one.counts[..]), (40, 10, &[2][..]));
    }

    #[test]
    fn one_that_lies_far_away_does_not_squeeze_the_others() {
        let times = (0..300).map(|n| 1000 + n % 3 * 10).chain([90_000]);
        let histogram = of(times).histogram().expect("times");
        assert_eq!((histogram.from_ns, histogram.bin_ns, &histogram.counts[..]), (1000, 10, &[100; 3][..]));
        assert_eq!((histogram.shorter, histogram.longer), (0, 1));
        let histogram = of((0..300).map(|_| 5000).chain([10])).histogram().expect("times");
        assert_eq!((histogram.shorter, &histogram.counts[..]), (1, &[300][..]));
    }

    #[test]
    fn what_is_kept_does_not_grow() {
        let distribution = of((0..100_000).map(|n| n * 10));
        assert!(distribution.lengths.len() <= LENGTHS_MAX);
        let times = distribution.times().expect("times");
        assert_eq!((times.min_ns, times.max_ns, times.mean_ns), (0, 999_990, 499_995));
        assert!(times.median_ns.abs_diff(499_990) < times.resolution_ns && times.resolution_ns == 320, "{times:?}");
        assert_eq!(distribution.histogram().map(|all| all.counts.iter().sum()), Some(100_000_u64));
    }

    #[test]
    fn the_longest_time_there_is() {
        let distribution = of([0, u64::MAX]);
        assert_eq!(distribution.times().map(|times| times.max_ns), Some(u64::MAX));
        let histogram = distribution.histogram().expect("times");
        assert_eq!(histogram.counts.iter().sum::<u64>() + histogram.shorter + histogram.longer, 2);
        assert_eq!([1, 2, 3, 6, 11, u64::MAX].map(round_up), [1, 2, 5, 10, 20, u64::MAX]);
    }
}
