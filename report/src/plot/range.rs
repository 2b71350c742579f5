//! Which times and values a panel has to show.

use super::{Panel, Plot, Shape, Trajectory};

/// Half the width of the time axis around a lone instant.
const LONE_INSTANT_HALF_NS: u64 = 500_000_000;
/// The room above and below the values, as a part of their range.
const PADDING: f64 = 0.06;
/// A range narrower than this part of its values is rounding noise and shown as a constant.
const NOISE: f64 = 1e-12;

/// The times of a plot, from its first sample to its last.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct TimeRange {
    pub(super) start_ns: u64,
    pub(super) end_ns: u64,
}

impl TimeRange {
    /// The times of all samples, widened if they are one instant; the first second if there are none.
    pub(super) fn of(plot: &Plot) -> Self {
        let times = || plot.panels.iter().flat_map(|panel| &panel.runs).flat_map(samples).map(|(t_ns, _)| t_ns);
        match (times().min(), times().max()) {
            (Some(only), Some(end)) if only == end => Self {
                start_ns: only.saturating_sub(LONE_INSTANT_HALF_NS),
                end_ns: only.saturating_add(LONE_INSTANT_HALF_NS),
            },
            (Some(start_ns), Some(end_ns)) => Self { start_ns, end_ns },
            _ => Self { start_ns: 0, end_ns: 1_000_000_000 },
        }
    }

    /// Where an instant lies in the range, from 0 to 1.
    pub(super) fn fraction(self, t_ns: u64) -> f64 {
        let span_ns = self.end_ns.saturating_sub(self.start_ns).max(1);
        (t_ns.saturating_sub(self.start_ns) as f64 / span_ns as f64).min(1.0)
    }

    /// The same range in seconds.
    pub(super) fn seconds(self) -> ValueRange {
        ValueRange { low: self.start_ns as f64 / 1e9, high: self.end_ns as f64 / 1e9 }
    }
}

/// The values between the lower and the upper edge of a panel; both are finite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ValueRange {
    pub(super) low: f64,
    pub(super) high: f64,
}

impl ValueRange {
    /// The finite values of a panel with some room around them.
    pub(super) fn of(panel: &Panel) -> Self {
        if is_two_valued(panel) {
            return Self { low: -0.2, high: 1.2 };
        }
        finite_range(panel).map_or(Self { low: 0.0, high: 1.0 }, |Self { low, high }| Self::around(low, high))
    }

    /// From `low` to `high`, both finite, with some room around them.
    pub(super) fn around(low: f64, high: f64) -> Self {
        let half_span = high / 2.0 - low / 2.0;
        let magnitude = low.abs().max(high.abs());
        if half_span > magnitude * NOISE {
            Self::padded(low, high, half_span * 2.0 * PADDING)
        } else if magnitude == 0.0 || magnitude * NOISE == 0.0 {
            Self { low: -1.0, high: 1.0 }
        } else {
            Self::padded(low, high, magnitude * PADDING)
        }
    }

    /// Whether it is longer than nothing.
    pub(super) fn is_stretch(self) -> bool {
        self.low < self.high
    }

    fn padded(low: f64, high: f64, padding: f64) -> Self {
        Self { low: (low - padding).max(f64::MIN), high: (high + padding).min(f64::MAX) }
    }

    /// Where a value lies in the range, from 0 at its low end to 1.
    pub(super) fn fraction(self, value: f64) -> f64 {
        // Halves, because the difference of two finite numbers need not be finite.
        let half_span = self.high / 2.0 - self.low / 2.0;
        let fraction = (value / 2.0 - self.low / 2.0) / half_span;
        if fraction.is_finite() { fraction.clamp(0.0, 1.0) } else { 0.5 }
    }
}

/// The finite values of a panel from the least to the greatest; nothing if there are none.
pub(super) fn finite_range(panel: &Panel) -> Option<ValueRange> {
    let low = finite_values(panel).fold(f64::INFINITY, f64::min);
    let high = finite_values(panel).fold(f64::NEG_INFINITY, f64::max);
    (low <= high).then_some(ValueRange { low, high })
}

/// Whether a panel is a BOOL: steps between 0 and 1 and nothing else.
pub(super) fn is_two_valued(panel: &Panel) -> bool {
    panel.shape == Shape::Step && finite_values(panel).all(|value| value == 0.0 || value == 1.0)
}

/// Whether all values of a panel are whole numbers.
pub(super) fn is_whole(panel: &Panel) -> bool {
    finite_values(panel).all(|value| value.fract() == 0.0)
}

/// Whether a panel has nothing to draw.
pub(super) fn is_empty(panel: &Panel) -> bool {
    finite_values(panel).next().is_none()
}

/// The samples of a trajectory, finite or not.
pub(super) fn samples(run: &Trajectory) -> impl Iterator<Item = (u64, f64)> {
    run.t_ns.iter().copied().zip(run.values.iter().copied())
}

fn finite_values(panel: &Panel) -> impl Iterator<Item = f64> {
    panel.runs.iter().flat_map(samples).map(|(_, value)| value).filter(|value| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn range(values: &[f64]) -> ValueRange {
        let t_ns = (0..values.len() as u64).collect();
        let runs = vec![Trajectory { t_ns, values: values.to_vec() }];
        ValueRange::of(&Panel { signal: String::new(), unit: None, shape: Shape::Line, names: Vec::new(), runs })
    }

    #[test]
    fn a_constant_lies_in_the_middle() {
        for constant in [0.0, 3.5, -1e300, 1e-300, f64::MIN_POSITIVE] {
            let range = range(&[constant, f64::NAN, constant]);
            assert!((range.fraction(constant) - 0.5).abs() < 1e-9, "{constant} in {range:?}");
        }
    }

    #[test]
    fn the_widest_range_is_still_a_range() {
        let range = range(&[f64::MIN, f64::MAX, f64::INFINITY]);
        assert_eq!((range.fraction(f64::MIN), range.fraction(0.0), range.fraction(f64::MAX)), (0.0, 0.5, 1.0));
    }
}
