//! Who may do what on a page: the right that each message needs, and who has it.
//!
//! A message that is added does not compile before its right is named here, and a right not before somebody has it.

use super::Session;
use super::ask::{self, Ask, Verb};
use super::entry::Rank;
use super::error::Refused;
use super::seats::Viewer;
use super::training::Role;

/// What a message needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Right<'a> {
    /// Look, which changes nothing for anybody else.
    Look,
    /// Start another session from a moment of this one.
    Fork,
    /// Make a case of what was done.
    Keep,
    /// End the session, or close a recording.
    Stop,
    /// Acknowledge alarms, or put them aside.
    Attend,
    /// Take or leave the seat of this panel.
    Sit(&'a str),
    /// Write the signal of this number, as the panels do.
    Write(usize),
    /// Reset the session from the seat of this panel, which has a key for it.
    Reset(&'a str),
    /// Act past the panels: on virtual time, failures, forced values.
    Control,
    /// Decide how a lesson continues.
    Train,
    /// Show this view to all viewers.
    Present(&'a str),
}

impl Ask {
    /// The right to send this message.
    pub(super) fn needs(&self) -> Right<'_> {
        match self {
            Self::Subscribe { .. }
            | Self::Watch { .. }
            | Self::Draw { .. }
            | Self::Maps { .. }
            | Self::Show { .. }
            | Self::Trace { .. }
            | Self::Live => Right::Look,
            Self::Fork { .. } => Right::Fork,
            Self::Case { .. } => Right::Keep,
            Self::Operate { operation: Verb::Stop } => Right::Stop,
            Self::Acknowledge { .. } | Self::Shelve { .. } => Right::Attend,
            Self::Seat { panel, .. } => Right::Sit(panel),
            Self::Write { signal, .. } => Right::Write(*signal),
            Self::Reset { panel } => Right::Reset(panel),
            Self::Operate { operation: Verb::Hold | Verb::Go | Verb::Step }
            | Self::Fail { .. }
            | Self::Disturb { .. }
            | Self::Parameter { .. }
            | Self::Variable { .. }
            | Self::Force { .. } => Right::Control,
            Self::Train(_) => Right::Train,
            Self::View { view } => Right::Present(view),
        }
    }
}

/// Refuses what a viewer of this rank does not have the right to do.
pub(super) fn check(right: Right<'_>, session: &Session, (viewer, rank): (Viewer, Rank)) -> Result<(), Refused> {
    // Whoever only looks does nothing else, whatever right is added.
    if right != Right::Look && rank < Rank::Operates {
        return Err(Refused::LooksOnly);
    }
    if session.is_driven() && acts_on_session(right) {
        return Err(Refused::Driven);
    }
    match right {
        Right::Look => Ok(()),
        Right::Attend => is_live(session),
        Right::Fork | Right::Keep => is_not_trainee(session),
        Right::Stop if session.is_looked_back_at() => Ok(()),
        Right::Stop | Right::Control => is_live(session).and_then(|()| is_not_trainee(session)),
        Right::Sit(panel) => may_sit(panel, session, rank),
        Right::Write(signal) => is_live(session).and_then(|()| may_write(signal, session, viewer)),
        Right::Reset(panel) => is_live(session).and_then(|()| may_reset(panel, session, viewer)),
        Right::Train => is_live(session).and_then(|()| may_train(session)),
        Right::Present(view) => {
            let whose = (viewer, role(session));
            is_live(session).and_then(|()| session.called.may_call(view, whose, &session.seats))
        }
    }
}

/// Whether it changes the session that is under way: while real PLCs are driven to where the next one begins there is none, and
/// it would take what is asked then.
fn acts_on_session(right: Right<'_>) -> bool {
    match right {
        Right::Look | Right::Fork | Right::Keep | Right::Stop | Right::Sit(_) | Right::Present(_) => false,
        Right::Attend | Right::Write(_) | Right::Reset(_) | Right::Control | Right::Train => true,
    }
}

/// Whether failures and forces are kept from whoever has this page.
pub(super) fn is_trainee(session: &Session) -> bool {
    role(session) == Some(Role::Trainee)
}

fn role(session: &Session) -> Option<Role> {
    session.training.as_ref().map(|training| training.role)
}

/// Nobody operates a recording, or what is over.
fn is_live(session: &Session) -> Result<(), Refused> {
    if session.recorded_to.is_some() {
        Err(Refused::Recorded)
    } else if session.is_complete() {
        Err(Refused::Over)
    } else {
        Ok(())
    }
}

fn is_not_trainee(session: &Session) -> Result<(), Refused> {
    if is_trainee(session) { Err(Refused::Trainee) } else { Ok(()) }
}

fn may_train(session: &Session) -> Result<(), Refused> {
    match role(session) {
        Some(Role::Trainer) => Ok(()),
        Some(Role::Trainee) => Err(Refused::Trainee),
        None => Err(Refused::NoLesson),
    }
}

/// A panel that is not on the page does not exist for its viewers, so that is checked first.
fn may_sit(panel: &str, session: &Session, rank: Rank) -> Result<(), Refused> {
    if session.known.hidden.contains(panel) {
        return Err(Refused::NoPanel(panel.to_owned()));
    }
    is_live(session)?;
    if rank < Rank::Trains && session.known.trainers.contains(panel) {
        return Err(Refused::Trainers(panel.to_owned()));
    }
    Ok(())
}

/// A lesson begins again at its start, which is not where its session does, and its attempts are counted.
fn may_reset(panel: &str, session: &Session, viewer: Viewer) -> Result<(), Refused> {
    let keys = session.known.resetting.get(panel).filter(|_| !session.known.hidden.contains(panel));
    let keys = keys.ok_or_else(|| Refused::NoReset(panel.to_owned()))?;
    if session.training.is_some() {
        return Err(Refused::InLesson);
    }
    // A key is pressed whole or not at all.
    let mut pressed = session.plan.signals().iter().filter(|declared| keys.contains(declared.name.as_str()));
    pressed.try_for_each(|declared| ask::writer(declared, &session.known))?;
    let panel = std::iter::once(panel.to_owned()).collect();
    session.seats.sits_at_one_of(&panel, viewer).then_some(()).ok_or(Refused::NotSeated)
}

fn may_write(signal: usize, session: &Session, viewer: Viewer) -> Result<(), Refused> {
    let declared = session.declared(signal)?;
    session.seats.may_write(viewer, declared.name.as_str())
}
