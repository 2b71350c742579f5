//! A running session as a value, and back.

use std::collections::BTreeSet;

use super::{Lockstep, Reached};
use crate::checkpoint::{Checkpoint, CheckpointError, PlanSummary, SessionSettings};
use crate::client::StateError;
use crate::end::FailureCause;
use crate::observer::RecordError;
use crate::time::VirtualTime;
use crate::timeline::When;

impl Lockstep {
    /// Says what the session is made of, for checkpoints that are taken of it and by it.
    pub fn set_settings(&mut self, settings: SessionSettings) {
        self.settings = settings;
    }

    /// Lets a checkpoint be taken up in which these settings are others: whoever says so knows that they leave the shape of
    /// the state as it is, and that their clients take it.
    pub fn accept_settings(&mut self, may_differ: BTreeSet<String>) {
        self.may_differ = may_differ;
    }

    /// Takes a checkpoint at the boundary at which the session is.
    ///
    /// # Errors
    /// Not at a boundary, or a client cannot save. One that says so stays, and the session goes on; one that is lost
    /// meanwhile has failed, which the next [`run_to`](Self::run_to) finds.
    pub fn checkpoint(&mut self) -> Result<Checkpoint, CheckpointError> {
        let session = self.session.save().ok_or(CheckpointError::NotNow)?;
        let digest = self.digest.clone().ok_or(CheckpointError::NotNow)?;
        let names = self.session.plan().clients().to_vec();
        let mut clients = Vec::with_capacity(names.len());
        for (slot, client) in self.slots.iter_mut().zip(names) {
            match slot.carrier.save() {
                Ok(state) => clients.push((client, state)),
                Err(source) => {
                    if let StateError::Lost(cause) = &source {
                        self.session.fail(slot.id, cause.clone());
                    }
                    return Err(CheckpointError::Client { client, source });
                }
            }
        }
        let plan = PlanSummary::of(self.session.plan());
        let (settings, timeline) = (self.settings.clone(), self.timeline.save());
        self.observers.iter_mut().for_each(|observer| observer.saved(&self.session));
        Ok(Checkpoint { plan, settings, session, timeline, digest, clients })
    }

    /// Goes on to the first boundary at or after `t_v`, or to the next one from which a session can fork whose operations
    /// wait for one of the timeline's condition monitors: the last boundary before that comes true. At least one step is done, but
    /// for a session that has yet to begin, which begins.
    ///
    /// # Errors
    /// A recording cannot be written; the session is closed for all then.
    pub fn run_to_fork(&mut self, t_v: VirtualTime) -> Result<Reached, RecordError> {
        loop {
            let step = self.session.step();
            let next = self.digest.as_ref().map_or(VirtualTime::ZERO, |_| self.session.t_v() + step);
            if self.run_to(next)? == Reached::End {
                return Ok(Reached::End);
            }
            if self.session.t_v() >= t_v || self.coming().next().is_some() {
                return Ok(Reached::Boundary);
            }
        }
    }

    /// The condition monitors of the timeline that come true in the step that begins here.
    pub fn coming(&self) -> impl Iterator<Item = &When> {
        self.timeline.coming(&self.session, self.session.t_v())
    }

    /// Takes up a checkpoint before the session runs. Observers begin at its image.
    ///
    /// The session may have another timeline than that of the checkpoint, if both agree on what has
    /// happened until then: that is how a case forks from the run of another.
    ///
    /// # Errors
    /// It belongs to another session, set otherwise or with another past, or a client cannot take its
    /// state back; the session must not be run then.
    pub fn resume(&mut self, checkpoint: &Checkpoint) -> Result<(), CheckpointError> {
        // In the order plan, settings, timeline, state, clients: a refusal names the first difference.
        let plan = PlanSummary::of(self.session.plan());
        if let Some(difference) = checkpoint.plan.difference(&plan) {
            return Err(CheckpointError::OtherSession(difference));
        }
        if let Some(difference) = self.settings.difference(&checkpoint.settings, &self.may_differ) {
            return Err(difference);
        }
        let (theirs, ours) = (checkpoint.settings.name.clone(), self.settings.name.clone());
        let other = |source| CheckpointError::OtherTimeline { theirs, ours, source };
        self.timeline.restore(&checkpoint.timeline, checkpoint.t_v()).map_err(other)?;
        let same_clients = checkpoint.clients.iter().map(|(name, _)| name).eq(self.session.plan().clients());
        if !same_clients || !self.session.restore(&checkpoint.session) {
            return Err(CheckpointError::OtherSession("its state does not fit its own plan".to_owned()));
        }
        debug_assert_eq!(checkpoint.clients.len(), self.slots.len(), "a checkpoint has one state per client");
        let (steps, t_v) = (self.session.cycle().steps(), self.session.t_v());
        for (slot, (client, state)) in self.slots.iter_mut().zip(&checkpoint.clients) {
            let restored = slot.carrier.restore(steps, t_v, state);
            if let Err(source) = restored {
                let cause = match &source {
                    StateError::Lost(cause) => cause.clone(),
                    refused => FailureCause::State(refused.to_string()),
                };
                self.session.fail(slot.id, cause);
                return Err(CheckpointError::Client { client: client.clone(), source });
            }
            self.session.read_back(slot.id, &mut slot.outputs);
        }
        self.digest = Some(checkpoint.digest.clone());
        self.begin_observers = true;
        Ok(())
    }
}
