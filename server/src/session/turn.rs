//! What clients say, held against what the session waits for.

use super::Session;
use crate::client::{ClientId, Wake};
use crate::end::{Failure, FailureCause, SessionEnd, Violation};
use crate::image::Commit;
use crate::state::ClientState;
use crate::time::{StepCount, VirtualTime};

/// What a client gives back at the end of a turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Turn<'a> {
    /// The grant it answers.
    pub sequence: StepCount,
    /// The virtual time it ran for.
    pub t_v: VirtualTime,
    /// When it wants the next turn.
    pub wake: Wake,
    pub outputs: &'a [u8],
}

impl Session {
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
            self.image.commit(Commit::EndsStep);
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

    /// Gives a client that sleeps a turn in the next step that has not begun, so that it says again when it wants one.
    pub(crate) fn wake_next(&mut self, client: ClientId) {
        self.cycle.wake_next(client);
    }

    /// A client cannot go on: the session ends for all, now. The first failure is the one reported.
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
}
