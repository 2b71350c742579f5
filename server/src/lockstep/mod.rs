//! The driver: takes a formed session and its clients through the cycle, step by step.
//!
//! | module | subject |
//! |---|---|
//! | this file | the loop: what each state of the cycle asks for |
//! | `operate` | operations of operators, replays and the timeline |
//! | `rest` | steps in which nobody is due |
//! | `restore` | checkpoints taken and taken up |
//! | [`start`] | the logic that lets the first step come |
//! | `show` | observers and published views |
//!
//! All control flow of a running session is here; clients, image and carriers only carry it out. A step
//! of clients in this process is plain function calls, without a channel or an allocation.

mod operate;
mod rest;
mod restore;
mod show;
pub mod start;

use std::collections::{BTreeSet, VecDeque};
use std::time::Duration;

use crate::carrier::{Answer, Carrier, Grant};
use crate::checkpoint::SessionSettings;
use crate::client::{ClientId, ClientOperation};
use crate::digest::{Digest, TrajectoryDigest};
use crate::end::{FailureCause, SessionEnd, Violation};
use crate::mailbox::Mailbox;
use crate::observer::{Observer, RecordError};
use crate::operation::{Control, Operation, OperatorInput};
use crate::pacing::{Pace, Pacer};
use crate::published::Published;
use crate::session::{Progress, Session, Turn};
use crate::state::ServerState;
use crate::time::{StepCount, VirtualTime};
use crate::timeline::Timeline;

use show::Shown;
use start::StartLogic;

/// How long the driver sleeps at a time while virtual time is held, wall clock. A wish wakes it.
const HOLD: Duration = Duration::from_millis(100);

/// One client as its driver sees it: the way to it, and the bytes that go to and fro.
struct ClientSlot {
    id: ClientId,
    carrier: Box<dyn Carrier>,
    inputs: Vec<u8>,
    outputs: Vec<u8>,
}

/// A session that runs.
pub struct Lockstep {
    session: Session,
    slots: Vec<ClientSlot>,
    /// The slots in the order in which orders are given: those elsewhere first, so that they run
    /// beside those of this process.
    order: Vec<usize>,
    digest: Option<TrajectoryDigest>,
    observers: Vec<Box<dyn Observer>>,
    mailbox: Mailbox,
    pacer: Pacer,
    /// Observers have yet to be shown the image of a checkpoint that was taken up.
    begin_observers: bool,
    closed: bool,
    /// How often the session has restarted.
    resets: u64,
    /// Inputs of operators that are yet to be replayed.
    replayed: VecDeque<OperatorInput>,
    timeline: Timeline,
    settings: SessionSettings,
    /// Settings in which a checkpoint that is taken up may be another.
    may_differ: BTreeSet<String>,
    /// What the timeline did to the initial values, until observers can be notified.
    at_start: Vec<Operation>,
    start_logic: Option<StartLogic>,
    could_start: bool,
    shown: Shown,
}

/// What came of a session.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Outcome {
    pub end: SessionEnd,
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

/// What else than its time ends a run.
#[derive(Clone, Copy, Debug)]
enum Handling {
    TimeOnly,
    /// The first reset after so many.
    Resets {
        before: u64,
    },
}

impl Handling {
    fn is_reset(self, resets: u64) -> bool {
        matches!(self, Self::Resets { before } if resets != before)
    }
}

impl Lockstep {
    /// A session whose clients have all joined, in the order of their ids.
    pub(crate) fn new(session: Session, carriers: Vec<Box<dyn Carrier>>) -> Self {
        let slot = |(id, carrier)| {
            let member = session.member(id);
            let (inputs, outputs) = member.map_or((0, 0), |member| (member.inputs.size(), member.outputs.size()));
            ClientSlot { id, carrier, inputs: vec![0; inputs], outputs: vec![0; outputs] }
        };
        debug_assert_eq!(carriers.len(), session.clients().len(), "every client of the plan has its carrier");
        let slots: Vec<ClientSlot> = session.clients().zip(carriers).map(slot).collect();
        let mut order: Vec<usize> = (0..slots.len()).collect();
        // A stable sort: among themselves clients stay in the order of their names.
        order.sort_by_key(|index| !slots[*index].carrier.runs_elsewhere());
        let shown = Shown::new(session.image().len());
        Self {
            session,
            slots,
            order,
            digest: None,
            observers: Vec::new(),
            mailbox: Mailbox::new(),
            pacer: Pacer::new(Pace::Max),
            begin_observers: false,
            closed: false,
            resets: 0,
            replayed: VecDeque::new(),
            timeline: Timeline::default(),
            settings: SessionSettings::default(),
            may_differ: BTreeSet::new(),
            at_start: Vec::new(),
            start_logic: None,
            could_start: true,
            shown,
        }
    }

    /// Adds a watcher, before the session runs.
    pub fn observe(&mut self, observer: Box<dyn Observer>) {
        self.observers.push(observer);
    }

    /// Where the session publishes its views. Views are made only while somebody wants them.
    pub fn published(&self) -> Published {
        self.shown.published()
    }

    /// Publishes views there instead, for readers that were there before the session.
    pub fn set_published(&mut self, published: Published) {
        self.shown.set_published(published);
    }

    /// Holds the session to a pace.
    pub fn set_pace(&mut self, pace: Pace) {
        self.pacer = Pacer::new(pace);
    }

    /// Takes wishes from `mailbox`.
    pub fn set_mailbox(&mut self, mailbox: Mailbox) {
        self.mailbox = mailbox;
    }

    /// Brings operations along that happen by themselves, before the session runs or is resumed.
    pub fn set_timeline(&mut self, timeline: Timeline) {
        self.timeline = timeline;
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
        self.digest.as_ref().map(TrajectoryDigest::value)
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
        self.run_until(t_v, Handling::TimeOnly)
    }

    /// Runs as [`run_to`](Self::run_to) does, or to the first boundary after a reset.
    ///
    /// # Errors
    /// A recording cannot be written; the session is closed for all then.
    pub fn run_to_or_reset(&mut self, t_v: VirtualTime) -> Result<Reached, RecordError> {
        self.run_until(t_v, Handling::Resets { before: self.resets })
    }

    fn run_until(&mut self, t_v: VirtualTime, handling: Handling) -> Result<Reached, RecordError> {
        let reached = self.cycle_until(t_v, handling);
        match &reached {
            Ok(Reached::Boundary) => return reached,
            Ok(Reached::End) => {}
            Err(_) => self.session.control(Control::Stop),
        }
        self.close(reached)
    }

    /// The loop of a session. Everything that can happen between two states is decided here.
    fn cycle_until(&mut self, t_v: VirtualTime, handling: Handling) -> Result<Reached, RecordError> {
        if std::mem::take(&mut self.begin_observers) {
            self.notify_beginning()?;
        }
        loop {
            if self.session.cycle().is_at_boundary() {
                if self.digest.is_some() && (self.session.t_v() >= t_v || handling.is_reset(self.resets)) {
                    return Ok(Reached::Boundary);
                }
                self.take_wishes()?;
                self.look_for_start();
                if self.rest(t_v)? {
                    continue;
                }
            }
            match self.session.advance() {
                Progress::Entered(state) => self.serve(state)?,
                Progress::Held => self.hold(),
                Progress::Ended => return Ok(Reached::End),
                // Every awaited client was served, so this is an error of this file: said as such, and
                // not waited for.
                Progress::Waiting => {
                    debug_assert!(false, "a client was not served in state {}", self.session.cycle().server());
                    self.session.control(Control::Stop);
                    tracing::error!(state = %self.session.cycle().server(), "a client was not served");
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
                let operations = self.operations_at_start();
                self.set_up(&operations);
                self.begin()?;
            }
            ServerState::PreRead => {
                // Once per step, however many passes it has: operations and the pace belong to steps.
                if self.session.cycle().pass() == 0 {
                    self.take_timeline()?;
                    self.pacer.hold_until(self.session.t_v() + self.session.step());
                }
                self.acknowledge();
            }
            ServerState::Read => self.read(),
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
        for slot in &self.slots {
            if self.session.cycle().is_awaited(slot.id) && self.session.ready(slot.id).is_err() {
                // The violation has ended the session; the next advance reports it.
                return;
            }
        }
    }

    fn read(&mut self) {
        for slot in &mut self.slots {
            if self.session.cycle().is_due(slot.id) && self.session.read(slot.id, &mut slot.inputs).is_err() {
                // As in `acknowledge`.
                return;
            }
        }
    }

    /// Asks every client for its initial values, with its operations in force from there.
    fn set_up(&mut self, operations: &[(ClientId, ClientOperation)]) {
        self.pacer.rebase();
        for index in &self.order {
            let slot = &mut self.slots[*index];
            let own: Vec<_> = operations.iter().filter(|(id, _)| *id == slot.id).map(|(_, own)| own.clone()).collect();
            slot.carrier.set_up(&own, &mut slot.outputs);
        }
        for slot in &mut self.slots {
            let answered = slot.carrier.collect(&mut slot.outputs);
            match answered {
                // A violation has ended the session, which is looked at below.
                Ok(Answer { sequence: StepCount(0), .. }) => drop(self.session.initialise(slot.id, &slot.outputs)),
                Ok(Answer { sequence: got, .. }) => {
                    let violation = Violation::WrongStep { got, expected: StepCount(0) };
                    self.session.fail(slot.id, FailureCause::Violation(violation));
                }
                Err(cause) => self.session.fail(slot.id, cause),
            }
            if self.session.end().is_some() {
                return;
            }
        }
    }

    /// Grants go out first, so that clients elsewhere run beside those of this process; outputs are
    /// staged and failures reported in the order of names, whoever was done first.
    fn take_turns(&mut self) {
        let (sequence, t_v) = (self.session.cycle().steps(), self.session.t_v());
        for index in &self.order {
            let slot = &mut self.slots[*index];
            if self.session.cycle().is_due(slot.id) {
                debug_assert_eq!(
                    Some(slot.inputs.len()),
                    self.session.member(slot.id).map(|member| member.inputs.size()),
                    "a grant carries all inputs of its client"
                );
                slot.carrier.grant(Grant { sequence, t_v, inputs: &slot.inputs }, &mut slot.outputs);
            }
        }
        for slot in &mut self.slots {
            if !self.session.cycle().is_due(slot.id) {
                continue;
            }
            match slot.carrier.collect(&mut slot.outputs) {
                Ok(Answer { sequence, t_v, wake }) => {
                    let turn = Turn { sequence, t_v, wake, outputs: &slot.outputs };
                    if self.session.submit(slot.id, &turn).is_err() {
                        // As in `acknowledge`.
                        return;
                    }
                }
                Err(cause) => return self.session.fail(slot.id, cause),
            }
        }
    }

    fn end_step(&mut self) -> Result<(), RecordError> {
        debug_assert!(self.digest.is_some(), "the digest begins with the initial values, before the first step");
        if let Some(digest) = &mut self.digest {
            digest.step(self.session.image());
        }
        self.notify_step()
    }

    /// Virtual time is held: waits for a wish, and for a client that leaves meanwhile.
    fn hold(&mut self) {
        self.publish();
        self.mailbox.wait(HOLD);
        self.pacer.rebase();
        for slot in &mut self.slots {
            if let Some(cause) = slot.carrier.find_lost() {
                return self.session.fail(slot.id, cause);
            }
        }
    }

    /// Notifies every client that the session is over, and how it ended.
    fn part(&mut self) -> SessionEnd {
        self.closed = true;
        let end = self.session.end().cloned().unwrap_or(SessionEnd::Stopped { t_v: self.session.t_v() });
        // All are notified before anybody is waited for.
        self.slots.iter_mut().for_each(|slot| slot.carrier.end(&end));
        self.slots.iter_mut().for_each(|slot| slot.carrier.close());
        end
    }

    /// Notifies everybody that the session is over, and ends the recordings, whatever came before.
    fn close(&mut self, reached: Result<Reached, RecordError>) -> Result<Reached, RecordError> {
        if self.closed {
            return reached;
        }
        let end = self.part();
        self.publish_end(&end);
        let mut result = reached;
        for observer in &mut self.observers {
            let ended = observer.end(&self.session);
            result = result.and_then(|reached| ended.map(|()| reached));
        }
        result
    }
}

impl Drop for Lockstep {
    /// A session that is given up, as one that cannot be resumed, is over for its clients, too.
    fn drop(&mut self) {
        if !self.closed {
            self.part();
        }
    }
}
