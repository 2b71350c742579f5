//! Alarms as they come and go: conditions with a delay on either side (ISA-18.2: on-delay, off-delay).
//!
//! An alarm comes when its condition has held for its on-delay, and goes when it has not for its off-delay. The times are those
//! of the delays to the nanosecond, whether an image shows them or not: an image that comes late reports what was due before it.

use crate::expect::Present;
use crate::report_file::Priority;

/// What is listed when it comes.
#[derive(Clone, Debug)]
pub struct Alarm {
    pub(super) name: String,
    pub(super) priority: Priority,
    pub(super) when: Present,
    /// How long the condition holds before it comes.
    pub(super) on_delay_ns: u64,
    /// How long the condition no longer holds before it goes.
    pub(super) off_delay_ns: u64,
}

impl Alarm {
    /// Its text.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// How urgent it is.
    pub fn priority(&self) -> Priority {
        self.priority
    }
}

/// An alarm has come or gone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Passage {
    /// Its place among the alarms of the scenario.
    pub alarm: usize,
    /// When, in nanoseconds of virtual time.
    pub t_ns: u64,
    /// Whether it has come.
    pub has_come: bool,
}

/// Where an alarm is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Off,
    /// Its condition holds; it comes at this time.
    Coming(u64),
    On,
    /// Its condition holds no more; it goes at this time.
    Going(u64),
}

impl Phase {
    fn due_ns(self) -> Option<u64> {
        match self {
            Self::Coming(due_ns) | Self::Going(due_ns) => Some(due_ns),
            Self::Off | Self::On => None,
        }
    }

    /// After its time has come.
    fn passed(self) -> Self {
        match self {
            Self::Coming(_) => Self::On,
            Self::Going(_) => Self::Off,
            Self::Off | Self::On => self,
        }
    }

    /// After an image in which the condition holds, or not.
    fn turned(self, t_ns: u64, holds: bool, alarm: &Alarm) -> Self {
        match (self, holds) {
            (Self::Off, true) => Self::Coming(t_ns.saturating_add(alarm.on_delay_ns)),
            (Self::On, false) => Self::Going(t_ns.saturating_add(alarm.off_delay_ns)),
            (Self::Coming(_), false) => Self::Off,
            (Self::Going(_), true) => Self::On,
            (Self::Off | Self::Going(_), false) | (Self::On | Self::Coming(_), true) => self,
        }
    }
}

/// All alarms of a scenario while a run goes.
#[derive(Clone, Debug)]
pub(super) struct Annunciator {
    alarms: Vec<(Alarm, Phase)>,
    /// The first time at which one of them comes or goes by itself.
    due_ns: Option<u64>,
}

impl Annunciator {
    pub(super) fn new(alarms: &[Alarm]) -> Self {
        Self { alarms: alarms.iter().map(|alarm| (alarm.clone(), Phase::Off)).collect(), due_ns: None }
    }

    /// The alarms, in the order of the scenario.
    pub(super) fn alarms(&self) -> impl Iterator<Item = &Alarm> {
        self.alarms.iter().map(|(alarm, _)| alarm)
    }

    /// Takes the image of `t_ns`, which is not as the one before it.
    pub(super) fn push(&mut self, t_ns: u64, values: &[f64]) -> Vec<Passage> {
        // What is due at this very time depends on this image; nothing is due before the beginning of time.
        let mut passages = t_ns.checked_sub(1).map(|before_ns| self.pass(before_ns)).unwrap_or_default();
        for (alarm, phase) in &mut self.alarms {
            *phase = phase.turned(t_ns, alarm.when.holds(values), alarm);
        }
        self.find_due();
        passages.extend(self.pass(t_ns));
        passages
    }

    /// Time passes up to `t_ns` without another image.
    pub(super) fn pass(&mut self, t_ns: u64) -> Vec<Passage> {
        let mut passages = Vec::new();
        if self.due_ns.is_none_or(|due_ns| due_ns > t_ns) {
            return passages;
        }
        for (alarm, (_, phase)) in self.alarms.iter_mut().enumerate() {
            if let Some(due_ns) = phase.due_ns().filter(|due_ns| *due_ns <= t_ns) {
                *phase = phase.passed();
                passages.push(Passage { alarm, t_ns: due_ns, has_come: *phase == Phase::On });
            }
        }
        // Those that come at one time come in the order of the scenario.
        passages.sort_by_key(|passage| passage.t_ns);
        self.find_due();
        passages
    }

    fn find_due(&mut self) {
        self.due_ns = self.alarms.iter().filter_map(|(_, phase)| phase.due_ns()).min();
    }
}
