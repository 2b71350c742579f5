//! Down time by cause.
//!
//! The words are those of ISO 22400-2 and IEC 60050-192: availability is the run time as a part of the planned time, and
//! each uninterrupted stretch of down time that was not planned is one failure, whatever its causes.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::spell::Spells;
use crate::expect::Present;

/// What the causes are called together that are not named: the machine is down, and nothing says why.
pub(super) const UNKNOWN: &str = "unknown cause";

/// When the machine is down.
#[derive(Clone, Debug)]
pub(super) struct Down {
    /// It is down while this holds; while a cause holds if absent.
    pub(super) when: Option<Present>,
    /// The first that holds counts.
    pub(super) causes: Vec<Cause>,
}

/// Why it is down.
#[derive(Clone, Debug)]
pub(super) struct Cause {
    pub(super) name: String,
    pub(super) when: Present,
    pub(super) is_planned: bool,
}

/// Run time and down time, in nanoseconds of virtual time. Its JSON form is a contract: fields are added, never changed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DownTimeReport {
    /// How long the machine was not down.
    pub run_ns: u64,
    /// How long it was down, for whatever cause.
    pub down_ns: u64,
    /// How long of that as planned.
    pub planned_ns: u64,
    /// Run time as a part of all time that was not planned to be down, from 0 to 1; absent if there was none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub availability: Option<f64>,
    /// How often the machine went down without a plan.
    pub failures: u64,
    /// Mean time between failures: run time by failures; absent without a failure.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mtbf_ns: Option<u64>,
    /// Mean time to repair: unplanned down time by failures; absent without a failure.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mttr_ns: Option<u64>,
    /// Down time by cause, in the order of the scenario.
    pub causes: Vec<CauseReport>,
}

/// Down time by one cause.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CauseReport {
    /// Its name.
    pub name: String,
    /// Whether it is planned.
    pub planned: bool,
    /// How often.
    pub count: u64,
    /// How long in all, in nanoseconds of virtual time.
    pub total_ns: u64,
    /// How long at most at a time, in nanoseconds of virtual time.
    pub longest_ns: u64,
    /// Its part of all time, from 0 to 1; absent if the report has no length.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub share: Option<f64>,
}

/// Down time while the run goes.
#[derive(Clone, Debug)]
pub(super) struct DownTime {
    down: Down,
    /// One a cause, and a last one for those that are not known.
    causes: Vec<Spells>,
    failures: Spells,
}

impl DownTime {
    pub(super) fn new(down: Down) -> Self {
        let causes = vec![Spells::default(); down.causes.len() + 1];
        Self { down, causes, failures: Spells::default() }
    }

    /// Takes the image of `t_ns`.
    pub(super) fn push(&mut self, t_ns: u64, values: &[f64]) {
        let is_down = self.down.when.as_ref().is_none_or(|when| when.holds(values));
        let named = || self.down.causes.iter().position(|cause| cause.when.holds(values));
        let cause = match (is_down, &self.down.when) {
            (false, _) => None,
            (true, None) => named(),
            (true, Some(_)) => Some(named().unwrap_or(self.down.causes.len())),
        };
        for (index, spells) in self.causes.iter_mut().enumerate() {
            spells.push(t_ns, cause == Some(index));
        }
        let is_failure = cause.is_some_and(|index| self.down.causes.get(index).is_none_or(|cause| !cause.is_planned));
        self.failures.push(t_ns, is_failure);
    }

    pub(super) fn until(&self, (begin_ns, end_ns): (u64, u64)) -> DownTimeReport {
        let span_ns = end_ns.saturating_sub(begin_ns);
        let unknown = self.down.when.is_some().then_some((UNKNOWN, false));
        let names = self.down.causes.iter().map(|cause| (cause.name.as_str(), cause.is_planned)).chain(unknown);
        let causes: Vec<CauseReport> = names
            .zip(&self.causes)
            .map(|((name, planned), spells)| {
                let Spells { count, total_ns, longest_ns, .. } = spells.until(end_ns);
                CauseReport {
                    name: name.to_owned(),
                    planned,
                    count,
                    total_ns,
                    longest_ns,
                    share: part(total_ns, span_ns),
                }
            })
            .collect();
        let down_ns: u64 = causes.iter().map(|cause| cause.total_ns).sum();
        let planned_ns = causes.iter().filter(|cause| cause.planned).map(|cause| cause.total_ns).sum();
        let run_ns = span_ns.saturating_sub(down_ns);
        let failures = self.failures.until(end_ns);
        DownTimeReport {
            run_ns,
            down_ns,
            planned_ns,
            availability: part(run_ns, span_ns.saturating_sub(planned_ns)),
            failures: failures.count,
            mtbf_ns: run_ns.checked_div(failures.count),
            mttr_ns: failures.total_ns.checked_div(failures.count),
            causes,
        }
    }
}

/// A part of a whole, from 0 to 1; nothing without a whole.
pub(super) fn part(part: u64, whole: u64) -> Option<f64> {
    (whole > 0).then(|| part as f64 / whole as f64)
}
