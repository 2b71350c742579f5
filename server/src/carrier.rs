//! Carriers: how a client is reached. In this process a call; elsewhere whatever carries frames.
//!
//! [`Lockstep`](crate::lockstep::Lockstep) and [`Formation`](crate::formation::Formation) know clients
//! only through these traits. A new way to reach clients, such as shared memory or TLS, is a new
//! implementation of [`Carrier`] and [`ClientListener`], and nothing else changes.

use std::time::Duration;

use crate::client::{Client, ClientOperation, ClientView, JoinRequest, OperationRefused, Parts, StateError, Wake};
use crate::end::{FailureCause, SessionEnd};
use crate::signal::PortLayout;
use crate::time::{StepCount, VirtualTime};

/// A client's answer to a set-up or a grant, without its outputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Answer {
    /// The grant it answers; 0 for a set-up.
    pub sequence: StepCount,
    /// The grant's virtual time.
    pub t_v: VirtualTime,
    pub wake: Wake,
}

impl Answer {
    /// The answer to a set-up.
    pub const SET_UP: Self = Self { sequence: StepCount(0), t_v: VirtualTime::ZERO, wake: Wake::NextPeriod };
}

/// One turn, as it is granted to a client.
#[derive(Clone, Copy, Debug)]
pub struct Grant<'a> {
    /// The number of the step.
    pub sequence: StepCount,
    /// Virtual time at the end of the turn.
    pub t_v: VirtualTime,
    /// The client's inputs, packed in the order of its [`JoinRequest`].
    pub inputs: &'a [u8],
}

/// The way to one client.
///
/// Every order has two halves: it is given, then its answer is collected. Between the two the clients
/// behind other carriers get theirs, so that clients elsewhere run side by side. `outputs` is the same
/// buffer in both halves, and holds what the turn before left there.
pub trait Carrier: Send {
    /// True if the client runs somewhere else, so that an order to it comes back at once. Such clients
    /// get their orders first.
    fn runs_elsewhere(&self) -> bool;

    /// Asks for the initial state and values, with `operations` in force from them on.
    fn set_up(&mut self, operations: &[ClientOperation], outputs: &mut Vec<u8>);

    /// Grants a turn.
    fn grant(&mut self, grant: Grant<'_>, outputs: &mut Vec<u8>);

    /// The answer to the last order; the client's outputs are in `outputs` then.
    ///
    /// # Errors
    /// The client or the way to it has failed.
    fn collect(&mut self, outputs: &mut Vec<u8>) -> Result<Answer, FailureCause>;

    /// Passes an operation on, between two turns.
    ///
    /// # Errors
    /// The client cannot do it.
    fn operate(&mut self, operation: &ClientOperation) -> Result<(), OperationRefused>;

    /// Whether the client can begin again. One that runs elsewhere takes part by a protocol that has it do so.
    ///
    /// # Errors
    /// Why it cannot.
    fn can_reset(&self) -> Result<(), OperationRefused>;

    /// Adds to `view` those parts of what can be seen of the client, without asking anybody elsewhere.
    fn show(&self, parts: Parts, view: &mut ClientView);

    /// The client's state.
    ///
    /// # Errors
    /// It cannot save, or cannot be reached.
    fn save(&mut self) -> Result<Vec<u8>, StateError>;

    /// Gives the client a state back; `steps` and `t_v` are those of the checkpoint.
    ///
    /// # Errors
    /// It cannot take it, or cannot be reached.
    fn restore(&mut self, steps: StepCount, t_v: VirtualTime, state: &[u8]) -> Result<(), StateError>;

    /// Why the client is gone, if it is, while nothing is asked of it.
    fn find_lost(&mut self) -> Option<FailureCause>;

    /// Notifies the client that the session is over.
    fn end(&mut self, end: &SessionEnd);

    /// Lets the client go, once all have been notified of the end.
    fn close(&mut self);
}

/// Where clients from elsewhere come in.
pub trait ClientListener {
    /// The next one that wants to join, if one comes within `patience` (wall clock).
    fn next_pending(&self, patience: Duration) -> Option<Box<dyn PendingClient>>;

    /// Nobody is let in from here on: whoever still comes is notified and sent away.
    fn shut(&self);
}

/// A client that wants to join and waits for the answer.
pub trait PendingClient {
    /// What it wants.
    fn request(&self) -> &JoinRequest;

    /// Where it comes from, for the log.
    fn origin(&self) -> String;

    /// Lets it in: reports to it where its signals lie. A client that leaves an order unanswered for
    /// `reply_timeout` (wall clock) has failed.
    ///
    /// # Errors
    /// It has gone meanwhile, or its connection cannot be used.
    fn admit(
        self: Box<Self>,
        inputs: &PortLayout,
        outputs: &PortLayout,
        reply_timeout: Duration,
    ) -> std::io::Result<Box<dyn Carrier>>;

    /// Sends it away with the reason.
    fn refuse(self: Box<Self>, why: &str);
}

/// A client in this process, reached by a call.
pub(crate) struct InProcess {
    client: Box<dyn Client>,
    answer: Result<Answer, FailureCause>,
}

impl InProcess {
    pub(crate) fn new(client: Box<dyn Client>) -> Self {
        Self { client, answer: Ok(Answer::SET_UP) }
    }
}

impl Carrier for InProcess {
    fn runs_elsewhere(&self) -> bool {
        false
    }

    fn set_up(&mut self, operations: &[ClientOperation], outputs: &mut Vec<u8>) {
        outputs.fill(0);
        self.answer = self.client.begin(operations, outputs).map(|()| Answer::SET_UP).map_err(FailureCause::Fault);
    }

    fn grant(&mut self, Grant { sequence, t_v, inputs }: Grant<'_>, outputs: &mut Vec<u8>) {
        self.answer = match self.client.turn(t_v, inputs, outputs) {
            Ok(wake) => Ok(Answer { sequence, t_v, wake }),
            Err(fault) => Err(FailureCause::Fault(fault)),
        };
    }

    fn collect(&mut self, _outputs: &mut Vec<u8>) -> Result<Answer, FailureCause> {
        // An answer is collected once; what is left is not a failure.
        std::mem::replace(&mut self.answer, Ok(Answer::SET_UP))
    }

    fn operate(&mut self, operation: &ClientOperation) -> Result<(), OperationRefused> {
        self.client.operate(operation)
    }

    fn can_reset(&self) -> Result<(), OperationRefused> {
        self.client.can_reset()
    }

    fn show(&self, parts: Parts, view: &mut ClientView) {
        self.client.show(parts, view);
    }

    fn save(&mut self) -> Result<Vec<u8>, StateError> {
        self.client.save()
    }

    fn restore(&mut self, _steps: StepCount, _t_v: VirtualTime, state: &[u8]) -> Result<(), StateError> {
        self.client.restore(state)
    }

    fn find_lost(&mut self) -> Option<FailureCause> {
        None
    }

    fn end(&mut self, _end: &SessionEnd) {}

    fn close(&mut self) {}
}
