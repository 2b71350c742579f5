//! Cycle times.

use onescan_server::time::TimeSpan;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::distribution::{Distribution, Histogram, Times};
use super::edge::Edge;
use crate::expect::Present;

/// Which times are taken.
#[derive(Clone, Debug)]
pub(super) struct Timed {
    pub(super) name: String,
    /// A cycle begins when this becomes true.
    pub(super) from: Present,
    /// It ends when this does; with the next one if absent.
    pub(super) to: Option<Present>,
}

/// Cycle times. Its JSON form is a contract: fields are added, never changed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct CycleReport {
    /// Its name.
    pub name: String,
    /// How many cycles came to their end.
    pub count: u64,
    /// How many began once more before they had ended; their first part is not timed.
    pub abandoned: u64,
    /// How long they took; absent if there was none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub times: Option<Times>,
    /// How many took how long; absent if there was none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub histogram: Option<Histogram>,
}

/// Cycles while the run goes.
#[derive(Clone, Debug)]
pub(super) struct Cycles {
    timed: Timed,
    begins: Edge,
    ends: Edge,
    since_ns: Option<u64>,
    abandoned: u64,
    times: Distribution,
}

impl Cycles {
    pub(super) fn new(timed: Timed, step: TimeSpan) -> Self {
        Self {
            timed,
            begins: Edge::default(),
            ends: Edge::default(),
            since_ns: None,
            abandoned: 0,
            times: Distribution::new(step),
        }
    }

    /// Takes the image of `t_ns`. Where one cycle ends and another begins, both count.
    pub(super) fn push(&mut self, t_ns: u64, values: &[f64]) {
        let begins = self.begins.rises(self.timed.from.holds(values));
        let ends = match &self.timed.to {
            Some(to) => self.ends.rises(to.holds(values)),
            None => begins,
        };
        if ends && let Some(since_ns) = self.since_ns.take() {
            self.times.add(t_ns.saturating_sub(since_ns));
        }
        if begins && self.since_ns.replace(t_ns).is_some() {
            self.abandoned += 1;
        }
    }

    pub(super) fn report(&self) -> CycleReport {
        CycleReport {
            name: self.timed.name.clone(),
            count: self.times.count(),
            abandoned: self.abandoned,
            times: self.times.times(),
            histogram: self.times.histogram(),
        }
    }
}
