//! The report of a run: counts, throughput, cycle times, down time by cause, alarms.
//!
//! The words are those of the field: ISO 22400-2 for availability, performance, quality and OEE, IEC 60050-192 for the
//! mean times between failures and to repair.
//!
//! | module | subject |
//! |---|---|
//! | [`edge`] | rising edges |
//! | [`spell`] | times during which something holds |
//! | [`windows`] | equal windows of time, which widen as a run goes on |
//! | [`throughput`] | how many in each of them |
//! | [`held`] | values that hold from image to image |
//! | [`distribution`] | times by their length: mean, quantiles, histogram |
//! | [`count`], [`cycle`], [`down_time`], [`alarm`], [`history`], [`spread`] | the measures, each with what it reports |
//! | [`annunciator`] | alarms as they come and go, with their delays |
//! | [`numbers`] | the signals as numbers |
//! | [`look`] | which signals histories and histograms look at, in which unit |
//! | [`measures`] | what a scenario asks for, bound to its signals |
//! | [`result`] | the report |
//! | [`meter`] | all measures of a run, image by image |
//! | [`bell`] | its alarms alone, for those who watch it |
//!
//! Semantics. A signal holds its value from one image to the next, as in expectations. A condition that holds in the
//! first image has no edge there, and its spell begins there. One that holds in the last image has its spell up to that
//! image. Nothing is known of what was before a checkpoint from which a run goes on.
//!
//! What is kept does not grow with the run: windows widen, lengths of time become coarser, alarms are listed from both
//! ends. The tests hold all of it against `offline`, which looks at a whole run.

mod alarm;
mod annunciator;
mod bell;
mod count;
mod cycle;
mod distribution;
mod down_time;
mod edge;
mod held;
mod history;
mod look;
mod measures;
mod meter;
mod numbers;
#[cfg(test)]
mod offline;
mod result;
mod spell;
mod spread;
mod throughput;
mod windows;

pub use alarm::{AlarmReport, AlarmTotal, Occurrence};
pub use annunciator::{Alarm, Passage};
pub use bell::Bell;
pub use count::CountReport;
pub use cycle::CycleReport;
pub use distribution::{Histogram, Times};
pub use down_time::{CauseReport, DownTimeReport};
pub use history::{HistoryReport, SignalHistory};
pub use measures::Measures;
pub use meter::Meter;
pub use result::{OeeReport, QualityReport, Report};
pub use spread::{SignalSpread, SpreadReport};
pub use throughput::Throughput;

pub use crate::report_file::{Priority, Quality};
