//! The alarms of `[[report.alarm]]`: how they come and go, and what people do about them, on virtual time.
//!
//! The session's thread notes every change at its step, so nothing is missed between two pictures, and whoever looks at the past
//! sees the alarms of that moment. An acknowledgement by a page is noted here alone; one by a panel's signal is an input of the
//! session, and is noted where the signal rises: also in a recording that is run again.

use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use onescan_scenario::Scenario;
use onescan_scenario::report::{Measures, Passage, Priority};
use schemars::JsonSchema;
use serde::Serialize;

/// So many changes are kept; after that, of the older half only the last ones of each alarm.
const CHANGES_MAX: usize = 4_000;
/// So many are sent in one message.
const SENT_MAX: usize = 500;

/// An alarm of the scenario.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Alarm {
    name: String,
    priority: Priority,
}

/// The alarms of a scenario, in its order; without a `[report]` it has none.
pub(super) fn of(scenario: &Scenario) -> Vec<Alarm> {
    let alarms = scenario.measures().map_or(&[][..], Measures::alarms);
    alarms.iter().map(|alarm| Alarm { name: alarm.name().to_owned(), priority: alarm.priority() }).collect()
}

/// What has become of an alarm.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum Fate {
    /// Its condition has held for its on-delay.
    On,
    /// Its condition has not held for its off-delay.
    Off,
    /// Somebody has acknowledged it.
    Acknowledged,
    /// Somebody has put it aside until `until_ns`.
    Shelved,
    /// Somebody has taken it back.
    Unshelved,
}

/// A change of an alarm.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[schemars(rename = "AlarmChange")]
pub(super) struct Change {
    pub(super) alarm: usize,
    pub(super) t_ns: u64,
    pub(super) fate: Fate,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) until_ns: Option<u64>,
}

#[derive(Debug, Default)]
struct Log {
    /// How often it has begun again.
    epoch: u64,
    changes: Vec<Change>,
}

impl Log {
    fn push(&mut self, change: Change) {
        // Somebody who acts has seen an older picture: the order is that in which it is noted.
        let t_ns = self.changes.last().map_or(change.t_ns, |last| last.t_ns.max(change.t_ns));
        self.changes.push(Change { t_ns, ..change });
        if self.changes.len() > CHANGES_MAX {
            self.forget();
        }
    }

    /// Keeps of the older half what decides how each alarm was then.
    fn forget(&mut self) {
        let recent = self.changes.split_off(self.changes.len() / 2);
        // From the end on, so that the first of a kind is the last of its alarm.
        let mut seen = BTreeSet::new();
        let mut kept: Vec<Change> = self.changes.drain(..).rev().collect();
        kept.retain(|one| seen.insert((one.alarm, kind(one.fate))));
        self.changes.extend(kept.into_iter().rev().chain(recent));
        self.epoch += 1;
    }
}

/// Fates of which the last one counts.
fn kind(fate: Fate) -> u8 {
    match fate {
        Fate::On => 0,
        Fate::Off => 1,
        Fate::Acknowledged => 2,
        Fate::Shelved | Fate::Unshelved => 3,
    }
}

/// Where changes of alarms are noted; clones share it.
#[derive(Clone, Debug, Default)]
pub(crate) struct AlarmLog(Arc<Mutex<Log>>);

/// How far a viewer has read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Read {
    epoch: u64,
    changes: usize,
}

impl AlarmLog {
    /// A thread that panicked under the lock has left a whole log.
    fn lock(&self) -> MutexGuard<'_, Log> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A session begins: it has no alarms yet.
    pub(crate) fn begin(&self) {
        let mut log = self.lock();
        *log = Log { epoch: log.epoch + 1, changes: Vec::new() };
    }

    /// Notes alarms that have come or gone.
    pub(crate) fn take(&self, passages: &[Passage]) {
        let mut log = self.lock();
        for Passage { alarm, t_ns, has_come } in passages {
            let fate = if *has_come { Fate::On } else { Fate::Off };
            log.push(Change { alarm: *alarm, t_ns: *t_ns, fate, until_ns: None });
        }
    }

    /// Notes that these alarms were acknowledged.
    pub(crate) fn acknowledge(&self, alarms: impl IntoIterator<Item = usize>, t_ns: u64) {
        self.note(alarms, t_ns, Fate::Acknowledged, None);
    }

    /// Notes what somebody does about alarms at `t_ns`.
    pub(super) fn note(&self, alarms: impl IntoIterator<Item = usize>, t_ns: u64, fate: Fate, until_ns: Option<u64>) {
        let mut log = self.lock();
        for alarm in alarms {
            log.push(Change { alarm, t_ns, fate, until_ns });
        }
    }

    /// What is new to a viewer, and whether it is all there is.
    pub(super) fn news(&self, read: &mut Read) -> Option<(bool, Vec<Change>)> {
        let log = self.lock();
        let is_all = read.epoch != log.epoch;
        if is_all {
            *read = Read { epoch: log.epoch, changes: 0 };
        }
        // A log only grows within an epoch, so nobody has read more than there is.
        let rest = log.changes.get(read.changes..).unwrap_or_default();
        let sent = rest.get(..SENT_MAX).unwrap_or(rest);
        read.changes += sent.len();
        (is_all || !sent.is_empty()).then(|| (is_all, sent.to_vec()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn change(alarm: usize, t_ns: u64, fate: Fate) -> Change {
        Change { alarm, t_ns, fate, until_ns: None }
    }

    #[test]
    fn a_viewer_reads_each_change_once() {
        let (log, mut read) = (AlarmLog::default(), Read::default());
        assert_eq!(log.news(&mut read), None);
        log.note([0, 1], 20, Fate::Acknowledged, None);
        log.note([0], 10, Fate::Shelved, Some(90));
        let shelved = Change { until_ns: Some(90), ..change(0, 20, Fate::Shelved) };
        let all = vec![change(0, 20, Fate::Acknowledged), change(1, 20, Fate::Acknowledged), shelved];
        assert_eq!(log.news(&mut read), Some((false, all)));
        assert_eq!(log.news(&mut read), None);
        log.begin();
        assert_eq!(log.news(&mut read), Some((true, Vec::new())), "a session that begins again has no alarms yet");
    }

    #[test]
    fn an_old_log_keeps_how_each_alarm_was() {
        let (log, mut read) = (AlarmLog::default(), Read::default());
        log.lock().push(change(7, 1, Fate::On));
        for t_ns in 2..=CHANGES_MAX as u64 + 1 {
            log.lock().push(change(0, t_ns, if t_ns % 2 == 0 { Fate::On } else { Fate::Off }));
        }
        let (is_all, first) = log.news(&mut read).expect("it has begun again");
        assert!(is_all && first.first() == Some(&change(7, 1, Fate::On)));
        assert!(log.lock().changes.len() <= CHANGES_MAX / 2 + 4);
    }
}
