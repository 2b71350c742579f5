//! The gateway: what it has sent, and what it makes of what it reads.

use super::plc::View;

/// One request of the gateway.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct Message {
    /// The session's number; 0 leaves whatever session the PLC is in.
    pub(crate) session: u32,
    /// The grant, counted from the session's number; 0 in a session's first.
    pub(crate) step: u32,
}

/// What `SDSP_Answer` says of a grant whose time is not later than the one before.
const TIME_STANDS_STILL: i64 = 5;

/// A gateway, right or wrong.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gateway {
    /// The numbers of its sessions.
    pub(crate) sessions: &'static [u32],
    /// How many grants a session has.
    pub(crate) grants: u32,
    /// It looks at `SDSP_Joined` beside `SDSP_Done`.
    pub(crate) looks_at_joined: bool,
    /// It compares `SDSP_Done` with the grant that it waits for.
    pub(crate) looks_at_done: bool,
    /// It looks at `SDSP_Answer` for a grant that is never run.
    pub(crate) looks_at_time: bool,
}

/// Where it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Progress {
    /// Its session, by position; behind the last it is silent.
    pub(crate) session: usize,
    /// The grant that it waits for: 0 while it waits for the PLC to join, one more than there are when all
    /// are done.
    pub(crate) waiting: u32,
}

impl Progress {
    fn next_session(self) -> Self {
        Self { session: self.session + 1, waiting: 0 }
    }

    /// Where it is when a reading has shown that.
    pub(crate) fn after(self, verdict: Verdict) -> Self {
        match verdict {
            Verdict::Done => Self { waiting: self.waiting + 1, ..self },
            Verdict::Over => self.next_session(),
        }
    }
}

/// What a reading shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Verdict {
    /// The grant is done, and these are its outputs.
    Done,
    /// The PLC was restarted; the session is over.
    Over,
}

impl Gateway {
    pub(crate) fn new(sessions: &'static [u32], grants: u32) -> Self {
        Self { sessions, grants, looks_at_joined: true, looks_at_done: true, looks_at_time: true }
    }

    /// Everything that may still arrive: all of the sessions that are over, what was sent of this one.
    pub(crate) fn in_flight(self, at: Progress) -> impl Iterator<Item = Message> {
        let over = self.sessions.iter().take(at.session).map(move |session| (*session, self.grants));
        let now = self.sessions.get(at.session).map(|session| (*session, at.waiting.min(self.grants)));
        let steps = |(session, last)| (0..=last).map(move |step| Message { session, step });
        let leave = (at.session > 0).then_some(Message { session: 0, step: 0 });
        over.chain(now).flat_map(steps).chain(leave)
    }

    /// What it makes of a reading; nothing if it goes on waiting.
    pub(crate) fn judge(self, at: Progress, seen: View) -> Option<Verdict> {
        let session = i64::from(*self.sessions.get(at.session)?);
        if at.waiting > self.grants {
            return None;
        }
        let done = session + i64::from(at.waiting);
        let is_joined = seen.joined == session || !self.looks_at_joined;
        if is_joined && (seen.done == done || !self.looks_at_done) {
            Some(Verdict::Done)
        } else if at.waiting == 0 {
            None
        } else if !(is_joined && seen.done == done - 1) {
            Some(Verdict::Over)
        } else if at.waiting == 1 && seen.answer == TIME_STANDS_STILL && self.looks_at_time {
            // It was restarted, and this grant was what it joined with.
            Some(Verdict::Over)
        } else {
            None
        }
    }

    /// Where it is when it gives its session up; nothing when it has none.
    pub(crate) fn leave(self, at: Progress) -> Option<Progress> {
        (at.session < self.sessions.len()).then(|| at.next_session())
    }
}
