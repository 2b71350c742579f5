//! Counts: how often a condition became true, or by how much a counter grew.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::edge::Edge;
use super::throughput::Throughput;
use super::windows::Windows;
use crate::expect::Present;
use crate::report_file::Quality;

const HOUR_NS: f64 = 3.6e12;

/// What is counted, by name.
#[derive(Clone, Debug)]
pub(super) struct Counted {
    pub(super) name: String,
    pub(super) quality: Option<Quality>,
    pub(super) what: What,
}

/// The ways to count.
#[derive(Clone, Debug)]
pub(super) enum What {
    /// Each time this becomes true.
    Rising(Present),
    /// By how much the signal of this column grows; it is of a type with these smallest and greatest values.
    Growth(usize, (i128, i128)),
}

/// What was counted. Its JSON form is a contract: fields are added, never changed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CountReport {
    /// Its name.
    pub name: String,
    /// Whether what it counts is good or rejected; absent if it is neither.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub quality: Option<Quality>,
    /// How many.
    pub count: u64,
    /// How many in an hour of virtual time, over all of the report; absent if that has no length.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub per_hour: Option<f64>,
    /// How many over time.
    pub throughput: Throughput,
}

/// A count while the run goes.
#[derive(Clone, Debug)]
pub(super) struct Count {
    counted: Counted,
    edge: Edge,
    before: Option<i128>,
    total: u64,
    windows: Windows<u64>,
}

impl Count {
    pub(super) fn new(counted: Counted, windows: Windows<u64>) -> Self {
        Self { counted, edge: Edge::default(), before: None, total: 0, windows }
    }

    /// Takes the image of `t_ns`: its values, and the whole number that a counter is.
    pub(super) fn push(&mut self, t_ns: u64, values: &[f64], whole: impl Fn(usize) -> Option<i128>) {
        let more = match &self.counted.what {
            What::Rising(when) => u64::from(self.edge.rises(when.holds(values))),
            What::Growth(column, range) => match (whole(*column), self.before) {
                (Some(now), before) => {
                    self.before = Some(now);
                    before.map_or(0, |before| growth(before, now, *range))
                }
                (None, _) => 0,
            },
        };
        if more > 0 {
            self.total = self.total.saturating_add(more);
            if let Some(counted) = self.windows.at(t_ns) {
                *counted = counted.saturating_add(more);
            }
        }
    }

    pub(super) fn until(&self, (begin_ns, end_ns): (u64, u64)) -> CountReport {
        let span_ns = end_ns.saturating_sub(begin_ns);
        CountReport {
            name: self.counted.name.clone(),
            quality: self.counted.quality,
            count: self.total,
            per_hour: (span_ns > 0).then(|| self.total as f64 * HOUR_NS / span_ns as f64),
            throughput: Throughput::until(&self.windows, end_ns),
        }
    }
}

/// By how much a counter has grown. One that falls has passed the end of its type's range if it comes from the uppermost
/// quarter of it and is in the lowest; else it was reset, and has counted from 0 since.
pub(super) fn growth(before: i128, now: i128, (low, high): (i128, i128)) -> u64 {
    let values = high - low + 1;
    let grown = if now >= before {
        now - before
    } else if before > high - values / 4 && now < low + values / 4 {
        now - before + values
    } else {
        now.max(0)
    };
    u64::try_from(grown).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_counter_grows_wraps_and_is_reset() {
        let byte = (0, 255);
        let int = (-32_768, 32_767);
        assert_eq!(growth(3, 3, byte), 0);
        assert_eq!(growth(3, 7, byte), 4);
        assert_eq!(growth(254, 1, byte), 3, "254, 255, 0, 1");
        assert_eq!(growth(200, 0, byte), 6 + 50, "from the uppermost quarter to the lowest");
        assert_eq!(growth(100, 2, byte), 2, "reset, and two since");
        assert_eq!(growth(32_767, -32_768, int), 1);
        assert_eq!(growth(500, 0, int), 0);
        assert_eq!(growth(-5, -7, int), 0, "reset to something below 0");
        let long = (i128::from(i64::MIN), i128::from(i64::MAX));
        assert_eq!(growth(long.0, long.1, long), u64::MAX);
        assert_eq!(growth(i128::from(u64::MAX), 0, (0, i128::from(u64::MAX))), 1, "exact beyond 2^53");
    }
}
