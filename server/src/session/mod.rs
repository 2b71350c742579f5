//! The session: plan, members, cycle and image as one sans-IO machine.
//!
//! Whoever drives it calls [`Session::advance`] until it waits, does for the awaited clients what
//! the state entered asks for, and says so with one of
//!
//! | state | call |
//! |---|---|
//! | start | [`Session::join`] |
//! | setup | [`Session::initialise`] |
//! | ready, write | [`Session::ready`] |
//! | read | [`Session::read`] |
//! | run | [`Session::submit`] |
//! | any | [`Session::fail`], [`Session::control`] |
//! | at a boundary, nobody due | [`Session::pass_over`] |
//!
//! There is no other way to change it, so what holds for every order of these calls holds for every
//! transport. `tests/proofs` explores those orders.
//!
//! | module | subject |
//! |---|---|
//! | `turn` | what clients say |
//! | `operate` | what operators ask for |
//! | `view` | what can be seen |
//! | `saved` | its part of a checkpoint |

mod operate;
mod saved;
mod turn;
mod view;

use std::sync::Arc;

use onescan_base::nearest;

pub use saved::SessionState;
pub use turn::Turn;

use crate::client::{ClientId, JoinRequest};
use crate::cycle::{Cycle, whole_steps_before};
use crate::end::SessionEnd;
use crate::image::{Commit, Image};
use crate::join::{JoinRefusal, Membership, admit};
use crate::layout::ImageLayout;
use crate::plan::SessionPlan;
use crate::signal::{ClientName, SignalName};
use crate::state::ServerState;
use crate::time::VirtualTime;

/// How the session goes on at the next boundary.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Mode {
    Running,
    Held,
    OneStep,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Progress {
    /// A state was entered; its awaited clients have something to do.
    Entered(ServerState),
    /// A client has not yet done what the state asks for.
    Waiting,
    /// At a step boundary, by request.
    Held,
    Ended,
}

/// A session in any state.
#[derive(Clone, Debug)]
pub struct Session {
    plan: Arc<SessionPlan>,
    layout: Arc<ImageLayout>,
    members: Vec<Option<Arc<Membership>>>,
    writers: Arc<Vec<Option<ClientName>>>,
    cycle: Cycle,
    image: Image,
    mode: Mode,
    start_logic: bool,
    stop: bool,
    reset: bool,
    until: Option<VirtualTime>,
    end: Option<SessionEnd>,
}

impl Session {
    /// A session in `start` with nobody in.
    pub fn new(plan: SessionPlan) -> Self {
        let layout = Arc::new(ImageLayout::new(plan.signals()));
        Self {
            members: vec![None; plan.clients().len()],
            writers: Arc::new(vec![None; plan.signals().len()]),
            cycle: Cycle::new(plan.step(), plan.coupling().clone(), plan.clients().len()),
            image: Image::new(Arc::clone(&layout)),
            layout,
            plan: Arc::new(plan),
            mode: Mode::Running,
            start_logic: true,
            stop: false,
            reset: false,
            until: None,
            end: None,
        }
    }

    /// Ends the session as completed at the first boundary at or after `until`.
    pub fn set_until(&mut self, until: Option<VirtualTime>) {
        self.until = until;
    }

    /// The condition for a start beside those of the clients: `start = AND(start logic, client_i.start)`
    /// (`[SDSP]` sec. IV). True unless said otherwise. While it is false the session stays in `start`, or, once the initial
    /// values are there, in front of its first step; it means nothing after that.
    pub fn set_start_logic(&mut self, start_logic: bool) {
        self.start_logic = start_logic;
    }

    /// Lets a client in. Its start signal is part of `start = AND(start logic, client_i.start)`.
    ///
    /// # Errors
    /// See [`JoinRefusal`]; the session is as before then.
    pub fn join(&mut self, request: &JoinRequest) -> Result<ClientId, JoinRefusal> {
        let name = &request.name;
        let id = self.plan.client_id(name).ok_or_else(|| JoinRefusal::NotExpected {
            name: name.clone(),
            nearest: nearest(name.as_str(), self.plan.clients().iter().map(ClientName::as_str)).map(str::to_owned),
        })?;
        if self.members[id.index()].is_some() {
            return Err(JoinRefusal::AlreadyJoined(name.clone()));
        }
        if self.cycle.server() != ServerState::Start || self.end.is_some() {
            return Err(JoinRefusal::TooLate(name.clone()));
        }
        let membership = admit(request, &self.plan, &self.layout, &self.writers)?;
        let writers = Arc::make_mut(&mut self.writers);
        for signal in &membership.writes {
            debug_assert!(writers[signal.index()].is_none(), "a signal has one writer");
            writers[signal.index()] = Some(name.clone());
        }
        self.members[id.index()] = Some(Arc::new(membership));
        self.cycle.signal_ready(id);
        Ok(id)
    }

    /// Lets a client go that has joined a session in `start`: its place is free again.
    ///
    /// False once the session has begun; then nothing has changed, for the client is part of what has happened.
    pub fn leave(&mut self, id: ClientId) -> bool {
        if self.cycle.server() != ServerState::Start || self.end.is_some() {
            return false;
        }
        if let Some(membership) = self.members[id.index()].take() {
            let writers = Arc::make_mut(&mut self.writers);
            for signal in &membership.writes {
                debug_assert_eq!(
                    writers[signal.index()].as_ref(),
                    self.plan.clients().get(id.index()),
                    "a client gives back only what it writes"
                );
                writers[signal.index()] = None;
            }
            self.cycle.withdraw_ready(id);
        }
        true
    }

    /// Clients that the session still waits for in `start`.
    pub fn missing_clients(&self) -> impl Iterator<Item = &ClientName> {
        self.plan.clients().iter().zip(&self.members).filter(|(_, member)| member.is_none()).map(|(name, _)| name)
    }

    /// Signals that nobody who joined writes; a session with such a signal is not a session.
    pub fn unwritten_signals(&self) -> impl Iterator<Item = &SignalName> {
        self.plan.signals().iter().zip(self.writers.iter()).filter(|(_, writer)| writer.is_none()).map(|(s, _)| &s.name)
    }

    /// Goes on by one state if it can.
    pub fn advance(&mut self) -> Progress {
        if self.end.is_some() {
            return Progress::Ended;
        }
        if self.cycle.server() == ServerState::Start {
            if self.stop {
                return self.finish(SessionEnd::Stopped { t_v: VirtualTime::ZERO });
            }
            if !self.start_logic || self.unwritten_signals().next().is_some() {
                return Progress::Waiting;
            }
        }
        if self.cycle.is_at_boundary()
            && let Some(progress) = self.at_boundary()
        {
            return progress;
        }
        self.next_state()
    }

    /// How many steps follow in which nobody is due and nothing was asked for; 0 within a step, and while something lies
    /// over the writers' values that may change them without a turn.
    pub fn idle_steps(&self) -> u64 {
        let asked =
            self.stop || self.reset || self.waits_to_start() || self.mode != Mode::Running || self.end.is_some();
        if asked || !self.image.signal_overlay().is_empty() {
            return 0;
        }
        let until = self.until.unwrap_or(VirtualTime::MAX);
        let boundaries = whole_steps_before(self.cycle.t_v(), until, self.cycle.step()).saturating_add(1);
        let over = self.cycle.t_v() >= until;
        if over { 0 } else { self.cycle.idle_steps().min(boundaries) }
    }

    /// Goes through so many steps in which nobody is due, at most [`idle_steps`](Self::idle_steps) of them: the session
    /// is then as if it had entered all their states. How many they were.
    pub fn pass_over(&mut self, steps: u64) -> u64 {
        let passed = self.cycle.pass_over(steps.min(self.idle_steps()));
        if passed > 0 {
            debug_assert!(self.cycle.is_at_boundary(), "steps are passed over from boundary to boundary");
            // What an operation has changed since the last commit is seen with the first of them; the others change
            // nothing.
            self.image.commit(Commit::EndsStep);
        }
        passed
    }

    /// One transition of the cycle and its effect on the image.
    fn next_state(&mut self) -> Progress {
        if !self.cycle.is_synchronised() {
            return Progress::Waiting;
        }
        let (left, t_v) = (self.cycle.server(), self.cycle.t_v());
        match self.cycle.advance() {
            // Synchronised, so only the end of virtual time is in the way.
            None => self.finish(SessionEnd::Completed { t_v: self.cycle.t_v() }),
            Some(entered) => {
                debug_assert!(self.cycle.t_v() >= t_v, "virtual time does not go back within a session");
                debug_assert!(self.members.iter().all(Option::is_some), "a session begins when nobody is missing");
                if left == ServerState::PreWrite {
                    let commit = if self.cycle.ends_step() { Commit::EndsStep } else { Commit::Within };
                    self.image.commit(commit);
                }
                Progress::Entered(entered)
            }
        }
    }

    /// Acts on what was asked for since the last boundary. `None` lets the cycle go on.
    fn at_boundary(&mut self) -> Option<Progress> {
        let t_v = self.cycle.t_v();
        if self.stop {
            return Some(self.finish(SessionEnd::Stopped { t_v }));
        }
        if self.reset {
            self.reset = false;
            self.cycle.restart();
            self.image.clear();
            return Some(Progress::Entered(ServerState::InitialWrite));
        }
        if self.until.is_some_and(|until| t_v >= until) {
            return Some(self.finish(SessionEnd::Completed { t_v }));
        }
        if self.waits_to_start() {
            return Some(Progress::Held);
        }
        match self.mode {
            Mode::Running => None,
            Mode::Held => Some(Progress::Held),
            Mode::OneStep => {
                self.mode = Mode::Held;
                None
            }
        }
    }

    fn finish(&mut self, end: SessionEnd) -> Progress {
        debug_assert!(self.end.is_none(), "a session ends once");
        self.end = Some(end);
        Progress::Ended
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::client::Wake;
    use crate::end::Violation;
    use crate::operation::Control;
    use crate::plan::Coupling;
    use crate::signal::{Port, SignalDecl, SignalType};
    use crate::time::{StepCount, TimeSpan};

    fn formed() -> Session {
        let name = ClientName::new("plc").unwrap();
        let signal = SignalName::new("x").unwrap();
        let ty = SignalType::BOOL;
        let step = TimeSpan::from_millis(10).unwrap();
        let decl = SignalDecl { name: signal.clone(), ty, writer: Some(name.clone()), unit: None };
        let mut session =
            Session::new(SessionPlan::new(step, &Coupling::Parallel, vec![decl], vec![name.clone()]).unwrap());
        let writes = vec![Port { name: signal, ty }];
        session.join(&JoinRequest { name, period: step, reads: vec![], writes }).unwrap();
        session
    }

    #[test]
    fn a_session_starts_when_all_clients_and_the_start_logic_say_so() {
        let mut session = formed();
        session.set_start_logic(false);
        assert_eq!(session.advance(), Progress::Waiting);
        session.set_start_logic(true);
        assert_eq!(session.advance(), Progress::Entered(ServerState::InitialWrite));
    }

    /// Nor does it take its first step, not even a single one that is asked for; and it waits again after a reset.
    #[test]
    fn a_session_takes_its_first_step_when_the_start_logic_says_so() {
        let mut session = formed();
        for _ in 0..2 {
            session.set_start_logic(true);
            session.advance();
            session.initialise(ClientId(0), &[0]).unwrap();
            session.set_start_logic(false);
            session.control(Control::Step);
            assert_eq!((session.advance(), session.idle_steps(), session.is_held()), (Progress::Held, 0, true));
            assert!(!session.is_about_to_act(), "who could make it start is listened to");
            session.control(Control::Reset);
        }
        assert_eq!(session.advance(), Progress::Entered(ServerState::InitialWrite));
        session.initialise(ClientId(0), &[0]).unwrap();
        session.set_start_logic(true);
        session.control(Control::Resume);
        assert_eq!(session.advance(), Progress::Entered(ServerState::PreRead));
        session.set_start_logic(false);
        assert!(!session.is_held(), "it has started");
    }

    #[test]
    fn an_output_that_is_not_a_value_ends_the_session() {
        let mut session = formed();
        session.advance();
        let violation = session.initialise(ClientId(0), &[2]).unwrap_err();
        assert_eq!(violation.to_string(), "its output `x` is not a value: a BOOL must be 0 or 1, not 2");
        assert_eq!(session.advance(), Progress::Ended);
        assert_eq!(session.image(), [0], "nothing of it was committed");
        assert_eq!(session.initialise(ClientId(0), &[1]), Err(Violation::SessionOver));
    }

    #[test]
    fn a_wake_must_be_later_and_on_the_grid() {
        for wake in [0, 10_000_000, 15_000_000] {
            let mut session = formed();
            session.advance();
            session.initialise(ClientId(0), &[0]).unwrap();
            session.advance();
            session.ready(ClientId(0)).unwrap();
            session.advance();
            session.read(ClientId(0), &mut []).unwrap();
            session.advance();
            let wake = VirtualTime::from_nanos(wake);
            let turn = Turn { sequence: StepCount(1), t_v: session.t_v(), wake: Wake::At(wake), outputs: &[1] };
            assert_eq!(session.submit(ClientId(0), &turn), Err(Violation::BadWake { wake }));
        }
    }
}
