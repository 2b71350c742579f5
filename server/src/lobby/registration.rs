//! The seats of a session that forms: who has one, who is missing, and how long that may take.

use std::time::Duration;

use onescan_base::foreign::one_line;

use crate::client::{ClientId, JoinRequest};
use crate::end::FailureCause;
use crate::join::JoinRefusal;
use crate::plan::SessionPlan;
use crate::session::Session;

/// A session in state `start`, and who tried last to get in and has not.
#[derive(Clone, Debug)]
pub struct Registration {
    session: Session,
    sent_away: Option<String>,
}

/// How it stands with the seats.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// All seats are taken: the session can begin.
    Complete,
    /// Somebody is missing, and there is time.
    Waiting,
    /// Somebody is missing, and time is up.
    TooLate {
        /// Who tried last and was not let in or has gone again, and why.
        sent_away: Option<String>,
    },
}

impl Registration {
    /// Nobody has a seat.
    pub fn new(plan: SessionPlan) -> Self {
        Self { session: Session::new(plan), sent_away: None }
    }

    /// The session as far as it has formed.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// The session, to begin with it.
    pub fn into_session(self) -> Session {
        self.session
    }

    /// A client wants its seat.
    ///
    /// # Errors
    /// It gets none.
    pub fn apply(&mut self, request: &JoinRequest, origin: &str) -> Result<ClientId, JoinRefusal> {
        let result = self.session.join(request);
        if let Err(refusal) = &result {
            let (name, refusal) = (&request.name, refusal.to_string());
            let refusal = one_line(&refusal);
            self.sent_away = Some(format!("somebody tried and was refused: `{name}` from {origin}: {refusal}"));
        }
        result
    }

    /// A client has gone since it got its seat, which is free again. False once the session has begun.
    pub fn left(&mut self, id: ClientId, cause: &FailureCause) -> bool {
        let left = self.session.leave(id);
        if left && let Some(name) = self.session.plan().clients().get(id.index()) {
            self.sent_away = Some(format!("`{name}` had joined, and has gone: {cause}"));
        }
        left
    }

    /// True if the client that asks has a seat already, or somebody else has it.
    pub fn is_taken(&self, request: &JoinRequest) -> bool {
        let id = self.session.plan().client_id(&request.name);
        id.is_some_and(|id| self.session.member(id).is_some())
    }

    /// True if nobody is missing.
    pub fn is_complete(&self) -> bool {
        self.session.missing_clients().next().is_none()
    }

    /// The missing clients, as they are reported.
    pub fn missing(&self) -> String {
        let names: Vec<String> = self.session.missing_clients().map(|name| format!("`{name}`")).collect();
        names.join(", ")
    }

    /// How it stands after having waited so long, of `patience`. Whoever comes and is sent away, however often, does not
    /// hold the wait open.
    pub fn verdict(&self, waited: Duration, patience: Duration) -> Verdict {
        if self.is_complete() {
            Verdict::Complete
        } else if waited < patience {
            Verdict::Waiting
        } else {
            Verdict::TooLate { sent_away: self.sent_away.clone() }
        }
    }
}
