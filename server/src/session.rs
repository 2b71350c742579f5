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
//!
//! There is no other way to change it, so what holds for every order of these calls holds for every
//! transport. `tests/proofs` explores those orders.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::client::{ClientId, JoinRequest, Wake};
use crate::cycle::Cycle;
use crate::end::{Failure, FailureCause, SessionEnd, Violation};
use crate::image::{Image, ImageLayout};
use crate::join::{JoinRefusal, Membership, admit};
use crate::operation::{Operation, OperationError};
use crate::plan::SessionPlan;
use crate::signal::{ClientName, SignalId, SignalName, did_you_mean, nearest};
use crate::state::{ClientState, ServerState};
use crate::time::{StepCount, TimeSpan, VirtualTime};

/// What somebody who watches over a session may ask for. All of it acts at a step boundary.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Control {
    /// End the session for all.
    Stop,
    /// Hold virtual time.
    Pause,
    /// Let virtual time run again.
    Resume,
    /// Run exactly one step, then hold.
    Step,
    /// Begin anew at `t_v = 0`; held if it was held.
    Reset,
}

/// How the session goes on at the next boundary.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Mode {
    Running,
    Held,
    OneStep,
}

/// What [`Session::advance`] found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Progress {
    /// A state was entered; its awaited clients have something to do.
    Entered(ServerState),
    /// A client has not yet done what the state asks for.
    Waiting,
    /// At a step boundary, by request.
    Held,
    /// Over; see [`Session::end`].
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
        let layout = ImageLayout::new(plan.signals());
        Self {
            members: vec![None; plan.clients().len()],
            writers: Arc::new(vec![None; plan.signals().len()]),
            cycle: Cycle::new(plan.step(), plan.coupling().clone(), plan.clients().len()),
            image: Image::new(&layout),
            layout: Arc::new(layout),
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
    /// (seed 004 sec. IV). True unless said otherwise; it means nothing once the session has begun.
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
            writers[signal.index()] = Some(name.clone());
        }
        self.members[id.index()] = Some(Arc::new(membership));
        self.cycle.signal_ready(id);
        Ok(id)
    }

    /// Clients that the session still waits for in `start`.
    pub fn missing_clients(&self) -> impl Iterator<Item = &ClientName> {
        self.plan.clients().iter().zip(&self.members).filter(|(_, member)| member.is_none()).map(|(name, _)| name)
    }

    /// Signals that nobody who joined writes; a session with such a signal is no session.
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

    /// One transition of the cycle and its effect on the image.
    fn next_state(&mut self) -> Progress {
        if !self.cycle.is_synchronised() {
            return Progress::Waiting;
        }
        let left = self.cycle.server();
        match self.cycle.advance() {
            None => self.finish(SessionEnd::Completed { t_v: self.cycle.t_v() }),
            Some(entered) => {
                if left == ServerState::PreWrite {
                    self.image.commit();
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
        self.end = Some(end);
        Progress::Ended
    }

    /// Asks for a stop, pause, single step or reset at the next step boundary.
    pub fn control(&mut self, control: Control) {
        match control {
            Control::Stop => self.stop = true,
            Control::Pause => self.mode = Mode::Held,
            Control::Resume => self.mode = Mode::Running,
            Control::Step => self.mode = Mode::OneStep,
            Control::Reset => self.reset = true,
        }
    }

    /// Does what an operator asks for, at a step boundary.
    ///
    /// # Errors
    /// A signal that there is not, a value that it cannot have; nothing has changed then.
    pub fn operate(&mut self, operation: &Operation) -> Result<(), OperationError> {
        match operation {
            Operation::Write { signal, value } => {
                let (offset, bytes) = self.valued(signal, value)?;
                self.image.write(offset, &bytes);
            }
            Operation::Force { signal, value } => {
                let (offset, bytes) = self.valued(signal, value)?;
                self.image.force(offset, bytes);
            }
            Operation::Release { signal } => {
                if !self.image.release(self.layout.offset(self.known(signal)?)) {
                    return Err(OperationError::NotForced(signal.clone()));
                }
            }
            Operation::Stop | Operation::Pause | Operation::Resume | Operation::Step | Operation::Reset => {
                if let Some(control) = operation.control() {
                    self.control(control);
                }
            }
        }
        Ok(())
    }

    fn known(&self, signal: &SignalName) -> Result<SignalId, OperationError> {
        self.signal_id(signal.as_str()).ok_or_else(|| {
            let names = self.plan.signals().iter().map(|known| known.name.as_str());
            OperationError::Unknown { signal: signal.clone(), nearest: did_you_mean(signal.as_str(), names) }
        })
    }

    /// Where a signal lies, and the bytes of a value.
    fn valued(&self, signal: &SignalName, value: &str) -> Result<(usize, Vec<u8>), OperationError> {
        let id = self.known(signal)?;
        let bytes = self.layout.ty(id).parse_text(value);
        let bytes = bytes.map_err(|source| OperationError::Value { signal: signal.clone(), source })?;
        Ok((self.layout.offset(id), bytes))
    }

    /// True if a signal lies there.
    fn is_signal(&self, offset: u64, size: usize) -> bool {
        let here = |id: SignalId| (self.layout.offset(id) as u64, self.layout.ty(id).size()) == (offset, size);
        self.layout.signals().any(here)
    }

    /// The client is initialised and `outputs` are its initial values.
    ///
    /// # Errors
    /// A [`Violation`], which has ended the session.
    pub fn initialise(&mut self, client: ClientId, outputs: &[u8]) -> Result<(), Violation> {
        self.expect(client, ClientState::Setup)?;
        self.stage(client, outputs)?;
        let period = self.member(client).map(|member| member.period);
        // A turn ends at `t_v` and covers the period before it, so the first ends after one period.
        self.cycle.sleep_until(client, period.map_or(VirtualTime::ZERO, |period| VirtualTime::ZERO + period));
        self.cycle.signal_ready(client);
        if self.cycle.is_synchronised() {
            self.image.commit();
        }
        Ok(())
    }

    /// The client has nothing to do in `ready` or `write` and says so.
    ///
    /// # Errors
    /// A [`Violation`], which has ended the session.
    pub fn ready(&mut self, client: ClientId) -> Result<(), Violation> {
        let state = self.cycle.client(client);
        let expected = if state == ClientState::Write { ClientState::Write } else { ClientState::Ready };
        self.expect(client, expected)?;
        self.cycle.signal_ready(client);
        Ok(())
    }

    /// Copies the client's inputs from the image to `inputs`.
    ///
    /// # Errors
    /// A [`Violation`], which has ended the session.
    pub fn read(&mut self, client: ClientId, inputs: &mut [u8]) -> Result<(), Violation> {
        self.expect(client, ClientState::Read)?;
        if let Some(member) = &self.members[client.index()] {
            if inputs.len() != member.inputs.size() {
                let wrong = Violation::WrongSize { got: inputs.len(), expected: member.inputs.size() };
                return self.violated(client, wrong);
            }
            self.image.gather(&member.inputs, inputs);
        }
        self.cycle.signal_ready(client);
        Ok(())
    }

    /// The client has run its turn.
    ///
    /// # Errors
    /// A [`Violation`], which has ended the session.
    pub fn submit(&mut self, client: ClientId, turn: &Turn<'_>) -> Result<(), Violation> {
        self.expect(client, ClientState::Run)?;
        let (steps, t_v) = (self.cycle.steps(), self.cycle.t_v());
        if turn.sequence != steps {
            return self.violated(client, Violation::WrongStep { got: turn.sequence, expected: steps });
        }
        if turn.t_v != t_v {
            return self.violated(client, Violation::WrongTime { got: turn.t_v, expected: t_v });
        }
        let wake = self.wake_after(client, turn.wake);
        if wake <= t_v || !wake.is_multiple_of(self.plan.step()) {
            return self.violated(client, Violation::BadWake { wake });
        }
        self.stage(client, turn.outputs)?;
        self.cycle.sleep_until(client, wake);
        self.cycle.signal_ready(client);
        Ok(())
    }

    /// A client cannot go on: the session ends for all, now. The first failure is the one told.
    pub fn fail(&mut self, client: ClientId, cause: FailureCause) {
        if self.end.is_some() {
            return;
        }
        self.end = Some(SessionEnd::Failed(Failure {
            client: self.plan.clients()[client.index()].clone(),
            state: self.cycle.client(client),
            t_v: self.cycle.t_v(),
            cause,
        }));
    }

    fn wake_after(&self, client: ClientId, wake: Wake) -> VirtualTime {
        match wake {
            Wake::At(at) => at,
            Wake::NextPeriod => {
                let period = self.member(client).map_or(self.plan.step(), |member| member.period);
                self.cycle.t_v() + period
            }
        }
    }

    fn stage(&mut self, client: ClientId, outputs: &[u8]) -> Result<(), Violation> {
        let Some(member) = &self.members[client.index()] else { return Ok(()) };
        if outputs.len() != member.outputs.size() {
            let wrong = Violation::WrongSize { got: outputs.len(), expected: member.outputs.size() };
            return self.violated(client, wrong);
        }
        match self.image.stage(&member.outputs, outputs) {
            Ok(()) => Ok(()),
            Err((signal, bad)) => {
                let name = self.plan.signals()[signal.index()].name.clone();
                self.violated(client, Violation::bad_value(name, bad))
            }
        }
    }

    /// Holds the client to `expected`: in that state, and awaited in it.
    fn expect(&mut self, client: ClientId, expected: ClientState) -> Result<(), Violation> {
        if self.end.is_some() {
            return Err(Violation::SessionOver);
        }
        let state = self.cycle.client(client);
        if state != expected {
            return self.violated(client, Violation::WrongState { state, expected });
        }
        if !self.cycle.is_awaited(client) {
            return self.violated(client, Violation::NotAwaited);
        }
        Ok(())
    }

    fn violated(&mut self, client: ClientId, violation: Violation) -> Result<(), Violation> {
        self.fail(client, FailureCause::Violation(violation.clone()));
        Err(violation)
    }

    /// The member in `client`'s seat, if it has joined.
    pub fn member(&self, client: ClientId) -> Option<&Membership> {
        self.members[client.index()].as_deref()
    }

    /// The plan.
    pub fn plan(&self) -> &SessionPlan {
        &self.plan
    }

    /// Where each signal lies in the image.
    pub fn layout(&self) -> &ImageLayout {
        &self.layout
    }

    /// The signal of this name.
    pub fn signal_id(&self, name: &str) -> Option<SignalId> {
        let index = self.plan.signals().binary_search_by(|signal| signal.name.as_str().cmp(name)).ok()?;
        Some(SignalId(index as u32))
    }

    /// The client that writes `signal`, once it has joined.
    pub fn writer(&self, signal: SignalId) -> Option<&ClientName> {
        self.writers[signal.index()].as_ref()
    }

    /// The values that clients see, in the image's layout.
    pub fn image(&self) -> &[u8] {
        self.image.committed()
    }

    /// The values of the next commit, for those who watch over the session; no client sees them.
    pub fn staged(&self) -> &[u8] {
        self.image.staged()
    }

    /// The states and delays.
    pub fn cycle(&self) -> &Cycle {
        &self.cycle
    }

    /// Virtual time.
    pub fn t_v(&self) -> VirtualTime {
        self.cycle.t_v()
    }

    /// The step of the session.
    pub fn step(&self) -> TimeSpan {
        self.plan.step()
    }

    /// How it ended, if it did.
    pub fn end(&self) -> Option<&SessionEnd> {
        self.end.as_ref()
    }

    /// True while virtual time is held at a boundary by request.
    pub fn is_held(&self) -> bool {
        self.mode == Mode::Held && self.cycle.is_at_boundary()
    }

    /// Copies the client's own outputs back from the image, as its last turn left them.
    pub(crate) fn read_back(&self, client: ClientId, outputs: &mut [u8]) {
        if let Some(member) = &self.members[client.index()] {
            self.image.gather(&member.outputs, outputs);
        }
    }

    /// All clients in the order of their names.
    pub fn clients(&self) -> impl ExactSizeIterator<Item = ClientId> + use<> {
        (0..self.members.len()).map(ClientId::from_index)
    }

    /// The session's own part of a checkpoint; `None` where none can be taken: off a boundary, ended.
    pub fn save(&self) -> Option<SessionState> {
        (self.cycle.is_at_boundary() && self.end.is_none()).then(|| SessionState {
            steps: self.cycle.steps(),
            t_v: self.cycle.t_v(),
            wakes: self.clients().map(|client| self.cycle.wake(client)).collect(),
            image: self.image.committed().to_vec(),
            forces: self.image.forces().iter().map(|(offset, bytes)| (*offset as u64, bytes.clone())).collect(),
        })
    }

    /// Takes the place of a session that was saved: same plan, all clients joined, not yet started.
    /// False if `state` cannot be of this session; nothing has changed then.
    pub fn restore(&mut self, state: &SessionState) -> bool {
        let fits = state.wakes.len() == self.members.len()
            && state.image.len() == self.layout.size()
            && state.forces.iter().all(|(offset, bytes)| self.is_signal(*offset, bytes.len()))
            && state.t_v.is_multiple_of(self.plan.step())
            && state.wakes.iter().all(|wake| wake.is_multiple_of(self.plan.step()) && *wake > state.t_v)
            && self.cycle.server() == ServerState::Start
            && self.members.iter().all(Option::is_some);
        if fits {
            self.cycle.resume_at(state.steps, state.t_v, &state.wakes);
            self.image.load(&state.image);
            for (offset, bytes) in &state.forces {
                self.image.force(*offset as usize, bytes.clone());
            }
        }
        fits
    }
}

/// What a client gives back at the end of a turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Turn<'a> {
    /// The grant it answers.
    pub sequence: StepCount,
    /// The virtual time it ran for.
    pub t_v: VirtualTime,
    /// When it wants the next turn.
    pub wake: Wake,
    /// Its outputs.
    pub outputs: &'a [u8],
}

/// The session's own part of a checkpoint.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SessionState {
    steps: StepCount,
    t_v: VirtualTime,
    wakes: Vec<VirtualTime>,
    image: Vec<u8>,
    forces: BTreeMap<u64, Vec<u8>>,
}

impl SessionState {
    /// Virtual time of the checkpoint.
    pub fn t_v(&self) -> VirtualTime {
        self.t_v
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::Coupling;
    use crate::signal::{ElementaryType, Port, SignalDecl};

    fn formed() -> Session {
        let name = ClientName::new("plc").unwrap();
        let signal = SignalName::new("x").unwrap();
        let ty = ElementaryType::Bool;
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

    #[test]
    fn an_output_that_is_no_value_ends_the_session() {
        let mut session = formed();
        session.advance();
        let violation = session.initialise(ClientId(0), &[2]).unwrap_err();
        assert_eq!(violation.to_string(), "its output `x` is no value: a BOOL must be 0 or 1, not 2");
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
