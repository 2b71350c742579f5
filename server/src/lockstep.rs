//! The driver: takes a formed session and its clients through the cycle, step by step.
//!
//! All control flow of a running session is here; clients, image and transports only do as told.
//! A step of clients in this process is plain function calls, without a channel or an allocation.

use std::collections::VecDeque;

use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::client::{Client, ClientId, StateError, Wake};
use crate::end::{FailureCause, SessionEnd, Violation};
use crate::mailbox::Mailbox;
use crate::operation::{Operation, OperationError, OperatorInput};
use crate::pacing::{Pace, Pacer};
use crate::record::{Digest, DigestChain, Observer, RecordError};
use crate::session::{Control, Progress, Session, Turn};
use crate::state::ServerState;
use crate::time::{StepCount, VirtualTime};
use crate::transport::tcp::Remotes;
use crate::wire::message::Status;

/// How a client is reached.
pub(crate) enum Link {
    /// In this process: a function call.
    Local(Box<dyn Client>),
    /// Through [`Remotes`].
    Remote,
}

/// One client as its driver sees it: the link, and the bytes that go to and fro.
struct Berth {
    id: ClientId,
    link: Link,
    inputs: Vec<u8>,
    outputs: Vec<u8>,
    /// What the turn under way gave.
    answer: Result<Answer, FailureCause>,
}

impl Berth {
    fn is_remote(&self) -> bool {
        matches!(self.link, Link::Remote)
    }

    fn take_answer(&mut self) -> Result<Answer, FailureCause> {
        std::mem::replace(&mut self.answer, Ok(Answer::SETUP))
    }
}

/// A client's answer to a setup or a grant, but for its outputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Answer {
    /// The grant it answers; 0 for a setup.
    pub(crate) sequence: StepCount,
    /// The grant's virtual time.
    pub(crate) t_v: VirtualTime,
    /// The next turn.
    pub(crate) wake: Wake,
}

impl Answer {
    const SETUP: Self = Self { sequence: StepCount(0), t_v: VirtualTime::ZERO, wake: Wake::NextPeriod };
}

/// A session that runs.
pub struct Lockstep {
    session: Session,
    berths: Vec<Berth>,
    remotes: Option<Remotes>,
    digest: Option<DigestChain>,
    observers: Vec<Box<dyn Observer>>,
    mailbox: Mailbox,
    pacer: Pacer,
    /// Observers have yet to be shown the image of a checkpoint that was taken up.
    begin_observers: bool,
    closed: bool,
    /// How often the session has begun anew.
    resets: u64,
    /// Inputs of operators that are yet to be replayed.
    replayed: VecDeque<OperatorInput>,
}

/// What came of a session.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Outcome {
    /// How it ended.
    pub end: SessionEnd,
    /// Steps committed.
    pub steps: StepCount,
    /// Virtual time of the last committed step.
    pub t_v: VirtualTime,
    /// The digest over all of them; `None` if not even the initial values were committed.
    pub digest: Option<Digest>,
}

/// Why [`Lockstep::run_to`] came back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reached {
    /// At the boundary asked for; the session goes on when it is run again.
    Boundary,
    /// The session is over.
    End,
}

impl Lockstep {
    /// A session whose clients have all joined, in the order of their ids.
    pub(crate) fn new(session: Session, links: Vec<Link>, remotes: Option<Remotes>) -> Self {
        let berths = session
            .clients()
            .zip(links)
            .map(|(id, link)| {
                let (inputs, outputs) =
                    session.member(id).map_or((0, 0), |member| (member.inputs.size(), member.outputs.size()));
                Berth { id, link, inputs: vec![0; inputs], outputs: vec![0; outputs], answer: Ok(Answer::SETUP) }
            })
            .collect();
        Self {
            session,
            berths,
            remotes,
            digest: None,
            observers: Vec::new(),
            mailbox: Mailbox::new(),
            pacer: Pacer::new(Pace::Max),
            begin_observers: false,
            closed: false,
            resets: 0,
            replayed: VecDeque::new(),
        }
    }

    /// Adds a watcher, before the session runs.
    pub fn observe(&mut self, observer: Box<dyn Observer>) {
        self.observers.push(observer);
    }

    /// Holds the session to a pace.
    pub fn set_pace(&mut self, pace: Pace) {
        self.pacer = Pacer::new(pace);
    }

    /// Takes wishes from `mailbox`.
    pub fn set_mailbox(&mut self, mailbox: Mailbox) {
        self.mailbox = mailbox;
    }

    /// Repeats what operators once did, each input at its boundary.
    pub fn replay(&mut self, inputs: Vec<OperatorInput>) {
        self.replayed = inputs.into();
    }

    /// Ends the session as completed at `until`.
    pub fn set_until(&mut self, until: Option<VirtualTime>) {
        self.session.set_until(until);
    }

    /// The session.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// The digest of all steps so far.
    pub fn digest(&self) -> Option<Digest> {
        self.digest.as_ref().map(DigestChain::last)
    }

    /// Runs until the session is over, and closes it for all.
    ///
    /// # Errors
    /// A recording cannot be written.
    pub fn run(&mut self) -> Result<Outcome, RecordError> {
        while self.run_to(VirtualTime::MAX)? == Reached::Boundary {}
        Ok(self.outcome())
    }

    /// What came of it so far; a session that goes on counts as stopped where it is.
    pub fn outcome(&self) -> Outcome {
        let end = self.session.end().cloned().unwrap_or(SessionEnd::Stopped { t_v: self.session.t_v() });
        let (steps, t_v) = self.committed();
        Outcome { end, steps, t_v, digest: self.digest() }
    }

    /// Number and time of the last step whose outputs are in the image.
    fn committed(&self) -> (StepCount, VirtualTime) {
        let cycle = self.session.cycle();
        let under_way = matches!(cycle.server(), ServerState::Read | ServerState::PreWrite)
            || (cycle.server() == ServerState::Write && !cycle.ends_step());
        if under_way && cycle.steps().0 > 0 {
            (StepCount(cycle.steps().0 - 1), cycle.t_v().saturating_sub(cycle.step()))
        } else {
            (cycle.steps(), cycle.t_v())
        }
    }

    /// Runs to the first boundary at or after `t_v`, or to the end.
    ///
    /// # Errors
    /// A recording cannot be written; the session is closed for all then.
    pub fn run_to(&mut self, t_v: VirtualTime) -> Result<Reached, RecordError> {
        let reached = self.cycle_to(t_v);
        match &reached {
            Ok(Reached::Boundary) => return reached,
            Ok(Reached::End) => {}
            Err(_) => self.session.control(Control::Stop),
        }
        self.close(reached)
    }

    /// The loop of a session. Everything that can happen between two states is decided here.
    fn cycle_to(&mut self, t_v: VirtualTime) -> Result<Reached, RecordError> {
        if std::mem::take(&mut self.begin_observers) {
            self.show(Observer::begin)?;
        }
        loop {
            if self.session.cycle().is_at_boundary() {
                if self.digest.is_some() && self.session.t_v() >= t_v {
                    return Ok(Reached::Boundary);
                }
                self.take_wishes()?;
            }
            match self.session.advance() {
                Progress::Entered(state) => self.serve(state)?,
                Progress::Held => self.hold(),
                Progress::Ended => return Ok(Reached::End),
                Progress::Waiting => {
                    debug_assert!(false, "every awaited client was served");
                    return Ok(Reached::End);
                }
            }
        }
    }

    /// Does for all awaited clients what the state asks for.
    fn serve(&mut self, state: ServerState) -> Result<(), RecordError> {
        match state {
            ServerState::Start => {}
            ServerState::InitialWrite => {
                self.set_up();
                self.begin()?;
            }
            ServerState::PreRead => {
                if self.session.cycle().pass() == 0 {
                    self.pacer.hold_until(self.session.t_v() + self.session.step());
                }
                self.acknowledge();
            }
            ServerState::Read => {
                for berth in &mut self.berths {
                    if self.session.cycle().is_due(berth.id) {
                        // A violation has ended the session; the next advance says so.
                        let _ = self.session.read(berth.id, &mut berth.inputs);
                    }
                }
            }
            ServerState::PreWrite => self.take_turns(),
            ServerState::Write => {
                self.acknowledge();
                if self.session.cycle().ends_step() {
                    self.end_step()?;
                }
            }
        }
        Ok(())
    }

    /// Nothing to do for a client in `ready` or `write`: it is ready at once.
    fn acknowledge(&mut self) {
        for berth in &self.berths {
            if self.session.cycle().is_awaited(berth.id) {
                let _ = self.session.ready(berth.id);
            }
        }
    }

    fn set_up(&mut self) {
        self.pacer.rebase();
        if let Some(remotes) = &mut self.remotes {
            remotes.send_setup(self.berths.iter().filter(|berth| berth.is_remote()).map(|berth| berth.id));
        }
        for berth in &mut self.berths {
            if let Link::Local(client) = &mut berth.link {
                berth.outputs.fill(0);
                berth.answer = client.setup(&mut berth.outputs).map(|()| Answer::SETUP).map_err(FailureCause::Fault);
            }
        }
        self.collect_remote_answers();
        for berth in &mut self.berths {
            match berth.take_answer() {
                Ok(Answer { sequence: StepCount(0), .. }) => drop(self.session.initialise(berth.id, &berth.outputs)),
                Ok(Answer { sequence: got, .. }) => {
                    let violation = Violation::WrongStep { got, expected: StepCount(0) };
                    self.session.fail(berth.id, FailureCause::Violation(violation));
                }
                Err(cause) => self.session.fail(berth.id, cause),
            }
            if self.session.end().is_some() {
                return;
            }
        }
    }

    /// Grants go to remote clients first, so that they run beside those of this process.
    fn take_turns(&mut self) {
        let (sequence, t_v) = (self.session.cycle().steps(), self.session.t_v());
        if let Some(remotes) = &mut self.remotes {
            let due = self.berths.iter().filter(|b| b.is_remote() && self.session.cycle().is_due(b.id));
            remotes.send_grants(due.map(|berth| (berth.id, &berth.inputs[..])), sequence, t_v);
        }
        for berth in self.berths.iter_mut().filter(|berth| self.session.cycle().is_due(berth.id)) {
            if let Link::Local(client) = &mut berth.link {
                let turn = client.turn(t_v, &berth.inputs, &mut berth.outputs);
                berth.answer = turn.map(|wake| Answer { sequence, t_v, wake }).map_err(FailureCause::Fault);
            }
        }
        self.collect_remote_answers();
        self.submit();
    }

    /// Outputs are staged and failures told in the order of names, whoever was done first.
    fn submit(&mut self) {
        for berth in &mut self.berths {
            if !self.session.cycle().is_due(berth.id) {
                continue;
            }
            match berth.take_answer() {
                Ok(Answer { sequence, t_v, wake }) => {
                    let _ = self.session.submit(berth.id, &Turn { sequence, t_v, wake, outputs: &berth.outputs });
                }
                Err(cause) => self.session.fail(berth.id, cause),
            }
            if self.session.end().is_some() {
                return;
            }
        }
    }

    fn collect_remote_answers(&mut self) {
        let Some(remotes) = &mut self.remotes else { return };
        for berth in self.berths.iter_mut().filter(|berth| berth.is_remote()) {
            if self.session.cycle().is_due(berth.id) {
                berth.answer = remotes.collect(berth.id, &mut berth.outputs);
            }
        }
    }

    /// The image holds the initial values.
    fn begin(&mut self) -> Result<(), RecordError> {
        if self.session.end().is_some() {
            return Ok(());
        }
        if self.digest.is_some() {
            self.resets += 1;
        }
        self.digest = Some(DigestChain::begin(&self.session));
        self.show(Observer::begin)
    }

    /// Shows observers the image that is committed.
    fn show<F>(&mut self, seen: F) -> Result<(), RecordError>
    where
        F: Fn(&mut (dyn Observer + 'static), &Session) -> Result<(), RecordError>,
    {
        let digest = self.digest();
        self.observers.iter_mut().try_for_each(|observer| {
            if let Some(digest) = digest {
                observer.digested(digest);
            }
            seen(observer.as_mut(), &self.session)
        })
    }

    fn end_step(&mut self) -> Result<(), RecordError> {
        if let Some(digest) = &mut self.digest {
            digest.step(&self.session);
        }
        self.show(Observer::step)
    }

    fn take_wishes(&mut self) -> Result<(), RecordError> {
        while let Some(operation) = self.next_replayed() {
            // What was recorded could be done; a file by hand may ask for what cannot.
            if let Err(error) = self.operate(operation)? {
                tracing::warn!(%error, "an operator's input is left out");
            }
        }
        while let Some(request) = self.mailbox.take() {
            let done = request.operation.map_or(Ok(Ok(())), |operation| self.operate(operation))?;
            if let Some(reply) = request.reply {
                // Who has gone meanwhile does not need an answer.
                let _ = reply.send(done.map(|()| self.status()));
            }
        }
        Ok(())
    }

    /// The next of the inputs replayed, if this is its boundary. Those that only hold time are left
    /// out: they change nothing, and nobody might let it go on.
    fn next_replayed(&mut self) -> Option<Operation> {
        let here = (self.resets, self.session.cycle().steps());
        loop {
            let next = self.replayed.front()?;
            if (next.resets, next.step) > here {
                return None;
            }
            let next = self.replayed.pop_front()?;
            if (next.resets, next.step) == here && next.operation.is_lasting() {
                return Some(next.operation);
            }
        }
    }

    /// Does what an operator asks for, and tells observers if it could be done.
    fn operate(&mut self, operation: Operation) -> Result<Result<(), OperationError>, RecordError> {
        let done = self.session.operate(&operation);
        if done.is_ok() {
            let (step, t_v) = self.committed();
            let input = OperatorInput { resets: self.resets, step, t_v, operation };
            self.observers.iter_mut().try_for_each(|observer| observer.operated(&input))?;
        }
        Ok(done)
    }

    fn status(&self) -> Status {
        Status {
            state: self.session.cycle().server(),
            t_v: self.session.t_v(),
            steps: self.session.cycle().steps(),
            held: self.session.is_held(),
        }
    }

    /// Virtual time is held: waits for a wish, and for a client that leaves meanwhile.
    fn hold(&mut self) {
        self.mailbox.wait(std::time::Duration::from_millis(100));
        self.pacer.rebase();
        if let Some((client, cause)) = self.remotes.as_mut().and_then(Remotes::find_lost) {
            self.session.fail(client, cause);
        }
    }

    /// Tells everybody that the session is over, and ends the recordings, whatever came before.
    fn close(&mut self, reached: Result<Reached, RecordError>) -> Result<Reached, RecordError> {
        if self.closed {
            return reached;
        }
        self.closed = true;
        if let Some(remotes) = &mut self.remotes {
            let t_v = self.session.t_v();
            remotes.send_end(&self.session.end().cloned().unwrap_or(SessionEnd::Stopped { t_v }));
        }
        let mut result = reached;
        for observer in &mut self.observers {
            let ended = observer.end(&self.session);
            result = result.and_then(|reached| ended.map(|()| reached));
        }
        result
    }

    /// Takes a checkpoint at the boundary at which the session is.
    ///
    /// # Errors
    /// Not at a boundary, or a client cannot save.
    pub fn checkpoint(&mut self) -> Result<Checkpoint, CheckpointError> {
        let session = self.session.save().ok_or(CheckpointError::NotNow)?;
        let digest = self.digest().ok_or(CheckpointError::NotNow)?;
        let names = self.session.plan().clients().to_vec();
        let mut clients = Vec::with_capacity(names.len());
        for (berth, client) in self.berths.iter().zip(names) {
            let state = match &berth.link {
                Link::Local(local) => local.save(),
                Link::Remote => self.remotes.as_mut().map_or(Err(StateError::Unsupported), |r| r.save(berth.id)),
            };
            match state {
                Ok(state) => clients.push((client, state)),
                Err(source) => return Err(CheckpointError::Client { client, source }),
            }
        }
        Ok(Checkpoint { plan: self.session.plan().fingerprint(), session, digest, clients })
    }

    /// Takes up a checkpoint before the session runs. Observers begin at its image.
    ///
    /// # Errors
    /// It belongs to another session, or a client cannot take its state back; the session must not
    /// be run then.
    pub fn resume(&mut self, checkpoint: &Checkpoint) -> Result<(), CheckpointError> {
        let names = self.session.plan().clients();
        let same_clients = checkpoint.clients.iter().map(|(name, _)| name).eq(names);
        if checkpoint.plan != self.session.plan().fingerprint()
            || !same_clients
            || !self.session.restore(&checkpoint.session)
        {
            return Err(CheckpointError::OtherSession);
        }
        let (steps, t_v) = (self.session.cycle().steps(), self.session.t_v());
        for (berth, (name, state)) in self.berths.iter_mut().zip(&checkpoint.clients) {
            let restored = match &mut berth.link {
                Link::Local(local) => local.restore(state),
                Link::Remote => match &mut self.remotes {
                    Some(remotes) => remotes.restore(berth.id, steps, t_v, state),
                    None => Err(StateError::Unsupported),
                },
            };
            restored.map_err(|source| CheckpointError::Client { client: name.clone(), source })?;
            self.session.read_back(berth.id, &mut berth.outputs);
        }
        self.digest = Some(DigestChain::resume(checkpoint.digest));
        self.begin_observers = true;
        Ok(())
    }
}
