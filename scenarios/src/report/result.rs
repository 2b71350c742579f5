//! The report of a run, as it is written for machines.

use onescan_server::time::TimeSpan;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::alarm::AlarmReport;
use super::count::CountReport;
use super::cycle::CycleReport;
use super::down_time::{DownTimeReport, part};
use super::history::HistoryReport;
use super::spread::SpreadReport;
use crate::report_file::Quality;

/// What a run produced, and what held it up. Its JSON form is a contract: fields are added, never changed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Report {
    /// Virtual time of the first image that it knows, in nanoseconds: 0, or that of the checkpoint from which the run went on.
    pub from_ns: u64,
    /// Virtual time of the last one, in nanoseconds.
    pub to_ns: u64,
    /// Counts, in the order of the scenario.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub counts: Vec<CountReport>,
    /// How much of it was good; absent unless the scenario counts both.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub quality: Option<QualityReport>,
    /// Cycle times, in the order of the scenario.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cycles: Vec<CycleReport>,
    /// Down time by cause; absent unless the scenario says when the machine is down.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub down_time: Option<DownTimeReport>,
    /// Overall equipment effectiveness; absent unless the scenario has all that it needs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub oee: Option<OeeReport>,
    /// Alarms; absent unless the scenario has some.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alarms: Option<AlarmReport>,
    /// Histories of signals, in the order of the scenario.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub histories: Vec<HistoryReport>,
    /// Histograms of signals, in the order of the scenario.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub histograms: Vec<SpreadReport>,
}

/// Good and rejected pieces.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct QualityReport {
    /// All counts that are good.
    pub good: u64,
    /// All counts that are rejected.
    pub reject: u64,
    /// The good ones as a part of both, from 0 to 1; absent if there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ratio: Option<f64>,
}

/// Overall equipment effectiveness and its factors (ISO 22400-2), each from 0 to 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OeeReport {
    /// Run time as a part of all time that was not planned to be down.
    pub availability: f64,
    /// The time that all pieces should have taken, as a part of the run time; above 1 if the ideal cycle is too long.
    pub performance: f64,
    /// Good pieces as a part of all; 1 where nothing is counted as rejected.
    pub quality: f64,
    /// The product of the three.
    pub oee: f64,
}

/// What the measures say by themselves.
pub(super) struct Outcome {
    pub(super) counts: Vec<CountReport>,
    pub(super) cycles: Vec<CycleReport>,
    pub(super) down_time: Option<DownTimeReport>,
    pub(super) alarms: Option<AlarmReport>,
    pub(super) histories: Vec<HistoryReport>,
    pub(super) spreads: Vec<SpreadReport>,
}

impl Report {
    pub(super) fn new((from_ns, to_ns): (u64, u64), outcome: Outcome, ideal_cycle: Option<TimeSpan>) -> Self {
        let Outcome { counts, cycles, down_time, alarms, histories, spreads } = outcome;
        let (good, reject) = (sum(&counts, Quality::Good), sum(&counts, Quality::Reject));
        let quality = good.zip(reject).map(|(good, reject)| QualityReport {
            good,
            reject,
            ratio: part(good, good.saturating_add(reject)),
        });
        let made = good.map(|good| (good, good.saturating_add(reject.unwrap_or(0))));
        let oee = match (ideal_cycle, &down_time, made) {
            (Some(ideal), Some(down), Some(made)) => effectiveness(ideal, down, made),
            _ => None,
        };
        Self { from_ns, to_ns, counts, quality, cycles, down_time, oee, alarms, histories, histograms: spreads }
    }
}

/// All counts of a quality; nothing if there is no such count.
fn sum(counts: &[CountReport], quality: Quality) -> Option<u64> {
    let of = counts.iter().filter(|count| count.quality == Some(quality)).map(|count| count.count);
    of.reduce(u64::saturating_add)
}

/// Nothing without run time, or where nothing was made.
fn effectiveness(ideal: TimeSpan, down: &DownTimeReport, (good, made): (u64, u64)) -> Option<OeeReport> {
    let availability = down.availability?;
    let quality = part(good, made)?;
    let performance = (down.run_ns > 0).then(|| ideal.as_nanos() as f64 * made as f64 / down.run_ns as f64)?;
    Some(OeeReport { availability, performance, quality, oee: availability * performance * quality })
}
