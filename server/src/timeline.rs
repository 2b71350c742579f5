//! The timeline: operations that a session brings along, by time or by condition.
//!
//! An operation *at* 1.2 s acts on the step that ends at 1.2 s: clients are asked before that step's
//! turns, values change with its commit. An operation at 0 acts on the initial values. A condition is
//! judged on each committed image; the operation acts on the step that follows the first image on
//! which it holds, or later by the delay that is asked for.
//!
//! The timeline is part of the session's state. A checkpoint can be taken up by a session with another
//! timeline if both agree on what has happened so far.

use std::cmp::Ordering;
use std::fmt;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::operation::{Operation, OperationError};
use crate::session::Session;
use crate::signal::{SignalId, SignalName, SignalType};
use crate::time::{TimeSpan, VirtualTime};

/// An operation and when it happens.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Scheduled {
    /// When.
    pub when: When,
    /// What.
    pub operation: Operation,
}

/// When an operation happens, once.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum When {
    /// In the step that ends at this time, rounded up to whole steps; 0 is the set-up.
    At(VirtualTime),
    /// After a condition has come true.
    Once {
        /// The condition.
        condition: Condition,
        /// Images before this time do not count.
        from: VirtualTime,
        /// How much later than the step after that image; at once if absent.
        delay: Option<TimeSpan>,
    },
}

/// Something that an image shows or does not show.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Condition {
    /// A signal compared with a value.
    Compare {
        /// The signal.
        signal: SignalName,
        /// How.
        relation: Relation,
        /// The value, in the text of the signal's type.
        value: String,
    },
    /// All of these.
    All(Vec<Condition>),
    /// At least one of these.
    Any(Vec<Condition>),
    /// Not this.
    Not(Box<Condition>),
}

/// How a signal compares with a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Relation {
    /// `=`
    Equal,
    /// `<>`
    Unequal,
    /// `<`
    Less,
    /// `<=`
    AtMost,
    /// `>`
    Greater,
    /// `>=`
    AtLeast,
}

impl Relation {
    /// Nothing compares with NaN, so every relation but `<>` is false then.
    fn holds(self, ordering: Option<Ordering>) -> bool {
        match self {
            Self::Equal => ordering == Some(Ordering::Equal),
            Self::Unequal => ordering != Some(Ordering::Equal),
            Self::Less => ordering == Some(Ordering::Less),
            Self::AtMost => matches!(ordering, Some(Ordering::Less | Ordering::Equal)),
            Self::Greater => ordering == Some(Ordering::Greater),
            Self::AtLeast => matches!(ordering, Some(Ordering::Greater | Ordering::Equal)),
        }
    }

    fn sign(self) -> &'static str {
        match self {
            Self::Equal => "=",
            Self::Unequal => "<>",
            Self::Less => "<",
            Self::AtMost => "<=",
            Self::Greater => ">",
            Self::AtLeast => ">=",
        }
    }
}

impl fmt::Display for Condition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let list = |f: &mut fmt::Formatter<'_>, all: &[Self], word: &str| {
            for (index, one) in all.iter().enumerate() {
                if index > 0 {
                    write!(f, " {word} ")?;
                }
                match one {
                    Self::Compare { .. } | Self::Not(_) => write!(f, "{one}")?,
                    Self::All(_) | Self::Any(_) => write!(f, "({one})")?,
                }
            }
            Ok(())
        };
        match self {
            Self::Compare { signal, relation, value } => write!(f, "{signal} {} {value}", relation.sign()),
            Self::All(all) if all.is_empty() => f.write_str("always"),
            Self::All(all) => list(f, all, "and"),
            Self::Any(all) if all.is_empty() => f.write_str("never"),
            Self::Any(all) => list(f, all, "or"),
            Self::Not(inner) => write!(f, "not ({inner})"),
        }
    }
}

impl fmt::Display for When {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::At(at) => write!(f, "at {at}"),
            Self::Once { condition, from, delay } => {
                if let Some(delay) = delay {
                    write!(f, "{delay} ")?;
                }
                write!(f, "after `{condition}`")?;
                if *from > VirtualTime::ZERO { write!(f, " from {from} on") } else { Ok(()) }
            }
        }
    }
}

/// A condition with its signals found and its values read.
#[derive(Clone, Debug)]
enum Bound {
    Compare { signal: SignalId, ty: SignalType, relation: Relation, value: Vec<u8> },
    All(Vec<Bound>),
    Any(Vec<Bound>),
    Not(Box<Bound>),
}

/// How far an item has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Stage {
    /// Its condition has not held yet.
    Waiting,
    /// It happens in the step that ends at this time.
    Due(VirtualTime),
    /// It has happened.
    Done,
}

#[derive(Clone, Debug)]
struct Item {
    scheduled: Scheduled,
    /// Nothing for a time.
    condition: Option<Bound>,
    stage: Stage,
}

/// What a checkpoint keeps of a timeline.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TimelineState {
    #[serde(with = "as_json")]
    items: Vec<(Scheduled, Stage)>,
}

/// Operations are told apart by a key, as in recordings. The binary form of checkpoints has no keys,
/// so they are JSON there.
mod as_json {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    use super::{Scheduled, Stage};

    pub(super) fn serialize<S: Serializer>(items: &[(Scheduled, Stage)], serializer: S) -> Result<S::Ok, S::Error> {
        serde_json::to_string(items).map_err(serde::ser::Error::custom)?.serialize(serializer)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<(Scheduled, Stage)>, D::Error> {
        serde_json::from_str(&String::deserialize(deserializer)?).map_err(serde::de::Error::custom)
    }
}

impl TimelineState {
    /// What is yet to come: the part that decides how a session goes on.
    pub(crate) fn pending(&self) -> Self {
        Self { items: self.items.iter().filter(|(_, stage)| *stage != Stage::Done).cloned().collect() }
    }
}

/// Why a session cannot go on from a checkpoint that was taken under another timeline.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum TimelineError {
    /// This session does something before the checkpoint that the other did not.
    #[error("here {operation} {when}, before the checkpoint at {t_v}; there it did not happen", operation = scheduled.operation, when = scheduled.when)]
    New {
        /// What, and when.
        scheduled: Box<Scheduled>,
        /// When the checkpoint was taken.
        t_v: VirtualTime,
    },
    /// The other session did something before the checkpoint that this one does not.
    #[error("there {operation} {when}, before the checkpoint at {t_v}; here it does not happen", operation = scheduled.operation, when = scheduled.when)]
    Gone {
        /// What, and when.
        scheduled: Box<Scheduled>,
        /// When the checkpoint was taken.
        t_v: VirtualTime,
    },
}

/// Operations yet to come, and those that have happened.
#[derive(Clone, Debug, Default)]
pub struct Timeline {
    items: Vec<Item>,
    /// The earliest time at which an item is due; conditions may make one due earlier.
    next: Option<VirtualTime>,
    /// An item waits for its condition.
    waits: bool,
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
            Ok(Item { scheduled, condition, stage: Stage::Waiting })
        };
        let mut this = Self { items: scheduled.into_iter().map(item).collect::<Result<_, _>>()?, ..Self::default() };
        this.rewind();
        Ok(this)
    }

    /// Nothing has happened: the session starts, or restarts.
    pub(crate) fn rewind(&mut self) {
        for item in &mut self.items {
            item.stage = first_stage(&item.scheduled);
        }
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
        self.take_until(end)
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
        // Several instants may fall into one step: they keep their order; equal ones that of the list.
        taken.sort_by_key(|(at, _)| *at);
        taken.into_iter().map(|(_, operation)| operation).collect()
    }

    fn judge(&mut self, session: &Session, t_v: VirtualTime, end: VirtualTime) {
        let mut changed = false;
        for item in self.items.iter_mut().filter(|item| item.stage == Stage::Waiting) {
            let (When::Once { from, delay, .. }, Some(condition)) = (&item.scheduled.when, &item.condition) else {
                continue;
            };
            if t_v >= *from && holds(condition, session) {
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
        TimelineState { items: self.items.iter().map(|item| (item.scheduled.clone(), item.stage)).collect() }
    }

    /// Goes on from a checkpoint taken at `t_v`.
    ///
    /// # Errors
    /// The two timelines do not agree on what has happened until then; nothing has changed then.
    pub(crate) fn restore(&mut self, state: &TimelineState, t_v: VirtualTime) -> Result<(), TimelineError> {
        let mut theirs: Vec<Option<&(Scheduled, Stage)>> = state.items.iter().map(Some).collect();
        let mut stages = Vec::with_capacity(self.items.len());
        for item in &self.items {
            let same = theirs.iter_mut().find(|their| their.is_some_and(|(their, _)| *their == item.scheduled));
            stages.push(match (same.and_then(Option::take), &item.scheduled.when) {
                (Some((_, stage)), _) => *stage,
                (None, When::At(at)) if *at > t_v => Stage::Due(*at),
                // Judged at boundaries from `from` on, and the one of the checkpoint is yet to come.
                (None, When::Once { from, .. }) if *from >= t_v => Stage::Waiting,
                (None, _) => {
                    return Err(TimelineError::New { scheduled: Box::new(item.scheduled.clone()), t_v });
                }
            });
        }
        if let Some((gone, _)) = theirs.into_iter().flatten().find(|(_, stage)| *stage == Stage::Done) {
            return Err(TimelineError::Gone { scheduled: Box::new(gone.clone()), t_v });
        }
        for (item, stage) in self.items.iter_mut().zip(stages) {
            item.stage = stage;
        }
        self.look_ahead();
        Ok(())
    }
}

fn first_stage(scheduled: &Scheduled) -> Stage {
    match scheduled.when {
        When::At(at) => Stage::Due(at),
        When::Once { .. } => Stage::Waiting,
    }
}

fn bind(condition: &Condition, session: &Session) -> Result<Bound, OperationError> {
    let list = |all: &[Condition]| all.iter().map(|one| bind(one, session)).collect::<Result<Vec<_>, _>>();
    Ok(match condition {
        Condition::Compare { signal, relation, value } => {
            let (id, value) = session.valued(signal, value)?;
            Bound::Compare { signal: id, ty: session.layout().ty(id), relation: *relation, value }
        }
        Condition::All(all) => Bound::All(list(all)?),
        Condition::Any(all) => Bound::Any(list(all)?),
        Condition::Not(inner) => Bound::Not(Box::new(bind(inner, session)?)),
    })
}

fn holds(condition: &Bound, session: &Session) -> bool {
    match condition {
        Bound::Compare { signal, ty, relation, value } => {
            let bytes = session.layout().bytes(*signal, session.image());
            relation.holds(compared(*ty, bytes, value))
        }
        Bound::All(all) => all.iter().all(|one| holds(one, session)),
        Bound::Any(all) => all.iter().any(|one| holds(one, session)),
        Bound::Not(inner) => !holds(inner, session),
    }
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
