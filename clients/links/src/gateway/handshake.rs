//! The handshake of one scan, one step: sans-IO.
//!
//! `[SDSP]` sec. V-A. The gateway writes inputs and `t_v`, then the number of the grant; it
//! waits until the PLC names that number as done; it takes the outputs. The words are those of the shim
//! (`plc-shim/iec-project/shim/globals.st`).
//!
//! | phase | asks for | left when |
//! |---|---|---|
//! | unlinked | connect | connected |
//! | surveying | read | the PLC is as it must be: joined, or fresh |
//! | writing | write the order | written |
//! | awaiting | read | the order is answered |
//! | at rest | nothing | the session wants the next grant |
//!
//! A PLC that still takes part in an earlier session, and does not count its starts, is asked to join the new one after it has
//! stood still for a while: its program answers that the PLC must be started cold, and whoever can do that sees it there.
//!
//! A broken connection leads to *unlinked* with the order kept. After it the PLC is surveyed before anything is
//! written: it has run the grant, or it has not. An order is the same whenever it is written, and the PLC runs
//! the next number only; so an order that comes twice, or late, is run once.

use onescan_server::time::VirtualTime;

use super::answer::Answer;
use super::fault::GatewayFault;

/// What the gateway writes: all of it at every write, the grant last.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Order {
    pub session: u32,
    pub limit: u32,
    pub t_v: VirtualTime,
    pub grant: u32,
    /// `PLC_Start`: a cold start is wanted when it is one more than the boot counter.
    pub start: u32,
}

/// What the gateway reads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Report {
    pub joined: u32,
    pub done: u32,
    pub answer: Answer,
    /// `SDSP_Layout`: of which mapping the program was made, 0 for none.
    pub layout: u32,
    /// `PLC_Boots`, if the PLC counts its starts.
    pub boots: Option<u32>,
    /// `PLC_Running`, if the PLC distinguishes RUN from STOP.
    pub running: Option<bool>,
}

/// What the handshake wants done next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ask {
    /// Connect, and check the mapping.
    Connect,
    /// Write inputs and this.
    Write(Order),
    /// Read the words and the outputs.
    Read,
    /// Nothing: the last order is done.
    Nothing,
}

/// Something that the session's operator ought to know; nothing is wrong yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Notice {
    /// The PLC must be started cold, and the link cannot do it.
    StartPlc,
    /// The connection was lost and is back; the order under way is resumed.
    Back,
    /// The program was made without a scenario, so that its mapping cannot be held against this one.
    NoLayout,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Unlinked,
    Surveying,
    Writing,
    Awaiting,
    AtRest,
}

/// What the order under way is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Goal {
    /// That the PLC joins, at this virtual time.
    Join(VirtualTime),
    /// That the PLC is started cold and then joins.
    Start(VirtualTime),
    /// That it runs the order's grant.
    Grant,
}

/// A PLC that takes part in a session that is not this gateway's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Leftover {
    report: Report,
    /// It has not moved for a while.
    is_still: bool,
    /// It has been said that the PLC must be started.
    is_reported: bool,
}

/// The gateway's side of the handshake.
#[derive(Clone, Debug)]
pub struct Handshake {
    phase: Phase,
    goal: Goal,
    order: Order,
    /// The highest number that was ever used here.
    highest: u32,
    /// The boot counter when the PLC joined.
    boots: Option<u32>,
    last: Report,
    notice: Option<Notice>,
    is_lost: bool,
    /// How the PLC was found, if an earlier session was left in it.
    leftover: Option<Leftover>,
    /// The number of the scenario's mapping, if it has one.
    layout: Option<u32>,
    /// It has been said that the PLC shows no number.
    is_layout_reported: bool,
}

impl Default for Handshake {
    fn default() -> Self {
        Self::new()
    }
}

impl Handshake {
    /// There is no connection and no session.
    pub fn new() -> Self {
        Self {
            phase: Phase::Unlinked,
            goal: Goal::Join(VirtualTime::ZERO),
            order: Order::default(),
            highest: 0,
            boots: None,
            last: Report::default(),
            notice: None,
            is_lost: false,
            leftover: None,
            layout: None,
            is_layout_reported: false,
        }
    }

    /// The same for a PLC whose program must have been made for the mapping with this number.
    pub fn expecting(self, layout: Option<u32>) -> Self {
        Self { layout, ..self }
    }

    /// Begins a session at `t_v`; done when the PLC has joined it.
    pub fn join(&mut self, t_v: VirtualTime) {
        self.goal = Goal::Join(t_v);
        self.order = Order::default();
        (self.boots, self.leftover) = (None, None);
        self.survey();
    }

    /// Grants a turn that ends at `t_v`; done when the PLC has run it.
    ///
    /// # Errors
    /// There is no number left.
    pub fn grant(&mut self, t_v: VirtualTime) -> Result<(), GatewayFault> {
        let used_up = GatewayFault::NumbersUsedUp(self.order.grant);
        self.order.grant = self.order.grant.checked_add(1).ok_or(used_up)?;
        self.order.t_v = t_v;
        self.highest = self.highest.max(self.order.grant);
        self.goal = Goal::Grant;
        // Without a connection the PLC is surveyed before anything is written: it may be another one by now.
        self.phase = if self.phase == Phase::Unlinked { Phase::Unlinked } else { Phase::Writing };
        Ok(())
    }

    /// What is to be done now.
    pub fn ask(&self) -> Ask {
        match self.phase {
            Phase::Unlinked => Ask::Connect,
            Phase::Surveying | Phase::Awaiting => Ask::Read,
            Phase::Writing => Ask::Write(self.order),
            Phase::AtRest => Ask::Nothing,
        }
    }

    /// There is a connection, and the PLC has all that is mapped.
    pub fn connected(&mut self) {
        self.phase = Phase::Surveying;
    }

    /// The connection is gone.
    pub fn lost(&mut self) {
        self.is_lost = true;
        self.phase = Phase::Unlinked;
    }

    /// The order is on its way.
    pub fn written(&mut self) {
        if self.phase == Phase::Writing {
            self.phase = Phase::Awaiting;
        }
    }

    /// Nothing has come of the order for a while: it is written once more. A PLC in which an earlier session was left is nobody's
    /// then, and is asked to join this one.
    ///
    /// # Errors
    /// There is no number left.
    pub fn quiet(&mut self) -> Result<(), GatewayFault> {
        match (self.phase, self.goal, &mut self.leftover) {
            (Phase::Surveying, Goal::Join(t_v), Some(left)) => {
                let report = left.report;
                // The first time it may just have been found.
                if std::mem::replace(&mut left.is_still, true) { self.order_session(t_v, report) } else { Ok(()) }
            }
            (Phase::Awaiting, Goal::Join(_), Some(left)) if self.last.joined == left.report.joined => {
                // In STOP it does not even say that it must be started.
                if !std::mem::replace(&mut left.is_reported, true) {
                    self.notice = Some(Notice::StartPlc);
                }
                self.phase = Phase::Writing;
                Ok(())
            }
            (Phase::Awaiting, ..) => {
                self.phase = Phase::Writing;
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// What the operator ought to know, once.
    pub fn take_notice(&mut self) -> Option<Notice> {
        self.notice.take()
    }

    /// Looks at what was read. The outputs read with it are those of the grant if nothing is asked for then.
    ///
    /// # Errors
    /// The PLC cannot go on in this session.
    pub fn look(&mut self, report: Report) -> Result<(), GatewayFault> {
        self.last = report;
        if std::mem::take(&mut self.is_lost) {
            self.notice = Some(Notice::Back);
        }
        if let Answer::Other(word) = report.answer {
            return Err(self.nonsense(format!("SDSP_Answer is {word}")));
        }
        match (self.goal, self.phase) {
            (_, Phase::AtRest | Phase::Unlinked | Phase::Writing) => Ok(()),
            (Goal::Join(t_v), Phase::Surveying) => self.begin(t_v, report),
            (Goal::Join(t_v), Phase::Awaiting) => self.look_for_join(t_v, report),
            (Goal::Start(t_v), _) => self.look_for_start(t_v, report),
            (Goal::Grant, _) => self.look_for_done(report),
        }
    }

    /// Why the order is not done, when the time for it is over.
    pub fn late(&self, after: std::time::Duration) -> GatewayFault {
        let what = self.what();
        match (self.last.running, self.goal, self.last.answer) {
            (Some(false), ..) => GatewayFault::InStop { what },
            (_, Goal::Start(_), _) | (_, Goal::Join(_), Answer::MustBeStarted) => GatewayFault::MustBeStarted,
            (.., answer) => GatewayFault::NotAnswered { what, after, answer },
        }
    }

    /// The order under way in words.
    pub fn what(&self) -> String {
        match self.goal {
            Goal::Join(_) => format!("the start of session {}", self.order.session),
            Goal::Start(_) => "the cold start of the PLC".to_owned(),
            Goal::Grant => format!("grant {} at t_v = {}", self.order.grant - self.order.session, self.order.t_v),
        }
    }

    fn survey(&mut self) {
        if self.phase != Phase::Unlinked {
            self.phase = Phase::Surveying;
        }
    }

    /// A PLC that has joined nothing is notified of the new session; another one must be restarted before.
    fn begin(&mut self, t_v: VirtualTime, report: Report) -> Result<(), GatewayFault> {
        if report.answer == Answer::NotSimulated {
            return Err(GatewayFault::NotSimulated);
        }
        self.compare_layout(report)?;
        // The order was written before the connection broke: it has been taken, or it is written again.
        if self.order.session != 0 && report.joined == self.order.session {
            return self.look_for_join(t_v, report);
        }
        if self.order.session != 0 && report.joined == 0 && report.answer != Answer::MustBeStarted {
            self.phase = Phase::Writing;
            return Ok(());
        }
        if report.joined != 0 && report.boots.is_none() && report.answer != Answer::MustBeStarted {
            return self.wait_for_quiet(report);
        }
        if report.joined != 0 || report.answer == Answer::MustBeStarted {
            self.want_start(t_v, report);
            return Ok(());
        }
        self.order_session(t_v, report)
    }

    /// While somebody else's grants are run nothing may be written: inputs would get between that one's inputs and grant.
    fn wait_for_quiet(&mut self, report: Report) -> Result<(), GatewayFault> {
        let moved = |left: &Leftover| (left.report.joined, left.report.done) != (report.joined, report.done);
        if self.leftover.as_ref().is_some_and(moved) {
            return Err(GatewayFault::InUse { joined: report.joined });
        }
        self.leftover.get_or_insert(Leftover { report, is_still: false, is_reported: false });
        Ok(())
    }

    fn order_session(&mut self, t_v: VirtualTime, report: Report) -> Result<(), GatewayFault> {
        // Grants count on from the number of their session, and a session's number is above all that were used: a grant of
        // an earlier session is never the next one. There is no limit, since this gateway gives one grant at a time.
        let highest = self.highest.max(report.joined).max(report.done);
        let session = highest.checked_add(1).ok_or(GatewayFault::NumbersUsedUp(highest))?;
        self.highest = session;
        self.order = Order { session, limit: u32::MAX, t_v, grant: session, start: report.boots.unwrap_or(0) };
        self.boots = report.boots;
        self.phase = Phase::Writing;
        Ok(())
    }

    fn want_start(&mut self, t_v: VirtualTime, report: Report) {
        // The session that follows the start needs a number that is new to this PLC, too.
        self.highest = self.highest.max(report.joined).max(report.done);
        let Some(boots) = report.boots else {
            let is_reported = self.leftover.is_some_and(|left| left.is_reported);
            if self.goal != Goal::Start(t_v) && !is_reported {
                self.notice = Some(Notice::StartPlc);
            }
            self.goal = Goal::Start(t_v);
            self.phase = Phase::Surveying;
            return;
        };
        self.goal = Goal::Start(t_v);
        self.boots = Some(boots);
        self.order = Order { start: boots.wrapping_add(1), ..Order::default() };
        self.phase = Phase::Writing;
    }

    fn look_for_start(&mut self, t_v: VirtualTime, report: Report) -> Result<(), GatewayFault> {
        let is_new = match (self.boots, report.boots) {
            (Some(before), Some(now)) => before != now,
            _ => true,
        };
        // Its words outlast the start where it keeps what was written: then it has joined by itself.
        if self.order.session != 0 && report.joined == self.order.session {
            self.goal = Goal::Join(t_v);
            return self.look_for_join(t_v, report);
        }
        if is_new && report.joined == 0 && report.answer != Answer::MustBeStarted {
            self.goal = Goal::Join(t_v);
            return self.begin(t_v, report);
        }
        if self.phase == Phase::Surveying && report.boots.is_some() {
            self.phase = Phase::Writing;
        }
        Ok(())
    }

    fn look_for_join(&mut self, t_v: VirtualTime, report: Report) -> Result<(), GatewayFault> {
        let Order { session, .. } = self.order;
        match (report.joined, report.answer) {
            (joined, _) if joined == session && report.done == session => {
                self.compare_layout(report)?;
                if self.layout.is_some() && report.layout == 0 && !std::mem::replace(&mut self.is_layout_reported, true)
                {
                    self.notice = Some(Notice::NoLayout);
                }
                self.boots = report.boots;
                self.phase = Phase::AtRest;
                Ok(())
            }
            (joined, _) if joined == session => {
                Err(self.nonsense(format!("it has joined session {session} and done grant {}", report.done)))
            }
            (_, Answer::NotSimulated) => Err(GatewayFault::NotSimulated),
            (_, Answer::MustBeStarted) => {
                self.want_start(t_v, report);
                Ok(())
            }
            (0, _) => {
                // It has been started since, and what was written before is gone.
                if self.leftover.take().is_some() {
                    self.phase = Phase::Writing;
                }
                Ok(())
            }
            (joined, _) if self.leftover.is_some_and(|left| left.report.joined == joined) => Ok(()),
            (joined, _) => Err(GatewayFault::OtherSession { joined, session }),
        }
    }

    fn look_for_done(&mut self, report: Report) -> Result<(), GatewayFault> {
        let Order { session, grant, .. } = self.order;
        if let (Some(was), Some(is)) = (self.boots, report.boots)
            && was != is
        {
            return Err(GatewayFault::Restarted { what: self.what(), boots: Some((was, is)) });
        }
        let restarted = GatewayFault::Restarted { what: self.what(), boots: None };
        match (report.joined, report.answer) {
            (0, Answer::NotSimulated) => Err(GatewayFault::NotSimulated),
            (0, _) => Err(restarted),
            (joined, _) if joined != session => Err(GatewayFault::OtherSession { joined, session }),
            _ if report.done == grant => {
                self.phase = Phase::AtRest;
                Ok(())
            }
            _ if report.done > grant => {
                Err(GatewayFault::OtherGrant { what: self.what(), done: report.done - session })
            }
            // It has joined this session again, from a late order, and knows nothing of the grants before.
            _ if report.done + 1 < grant => Err(restarted),
            // A PLC that joins again from the order of the first grant takes that order's `t_v` with it, so the grant itself is
            // not later any more.
            (_, Answer::TimeStandsStill) if self.phase == Phase::Awaiting && grant == session + 1 => Err(restarted),
            _ if self.phase == Phase::Surveying => {
                self.phase = Phase::Writing;
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// A program that was made for another mapping has other variables where this gateway writes.
    fn compare_layout(&self, report: Report) -> Result<(), GatewayFault> {
        match self.layout {
            Some(expected) if report.layout != 0 && report.layout != expected => {
                Err(GatewayFault::OtherLayout { expected, found: report.layout })
            }
            _ => Ok(()),
        }
    }

    fn nonsense(&self, reason: String) -> GatewayFault {
        GatewayFault::Nonsense { what: self.what(), reason }
    }
}

#[cfg(test)]
#[path = "handshake_tests.rs"]
mod tests;
