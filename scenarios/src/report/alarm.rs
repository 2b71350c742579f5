//! Alarms, each with its occurrences.

use std::collections::VecDeque;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::annunciator::{Alarm, Annunciator, Passage};
use super::spell::Spells;

/// So many occurrences are listed from the first on, and as many up to the last.
const LISTED_MAX: usize = 50;

/// All alarms. Its JSON form is a contract: fields are added, never changed.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
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
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
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
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
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
    annunciator: Annunciator,
    spells: Vec<Spells>,
    first: Vec<Came>,
    last: VecDeque<Came>,
    left_out: u64,
}

impl Alarms {
    pub(super) fn new(alarms: &[Alarm]) -> Self {
        Self {
            annunciator: Annunciator::new(alarms),
            spells: vec![Spells::default(); alarms.len()],
            first: Vec::new(),
            last: VecDeque::new(),
            left_out: 0,
        }
    }

    /// Takes the image of `t_ns`.
    pub(super) fn push(&mut self, t_ns: u64, values: &[f64]) {
        let passages = self.annunciator.push(t_ns, values);
        self.list(&passages);
    }

    /// Time passes up to `t_ns` without another image.
    pub(super) fn pass(&mut self, t_ns: u64) {
        let passages = self.annunciator.pass(t_ns);
        self.list(&passages);
    }

    fn list(&mut self, passages: &[Passage]) {
        for Passage { alarm, t_ns, has_come } in passages {
            self.spells[*alarm].push(*t_ns, *has_come);
            if *has_come {
                self.came(Came { alarm: *alarm, from_ns: *t_ns, to_ns: None });
            } else {
                self.went(*alarm, *t_ns);
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
        let total = |(alarm, spells): (&Alarm, &Spells)| {
            let Spells { count, total_ns, longest_ns, .. } = spells.until(end_ns);
            AlarmTotal { name: alarm.name.clone(), count, total_ns, longest_ns, active: spells.is_on() }
        };
        let names: Vec<&str> = self.annunciator.alarms().map(Alarm::name).collect();
        let occurrence = |came: &Came| Occurrence {
            name: names.get(came.alarm).map_or_else(String::new, |name| (*name).to_owned()),
            from_ns: came.from_ns,
            to_ns: came.to_ns,
            duration_ns: came.to_ns.unwrap_or(end_ns).saturating_sub(came.from_ns),
        };
        (!self.spells.is_empty()).then(|| AlarmReport {
            totals: self.annunciator.alarms().zip(&self.spells).map(total).collect(),
            first: self.first.iter().map(occurrence).collect(),
            left_out: self.left_out,
            last: self.last.iter().map(occurrence).collect(),
        })
    }
}
