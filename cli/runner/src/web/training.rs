//! A lesson on two pages: whose page it is, what the trainer asks, what has failed.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use onescan_scenario::panel_file::Seat;
use onescan_server::digest::TrajectoryDigest;
use onescan_server::mailbox::Mailbox;
use onescan_server::observer::{Observer, RecordError};
use onescan_server::operation::{Control, Operation, OperatorInput, SignalFault};
use onescan_server::session::Session;
use onescan_server::signal::SignalName;
use onescan_server::time::VirtualTime;
use schemars::JsonSchema;
use serde::Serialize;

use super::lesson::LessonBoard;

/// What a page needs of a lesson.
#[derive(Clone, Debug)]
pub(crate) struct Training {
    /// Whose page it is.
    pub(crate) role: Role,
    /// Where the trainer's requests wait.
    pub(crate) turns: TurnQueue,
    /// The lesson's name.
    pub(crate) lesson: String,
    /// What the trainee reads about it.
    pub(crate) about: Option<String>,
    /// The view with which its pages begin.
    pub(crate) view: Option<String>,
    /// The prepared states by name.
    pub(crate) starts: Vec<String>,
    /// What must hold to pass it.
    pub(crate) asked: Vec<String>,
    /// What must not be done more often than is forgiven.
    pub(crate) mistakes: Vec<Forgiven>,
    /// How it goes.
    pub(crate) board: LessonBoard,
}

/// A mistake, and how many are forgiven.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(crate) struct Forgiven {
    pub(crate) name: String,
    pub(crate) at_most: u32,
}

/// Whose page it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Role {
    /// Who takes the lesson: virtual time, failures and the trainer's panels are not theirs.
    Trainee,
    /// Who holds it.
    Trainer,
}

impl Role {
    /// Whether a panel of this seat is on the page.
    pub(super) fn sees(self, seat: Seat) -> bool {
        self == Self::Trainer || seat != Seat::Trainer
    }
}

/// How a lesson goes on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Turn {
    /// From its start again.
    Repeat,
    /// From an earlier moment.
    Back(VirtualTime),
    /// From a prepared state.
    Jump(String),
}

/// The trainer's request, from any thread for the one that drives the lesson; clones share it. One waits at most: a newer one
/// replaces it.
#[derive(Clone, Debug)]
pub(crate) struct TurnQueue {
    turn: Arc<Mutex<Option<Turn>>>,
    mailbox: Mailbox,
}

impl TurnQueue {
    /// Nobody has asked; `mailbox` is that of the session.
    pub(crate) fn new(mailbox: Mailbox) -> Self {
        Self { turn: Arc::default(), mailbox }
    }

    /// Lets the attempt that is under way end, and the lesson go on like this.
    pub(super) fn push(&self, turn: Turn) {
        *lock(&self.turn) = Some(turn);
        self.mailbox.control(Control::Stop);
    }

    /// How the lesson goes on; nothing if nobody asked.
    pub(crate) fn take(&self) -> Option<Turn> {
        lock(&self.turn).take()
    }
}

/// A thread that panicked under a lock has left a whole value.
fn lock<T>(value: &Mutex<T>) -> MutexGuard<'_, T> {
    value.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What does not work as it should at a moment.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct AtWork {
    /// Failures, as `component.mode`.
    failed: BTreeSet<String>,
    /// Signals with the fault on their way.
    disturbed: BTreeMap<SignalName, SignalFault>,
    /// Parameters that were changed, as `component.key`, with their values.
    changed: BTreeMap<String, String>,
}

impl AtWork {
    /// The failures, as `component.mode`.
    pub(super) fn failed(&self) -> &BTreeSet<String> {
        &self.failed
    }

    /// The parameters that were changed, as `component.key`, with their values.
    pub(super) fn changed(&self) -> &BTreeMap<String, String> {
        &self.changed
    }

    /// Whether a signal has this fault.
    pub(super) fn has(&self, signal: &SignalName, fault: &SignalFault) -> bool {
        self.disturbed.get(signal) == Some(fault)
    }

    fn take(&mut self, operation: &Operation) {
        match operation {
            Operation::Fail { component, mode, .. } => {
                self.failed.insert(format!("{component}.{mode}"));
            }
            Operation::Repair { component, mode, .. } => {
                self.failed.remove(&format!("{component}.{mode}"));
            }
            Operation::Disturb { signal, fault } => {
                self.disturbed.insert(signal.clone(), fault.clone());
            }
            Operation::Mend { signal } => {
                self.disturbed.remove(signal);
            }
            Operation::ChangeParameter { component, parameter, value, .. } => {
                self.changed.insert(format!("{component}.{parameter}"), value.clone());
            }
            Operation::RestoreParameter { component, parameter, .. } => {
                self.changed.remove(&format!("{component}.{parameter}"));
            }
            // Nothing else fails, disturbs or changes what a machine is.
            _ => {}
        }
    }
}

/// What does not work as it should now; clones share it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Failing {
    now: Arc<Mutex<AtWork>>,
    /// What the next session begins with.
    first: Arc<Mutex<AtWork>>,
}

impl Failing {
    /// Keeps it up to date with a session.
    pub(crate) fn observer(&self) -> Box<dyn Observer> {
        Box::new(self.clone())
    }

    /// The session that begins next goes on from a moment at which this was at work. What was before a checkpoint of others is
    /// not known.
    pub(crate) fn begin_with(&self, at_work: AtWork) {
        *lock(&self.first) = at_work;
    }

    /// All of it.
    pub(crate) fn now(&self) -> AtWork {
        lock(&self.now).clone()
    }
}

impl Observer for Failing {
    fn begin(&mut self, _: &Session, _: &TrajectoryDigest) -> Result<(), RecordError> {
        *lock(&self.now) = std::mem::take(&mut *lock(&self.first));
        Ok(())
    }

    fn step(&mut self, _: &Session, _: &TrajectoryDigest) -> Result<(), RecordError> {
        Ok(())
    }

    fn operated(&mut self, input: &OperatorInput) -> Result<(), RecordError> {
        lock(&self.now).take(&input.operation);
        Ok(())
    }

    fn end(&mut self, _: &Session) -> Result<(), RecordError> {
        Ok(())
    }
}
