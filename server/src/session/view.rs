//! What can be seen of a session.

use std::collections::BTreeMap;

use super::{Mode, Session};
use crate::client::ClientId;
use crate::cycle::Cycle;
use crate::end::SessionEnd;
use crate::join::Membership;
use crate::layout::ImageLayout;
use crate::operation::OperationError;
use crate::plan::SessionPlan;
use crate::signal::{ClientName, SignalId, SignalName};
use crate::time::{StepCount, TimeSpan, VirtualTime};
use crate::wire::message::Status;

impl Session {
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
        self.cycle.is_at_boundary() && (self.mode == Mode::Held || self.waits_to_start())
    }

    /// True while the initial values are there and the start logic does not let the first step come.
    pub fn waits_to_start(&self) -> bool {
        !self.start_logic && self.cycle.steps() == StepCount(0) && self.cycle.is_at_boundary()
    }

    /// The values that the next step would commit if all clients slept.
    pub fn coming(&self) -> Vec<u8> {
        self.image.coming()
    }

    /// How the session is.
    pub fn status(&self) -> Status {
        let (state, steps, held) = (self.cycle.server(), self.cycle.steps(), self.is_held());
        Status { state, t_v: self.t_v(), steps, held, values: BTreeMap::new() }
    }

    /// How the session is, and what these signals are, as text: what the readers of the next step see.
    ///
    /// # Errors
    /// An unknown signal.
    pub fn look(&self, signals: &[SignalName]) -> Result<Status, OperationError> {
        let value = |signal: &SignalName| {
            let id = self.known(signal)?;
            Ok((signal.clone(), self.layout.ty(id).to_text(self.layout.bytes(id, self.image()))))
        };
        let values = signals.iter().map(value).collect::<Result<_, _>>()?;
        Ok(Status { values, ..self.status() })
    }

    /// True if a single step or a reset has been asked for and not been done.
    pub(crate) fn is_about_to_act(&self) -> bool {
        (self.mode == Mode::OneStep && !self.waits_to_start()) || self.reset
    }

    /// Copies the client's own outputs back, as its last turn left them, whatever lies over them.
    pub(crate) fn read_back(&self, client: ClientId, outputs: &mut [u8]) {
        if let Some(member) = &self.members[client.index()] {
            self.image.gather_staged(&member.outputs, outputs);
        }
    }

    /// All clients in the order of their names.
    pub fn clients(&self) -> impl ExactSizeIterator<Item = ClientId> + use<> {
        (0..self.members.len()).map(ClientId::from_index)
    }
}
