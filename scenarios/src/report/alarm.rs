//! Alarms, each with its occurrences.

use std::collections::VecDeque;

use schemars::JsonSchema;
use serde::Serialize;

use super::spell::{Change, Spells};
use crate::expect::Present;

/// So many occurrences are listed from the first on, and as many up to the last.
const LISTED_MAX: usize = 50;

/// What is listed when it comes.
#[derive(Clone, Debug)]
pub(super) struct Alarm {
    pub(super) name: String,
    pub(super) when: Present,
}

/// All alarms. Its JSON form is a contract: fields are added, never changed.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, JsonSchema)]
pub struct AlarmReport {
    /// Each alarm, in the order of the scenario.
    pub totals: Vec<AlarmTotal>,
    /// The first 50 occurrences, in the order in which they came.
    pub first: Vec<Occurrence>,
    /// How many between the first and the last are left out.
    pub left_out: u64,
    /// The last 50 of those that are not among the first.
    pub last: Vec<Occurrence>,
}

/// How often and how long an alarm was active.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct AlarmTotal {
    /// Its text.
    pub name: String,
    /// How often it came.
    pub count: u64,
    /// How long it was active in all, in nanoseconds of virtual time.
    pub total_ns: u64,
    /// How long at most at a time, in nanoseconds of virtual time.
    pub longest_ns: u64,
    /// True if it is active at the end.
    pub active: bool,
}

/// One occurrence of an alarm.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Occurrence {
    /// Its text.
    pub name: String,
    /// When it came, in nanoseconds of virtual time.
    pub from_ns: u64,
    /// When it went; absent if it is active at the end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub to_ns: Option<u64>,
    /// How long it was active, as far as that was seen.
    pub duration_ns: u64,
}

/// An occurrence that is listed.
#[derive(Clone, Copy, Debug)]
struct Came {
    alarm: usize,
    from_ns: u64,
    to_ns: Option<u64>,
}

/// Alarms while the run goes.
#[derive(Clone, Debug)]
pub(super) struct Alarms {
    all: Vec<(Alarm, Spells)>,
    first: Vec<Came>,
    last: VecDeque<Came>,
    left_out: u64,
}

impl Alarms {
    pub(super) fn new(alarms: &[Alarm]) -> Self {
        let all = alarms.iter().map(|alarm| (alarm.clone(), Spells::default())).collect();
        Self { all, first: Vec::new(), last: VecDeque::new(), left_out: 0 }
    }

    /// Takes the image of `t_ns`. Those that come at one time come in the order of the scenario.
    pub(super) fn push(&mut self, t_ns: u64, values: &[f64]) {
        for index in 0..self.all.len() {
            let (alarm, spells) = &mut self.all[index];
            match spells.push(t_ns, alarm.when.holds(values)) {
                Some(Change::Began) => self.came(Came { alarm: index, from_ns: t_ns, to_ns: None }),
                Some(Change::Ended) => self.went(index, t_ns),
                None => {}
            }
        }
    }

    fn came(&mut self, came: Came) {
        if self.first.len() < LISTED_MAX {
            self.first.push(came);
            return;
        }
        self.last.push_back(came);
        if self.last.len() > LISTED_MAX {
            self.last.pop_front();
            self.left_out += 1;
        }
    }

    /// An alarm that came long ago may be listed no more.
    fn went(&mut self, alarm: usize, t_ns: u64) {
        let mut listed = self.first.iter_mut().chain(&mut self.last);
        if let Some(came) = listed.find(|came| came.alarm == alarm && came.to_ns.is_none()) {
            came.to_ns = Some(t_ns);
        }
    }

    /// Nothing if no alarm is asked for.
    pub(super) fn until(&self, end_ns: u64) -> Option<AlarmReport> {
        let total = |(alarm, spells): &(Alarm, Spells)| {
            let Spells { count, total_ns, longest_ns, .. } = spells.until(end_ns);
            AlarmTotal { name: alarm.name.clone(), count, total_ns, longest_ns, active: spells.is_on() }
        };
        let occurrence = |came: &Came| Occurrence {
            name: self.all[came.alarm].0.name.clone(),
            from_ns: came.from_ns,
            to_ns: came.to_ns,
            duration_ns: came.to_ns.unwrap_or(end_ns).saturating_sub(came.from_ns),
        };
        (!self.all.is_empty()).then(|| AlarmReport {
            totals: self.all.iter().map(total).collect(),
            first: self.first.iter().map(occurrence).collect(),
            left_out: self.left_out,
            last: self.last.iter().map(occurrence).collect(),
        })
    }
}
