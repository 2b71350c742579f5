//! Operations on a running session, whoever asks for them: operators, a replay, the timeline.

use onescan_base::did_you_mean;

use super::Lockstep;
use crate::client::{ClientId, ClientOperation};
use crate::mailbox::Wish;
use crate::observer::RecordError;
use crate::operation::{Author, Operation, OperationError, OperatorInput};
use crate::signal::ClientName;
use crate::wire::message::Status;

impl Lockstep {
    /// At a step boundary: what is replayed comes before what is asked now, as it did then.
    pub(super) fn take_wishes(&mut self) -> Result<(), RecordError> {
        while let Some(operation) = self.next_replayed() {
            // What was recorded could be done; a file by hand may ask for what cannot.
            if let Err(error) = self.operate(operation, Author::Operator)? {
                tracing::warn!(%error, "an operator's input is left out");
            }
        }
        // Wishes behind a single step or a reset wait until that is done: of two steps each is one, and who asks then
        // hears how things are behind it.
        while !self.session.is_about_to_act()
            && let Some(request) = self.mailbox.take()
        {
            let status = match request.wish {
                Wish::Look(signals) => self.session.look(&signals),
                Wish::Do(operation) => self.operate(operation, Author::Operator)?.map(|()| self.status()),
            };
            if let Some(reply) = request.reply
                && reply.send(status).is_err()
            {
                tracing::debug!("the operator left before it heard what came of its wish");
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

    /// What the timeline does in the step that begins.
    pub(super) fn take_timeline(&mut self) -> Result<(), RecordError> {
        let t_v = self.session.t_v();
        for operation in self.timeline.due(&self.session, t_v, t_v + self.session.step()) {
            if let Err(error) = self.operate(operation, Author::Timeline)? {
                // A scenario's timeline is checked before it runs; an operator may have been faster,
                // as with a release of what is released.
                tracing::warn!(%error, "an operation of the timeline is left out");
            }
        }
        Ok(())
    }

    /// What the timeline does to the initial values: signals at once, clients with their set-up.
    pub(super) fn operations_at_start(&mut self) -> Vec<(ClientId, ClientOperation)> {
        self.timeline.rewind();
        let mut for_clients = Vec::new();
        for operation in self.timeline.due_at_start() {
            let done = match operation.for_client() {
                Some((name, asked)) => self.client_id(name).map(|id| for_clients.push((id, asked))),
                None => self.session.operate(&operation),
            };
            match done {
                Ok(()) => self.at_start.push(operation),
                Err(error) => tracing::warn!(%error, "an operation of the timeline is left out"),
            }
        }
        for_clients
    }

    /// Does an operation, and notifies observers if it could be done.
    fn operate(&mut self, operation: Operation, author: Author) -> Result<Result<(), OperationError>, RecordError> {
        let done = match operation.for_client() {
            Some((name, asked)) => self.operate_client(name, &asked),
            None => self.may_reset(&operation).and_then(|()| self.session.operate(&operation)),
        };
        if done.is_ok() {
            self.notify_operated(operation, author)?;
        }
        Ok(done)
    }

    /// A session is reset with all of its clients, or not at all: a machine that begins again alone is another one than its
    /// program believes.
    fn may_reset(&self, operation: &Operation) -> Result<(), OperationError> {
        if *operation != Operation::Reset {
            return Ok(());
        }
        // slots and names lie in the order of the ids
        self.slots.iter().zip(self.session.plan().clients()).try_for_each(|(slot, name)| {
            let refused = |source| OperationError::NoReset { client: name.clone(), source };
            slot.carrier.can_reset().map_err(refused)
        })
    }

    pub(super) fn notify_operated(&mut self, operation: Operation, author: Author) -> Result<(), RecordError> {
        let (step, t_v) = self.committed();
        let input = OperatorInput { resets: self.resets, step, t_v, author, operation };
        self.observers.iter_mut().try_for_each(|observer| observer.operated(&input))
    }

    fn operate_client(&mut self, name: &ClientName, asked: &ClientOperation) -> Result<(), OperationError> {
        let id = self.client_id(name)?;
        let refused = |source| OperationError::Client { client: name.clone(), source };
        debug_assert_eq!(self.slots[id.index()].id, id, "slots lie in the order of the ids");
        self.slots[id.index()].carrier.operate(asked).map_err(refused)?;
        if asked.moves_turns() {
            self.session.wake_next(id);
        }
        Ok(())
    }

    fn client_id(&self, name: &ClientName) -> Result<ClientId, OperationError> {
        self.session.plan().client_id(name).ok_or_else(|| {
            let names = self.session.plan().clients().iter().map(ClientName::as_str);
            OperationError::UnknownClient { client: name.clone(), nearest: did_you_mean(name.as_str(), names) }
        })
    }

    pub(super) fn status(&self) -> Status {
        self.session.status()
    }
}
