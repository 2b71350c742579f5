//! The timeline: operations that a session brings along, by time or by condition.
//!
//! An operation *at* 1.2 s acts on the step that ends at 1.2 s: clients are asked before that step's
//! turns, values change with its commit. An operation at 0 acts on the initial values. A condition is
//! judged on each committed image; the operation acts on the step that follows the first image on
//! which it holds, or the n-th time that it comes true, or later by the delay that is asked for.
//!
//! | module | subject |
//! |---|---|
//! | this file | operations, when they happen, and how far they have come |
//! | [`condition`] | conditions as data |
//! | `condition_monitor` | conditions that are judged for sessions that fork |
//! | [`past`] | conditions judged image by image, with what they remember |
//!
//! The timeline is part of the session's state. A checkpoint can be taken up by a session with another
//! timeline if both agree on what has happened so far.

pub mod condition;
mod condition_monitor;
pub mod past;

use std::cmp::Ordering;
use std::fmt;
use std::num::NonZeroU32;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::operation::{Operation, OperationError};
use crate::session::Session;
use crate::signal::{SignalId, SignalType};
use crate::time::{TimeSpan, VirtualTime};

pub use condition::{Back, Condition, Edge, Relation};
use condition_monitor::{ConditionMonitor, ConditionMonitorState};
use past::{Judged, Memories};

/// An operation and when it happens.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Scheduled {
    pub when: When,
    pub operation: Operation,
}

/// When an operation happens, once.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum When {
    /// In the step that ends at this time, rounded up to whole steps; 0 is the set-up.
    At(VirtualTime),
    /// After a condition has come true.
    Once {
        condition: Condition,
        /// Images before this time do not count, though they are part of the past that the condition may look at.
        from: VirtualTime,
        /// Which time that it comes true; the first, unless said otherwise.
        nth: NonZeroU32,
        /// How much later than the step after that image; at once if absent.
        delay: Option<TimeSpan>,
    },
}

impl fmt::Display for When {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::At(at) => write!(f, "at {at}"),
            Self::Once { condition, from, nth, delay } => {
                if let Some(delay) = delay {
                    write!(f, "{delay} ")?;
                }
                write!(f, "after `{condition}`")?;
                if nth.get() > 1 {
                    write!(f, " has come true {nth} times")?;
                }
                if *from > VirtualTime::ZERO { write!(f, " from {from} on") } else { Ok(()) }
            }
        }
    }
}

/// How far an item has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Stage {
    /// Its condition has not held yet.
    Waiting,
    /// It happens in the step that ends at this time.
    Due(VirtualTime),
    Done,
}

/// What an item has seen of its condition.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Seen {
    memories: Memories,
    /// Whether it held on the last image that counted.
    held: bool,
    /// How often it has come true.
    times: u32,
}

impl Seen {
    /// Before the first image. An item at a time has no condition, and nothing to remember.
    fn nothing(condition: Option<&Judged<Comparison>>) -> Self {
        let memories = condition.map(Judged::nothing_seen).unwrap_or_default();
        Self { memories, held: false, times: 0 }
    }
}

#[derive(Clone, Debug)]
struct Item {
    scheduled: Scheduled,
    /// Nothing for a time.
    condition: Option<Judged<Comparison>>,
    seen: Seen,
    stage: Stage,
}

impl Item {
    fn begin(&mut self) {
        self.stage = first_stage(&self.scheduled);
        self.seen = Seen::nothing(self.condition.as_ref());
    }

    fn state(&self) -> ItemState {
        (self.scheduled.clone(), self.stage, self.seen.clone())
    }
}

type ItemState = (Scheduled, Stage, Seen);

/// What a checkpoint keeps of a timeline.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TimelineState {
    #[serde(with = "as_json")]
    items: Vec<ItemState>,
    /// Conditions that no item of this timeline waits for, but one of a session that forks from here may.
    #[serde(with = "as_json")]
    condition_monitors: Vec<ConditionMonitorState>,
}

/// Operations are distinguished by a key, as in recordings. The binary form of checkpoints has no keys,
/// so they are JSON there.
mod as_json {
    use serde::de::DeserializeOwned;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(super) fn serialize<T: Serialize, S: Serializer>(items: &[T], serializer: S) -> Result<S::Ok, S::Error> {
        serde_json::to_string(items).map_err(serde::ser::Error::custom)?.serialize(serializer)
    }

    pub(super) fn deserialize<'de, T, D>(deserializer: D) -> Result<Vec<T>, D::Error>
    where
        T: DeserializeOwned,
        D: Deserializer<'de>,
    {
        serde_json::from_str(&String::deserialize(deserializer)?).map_err(serde::de::Error::custom)
    }
}

impl TimelineState {
    /// What is yet to come: the part that decides how a session goes on.
    pub(crate) fn pending(&self) -> Self {
        let items = self.items.iter().filter(|(_, stage, _)| *stage != Stage::Done).cloned().collect();
        Self { items, condition_monitors: Vec::new() }
    }
}

/// Why a session cannot go on from a checkpoint that was taken under another timeline.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum TimelineError {
    /// This session does something before the checkpoint that the other did not.
    #[error("here {operation} {when}, before the checkpoint at {t_v}; there it did not happen", operation = scheduled.operation, when = scheduled.when)]
    New {
        scheduled: Box<Scheduled>,
        /// When the checkpoint was taken.
        t_v: VirtualTime,
    },
    /// The other session did something before the checkpoint that this one does not.
    #[error("there {operation} {when}, before the checkpoint at {t_v}; here it does not happen", operation = scheduled.operation, when = scheduled.when)]
    Gone {
        scheduled: Box<Scheduled>,
        /// When the checkpoint was taken.
        t_v: VirtualTime,
    },
    /// What a condition remembers is not of that condition.
    #[error("what the checkpoint remembers of {operation} {when} is not of that condition", operation = scheduled.operation, when = scheduled.when)]
    Memories { scheduled: Box<Scheduled> },
}

/// Operations yet to come, and those that have happened.
#[derive(Clone, Debug, Default)]
pub struct Timeline {
    items: Vec<Item>,
    /// The earliest time at which an item is due; conditions may make one due earlier.
    next: Option<VirtualTime>,
    /// An item waits for its condition.
    waits: bool,
    /// Conditions that are judged for others.
    condition_monitors: Vec<ConditionMonitor>,
}

impl Timeline {
    /// The timeline of these operations. Those of one step happen in this order.
    ///
    /// # Errors
    /// A condition on a signal that the session does not have, or with a value that it cannot have.
    pub fn new(scheduled: Vec<Scheduled>, session: &Session) -> Result<Self, OperationError> {
        let item = |scheduled: Scheduled| {
            let condition = match &scheduled.when {
                When::At(_) => None,
                When::Once { condition, .. } => Some(bind(condition, session)?),
            };
            Ok(Item { scheduled, condition, seen: Seen::default(), stage: Stage::Waiting })
        };
        let mut this = Self { items: scheduled.into_iter().map(item).collect::<Result<_, _>>()?, ..Self::default() };
        this.rewind();
        Ok(this)
    }

    /// The same, judging these as well, so that a session with operations on them can fork from this one.
    ///
    /// # Errors
    /// A condition on a signal that the session does not have, or with a value that it cannot have.
    pub fn with_lookouts(mut self, condition_monitors: Vec<When>, session: &Session) -> Result<Self, OperationError> {
        let all: Vec<_> = condition_monitors
            .into_iter()
            .map(|when| ConditionMonitor::new(when, session))
            .collect::<Result<_, _>>()?;
        self.condition_monitors = all.into_iter().flatten().collect();
        self.rewind();
        Ok(self)
    }

    /// The condition monitors that come true with the image committed at `t_v`, which the next step will judge.
    pub(crate) fn coming<'a>(&'a self, session: &'a Session, t_v: VirtualTime) -> impl Iterator<Item = &'a When> {
        self.condition_monitors
            .iter()
            .filter(move |condition_monitor| condition_monitor.is_coming(session, t_v))
            .map(ConditionMonitor::when)
    }

    /// Nothing has happened: the session starts, or restarts.
    pub(crate) fn rewind(&mut self) {
        self.items.iter_mut().for_each(Item::begin);
        self.condition_monitors.iter_mut().for_each(ConditionMonitor::begin);
        self.look_ahead();
    }

    fn look_ahead(&mut self) {
        let due = |item: &Item| if let Stage::Due(at) = item.stage { Some(at) } else { None };
        self.next = self.items.iter().filter_map(due).min();
        self.waits = self.items.iter().any(|item| item.stage == Stage::Waiting);
    }

    /// The operations of the step that ends at `end`, given the image committed at `t_v` before it.
    /// Allocates nothing while nothing happens.
    pub(crate) fn due(&mut self, session: &Session, t_v: VirtualTime, end: VirtualTime) -> Vec<Operation> {
        if self.waits {
            self.judge(session, t_v, end);
        }
        self.condition_monitors.iter_mut().for_each(|condition_monitor| condition_monitor.judge(session, t_v));
        self.take_until(end)
    }

    /// Until when nothing of it happens while the image stays as it is: the first step that ends then or later is one
    /// to ask for. `None` if a condition is being judged, which may look at the past.
    pub(crate) fn rests_until(&self) -> Option<VirtualTime> {
        let judging = self.waits || !self.condition_monitors.is_empty();
        (!judging).then(|| self.next.unwrap_or(VirtualTime::MAX))
    }

    /// The operations of the set-up.
    pub(crate) fn due_at_start(&mut self) -> Vec<Operation> {
        self.take_until(VirtualTime::ZERO)
    }

    fn take_until(&mut self, end: VirtualTime) -> Vec<Operation> {
        if self.next.is_none_or(|next| next > end) {
            return Vec::new();
        }
        let mut taken: Vec<(VirtualTime, Operation)> = Vec::new();
        for item in &mut self.items {
            if let Stage::Due(at) = item.stage
                && at <= end
            {
                item.stage = Stage::Done;
                taken.push((at, item.scheduled.operation.clone()));
            }
        }
        self.look_ahead();
        debug_assert!(self.next.is_none_or(|next| next > end), "nothing stays due that was due until {end}");
        // Several instants may fall into one step: they keep their order; equal ones that of the list.
        taken.sort_by_key(|(at, _)| *at);
        taken.into_iter().map(|(_, operation)| operation).collect()
    }

    fn judge(&mut self, session: &Session, t_v: VirtualTime, end: VirtualTime) {
        let mut changed = false;
        for item in self.items.iter_mut().filter(|item| item.stage == Stage::Waiting) {
            let (When::Once { delay, .. }, Some(condition)) = (&item.scheduled.when, &item.condition) else {
                continue;
            };
            if comes_true(&item.scheduled.when, condition, &mut item.seen, session, t_v) {
                let at = delay.map_or(Some(end), |delay| end.checked_add(delay));
                // Beyond the end of virtual time it never happens.
                item.stage = at.map_or(Stage::Done, Stage::Due);
                changed = true;
            }
        }
        if changed {
            self.look_ahead();
        }
    }

    /// What a checkpoint keeps.
    pub(crate) fn save(&self) -> TimelineState {
        let items = self.items.iter().map(Item::state).collect();
        TimelineState {
            items,
            condition_monitors: self.condition_monitors.iter().filter_map(ConditionMonitor::save).collect(),
        }
    }

    /// Goes on from a checkpoint taken at `t_v`.
    ///
    /// # Errors
    /// The two timelines do not agree on what has happened until then; nothing has changed then.
    pub(crate) fn restore(&mut self, state: &TimelineState, t_v: VirtualTime) -> Result<(), TimelineError> {
        let mut theirs: Vec<Option<&ItemState>> = state.items.iter().map(Some).collect();
        let mut stages = Vec::with_capacity(self.items.len());
        for item in &self.items {
            let monitored =
                state.condition_monitors.iter().find(|condition_monitor| condition_monitor.when == item.scheduled.when);
            // Each of theirs stands for one of ours, so that two equal items stay two.
            let same = theirs.iter_mut().find(|their| their.is_some_and(|(their, ..)| *their == item.scheduled));
            let known = same.and_then(Option::take).map(|(_, stage, seen)| (*stage, seen));
            // What a monitor has seen of a condition is what the item itself would have seen, had it been there.
            let known = known.or(monitored.map(|condition_monitor| (Stage::Waiting, &condition_monitor.seen)));
            stages.push(match (known, &item.scheduled.when) {
                (Some((stage, seen)), _) => {
                    if item.condition.as_ref().is_some_and(|condition| !condition.fits(&seen.memories)) {
                        return Err(TimelineError::Memories { scheduled: Box::new(item.scheduled.clone()) });
                    }
                    (stage, seen.clone())
                }
                (None, When::At(at)) if *at > t_v => (Stage::Due(*at), Seen::default()),
                // Judged at boundaries from `from` on, and the one of the checkpoint is yet to come. What looks at the
                // past would have had to see it.
                (None, When::Once { from, condition, .. }) if *from >= t_v && !condition.has_past() => {
                    (Stage::Waiting, Seen::default())
                }
                (None, _) => {
                    return Err(TimelineError::New { scheduled: Box::new(item.scheduled.clone()), t_v });
                }
            });
        }
        if let Some((gone, ..)) = theirs.into_iter().flatten().find(|(_, stage, _)| *stage == Stage::Done) {
            return Err(TimelineError::Gone { scheduled: Box::new(gone.clone()), t_v });
        }
        debug_assert_eq!(stages.len(), self.items.len(), "every item has its stage");
        for (item, (stage, seen)) in self.items.iter_mut().zip(stages) {
            (item.stage, item.seen) = (stage, seen);
        }
        self.condition_monitors
            .iter_mut()
            .for_each(|condition_monitor| condition_monitor.restore(&state.condition_monitors));
        self.look_ahead();
        Ok(())
    }
}

/// Judges the image committed at `t_v`; true if the condition comes true with it, for the time that is asked for.
fn comes_true(
    when: &When,
    condition: &Judged<Comparison>,
    seen: &mut Seen,
    session: &Session,
    t_v: VirtualTime,
) -> bool {
    let When::Once { from, nth, .. } = when else { return false };
    let holds = condition.judge(&mut seen.memories, t_v.as_nanos(), &mut |one| one.holds(session));
    let counted = holds && t_v >= *from;
    seen.times += u32::from(counted && !seen.held);
    seen.held = counted;
    counted && seen.times >= nth.get()
}

fn first_stage(scheduled: &Scheduled) -> Stage {
    match scheduled.when {
        When::At(at) => Stage::Due(at),
        When::Once { .. } => Stage::Waiting,
    }
}

/// A comparison with its signal found and its value read.
#[derive(Clone, Debug)]
struct Comparison {
    signal: SignalId,
    ty: SignalType,
    relation: Relation,
    value: Vec<u8>,
}

impl Comparison {
    fn holds(&self, session: &Session) -> bool {
        let bytes = session.layout().bytes(self.signal, session.image());
        self.relation.holds(compared(self.ty, bytes, &self.value))
    }
}

fn bind(condition: &Condition, session: &Session) -> Result<Judged<Comparison>, OperationError> {
    Judged::new(condition, &mut |signal, relation, value| {
        let (id, value) = session.valued(signal, value)?;
        Ok(Comparison { signal: id, ty: session.layout().ty(id), relation, value })
    })
}

/// Two values of one type in their order. Texts are ordered by their characters.
fn compared(ty: SignalType, left: &[u8], right: &[u8]) -> Option<Ordering> {
    let SignalType::Elementary(elementary) = ty else {
        // Behind two bytes of length; what is behind the text is zero in canonical form.
        return Some(left.get(2..)?.cmp(right.get(2..)?));
    };
    if elementary.is_real() {
        let real = |bytes: &[u8]| match bytes {
            [a, b, c, d] => f64::from(f32::from_le_bytes([*a, *b, *c, *d])),
            bytes => bytes.first_chunk().map_or(f64::NAN, |bytes| f64::from_le_bytes(*bytes)),
        };
        return real(left).partial_cmp(&real(right));
    }
    Some(ty.integer(left)?.cmp(&ty.integer(right)?))
}
