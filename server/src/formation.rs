//! A session that is being formed: clients join until nobody is missing.

use std::time::Duration;

use thiserror::Error;

use crate::carrier::{Applicant, Carrier, Door, InProcess};
use crate::client::{Client, ClientId};
use crate::join::JoinRefusal;
use crate::lockstep::Lockstep;
use crate::plan::SessionPlan;
use crate::session::Session;
use crate::signal::PortLayout;

/// A session in state `start`, and how its clients are reached.
///
/// ```
/// use onescan_server::client::{Client, ClientFault, JoinRequest, Wake};
/// use onescan_server::formation::Formation;
/// use onescan_server::plan::{Coupling, SessionPlan};
/// use onescan_server::signal::{ClientName, Port, SignalDecl, SignalName, SignalType};
/// use onescan_server::time::{TimeSpan, VirtualTime};
///
/// /// Counts its turns in one byte.
/// struct Counter(JoinRequest);
///
/// impl Client for Counter {
///     fn join(&self) -> JoinRequest {
///         self.0.clone()
///     }
///     fn setup(&mut self, outputs: &mut [u8]) -> Result<(), ClientFault> {
///         outputs[0] = 0;
///         Ok(())
///     }
///     fn turn(&mut self, _: VirtualTime, _: &[u8], outputs: &mut [u8]) -> Result<Wake, ClientFault> {
///         outputs[0] += 1;
///         Ok(Wake::NextPeriod)
///     }
/// }
///
/// let step: TimeSpan = "10ms".parse()?;
/// let (name, ty) = (ClientName::new("counter")?, SignalType::BYTE);
/// let signal = SignalName::new("turns")?;
/// let decl = SignalDecl { name: signal.clone(), ty, writer: Some(name.clone()), unit: None };
/// let plan = SessionPlan::new(step, &Coupling::Parallel, vec![decl], vec![name.clone()])?;
///
/// let mut formation = Formation::new(plan);
/// let writes = vec![Port { name: signal, ty }];
/// formation.join(Box::new(Counter(JoinRequest { name, period: step, reads: vec![], writes })))?;
/// let mut lockstep = formation.start()?;
/// lockstep.run_to(VirtualTime::ZERO + "50ms".parse()?)?;
/// assert_eq!(lockstep.session().image(), [5]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Formation {
    session: Session,
    carriers: Vec<Option<Box<dyn Carrier>>>,
}

/// Why a session cannot begin.
#[derive(Debug, Error)]
pub enum FormationError {
    /// A client of this process does not fit the plan.
    #[error(transparent)]
    Refused(#[from] JoinRefusal),
    /// Nobody came.
    #[error("client {missing} did not join within {} s{}", patience.as_secs_f64(), sent_away(refused.as_ref()))]
    Missing {
        /// The names.
        missing: String,
        /// How long the server waited.
        patience: Duration,
        /// Who tried last and was not let in, and why.
        refused: Option<String>,
    },
    /// The wait was called off.
    #[error("stopped while waiting for client {missing} to join")]
    Interrupted {
        /// The names.
        missing: String,
    },
    /// A signal that nobody writes.
    #[error("signal {0} has no writer: no client that joined writes it")]
    Unwritten(String),
    /// A connection that cannot be used.
    #[error("cannot set up the TCP transport: {0}")]
    Connection(#[from] std::io::Error),
}

fn sent_away(refused: Option<&String>) -> String {
    refused.map(|who| format!("; somebody tried and was refused: {who}")).unwrap_or_default()
}

/// Called while the server waits, with the missing clients' names. False calls the wait off.
pub type WhileWaiting<'a> = &'a mut dyn FnMut(&str) -> bool;

impl Formation {
    /// Nobody has joined.
    pub fn new(plan: SessionPlan) -> Self {
        let session = Session::new(plan);
        let carriers = session.clients().map(|_| None).collect();
        Self { session, carriers }
    }

    /// A client of this process joins.
    ///
    /// # Errors
    /// The session's plan has no place for it.
    pub fn join(&mut self, client: Box<dyn Client>) -> Result<ClientId, JoinRefusal> {
        let id = self.session.join(&client.join())?;
        self.carriers[id.index()] = Some(Box::new(InProcess::new(client)));
        Ok(id)
    }

    /// Lets clients in through `door` until nobody is missing. Applicants that do not fit are told why
    /// and sent away; the wait goes on.
    ///
    /// # Errors
    /// Somebody is still missing after `patience`.
    pub fn admit_from(
        &mut self,
        door: &dyn Door,
        patience: Duration,
        reply_timeout: Duration,
        while_waiting: WhileWaiting<'_>,
    ) -> Result<(), FormationError> {
        // How often `while_waiting` is asked, so that Ctrl-C is heard at once.
        const LOOK_UP: Duration = Duration::from_millis(50);
        let (mut waited, mut refused) = (Duration::ZERO, None);
        while self.session.missing_clients().next().is_some() {
            if !while_waiting(&self.missing()) {
                return Err(FormationError::Interrupted { missing: self.missing() });
            }
            if let Some(applicant) = door.next_applicant(LOOK_UP) {
                refused = self.admit(applicant, reply_timeout)?.or(refused);
            } else {
                waited += LOOK_UP;
            }
            if waited >= patience {
                return Err(FormationError::Missing { missing: self.missing(), patience, refused });
            }
        }
        Ok(())
    }

    /// Gives why the applicant was sent away, if it was.
    fn admit(
        &mut self,
        applicant: Box<dyn Applicant>,
        reply_timeout: Duration,
    ) -> Result<Option<String>, FormationError> {
        let (origin, name) = (applicant.origin(), applicant.request().name.clone());
        match self.session.join(applicant.request()) {
            Ok(id) => {
                tracing::info!(client = %name, %origin, "joined");
                let inputs = PortLayout::new(applicant.request().reads.clone());
                let outputs = PortLayout::new(applicant.request().writes.clone());
                self.carriers[id.index()] = Some(applicant.admit(&inputs, &outputs, reply_timeout)?);
                Ok(None)
            }
            Err(refusal) => {
                tracing::warn!(client = %name, %origin, %refusal, "refused");
                applicant.refuse(&refusal.to_string());
                Ok(Some(format!("`{name}` from {origin}: {refusal}")))
            }
        }
    }

    fn missing(&self) -> String {
        let names: Vec<String> = self.session.missing_clients().map(|name| format!("`{name}`")).collect();
        names.join(", ")
    }

    /// The session begins: everybody is in and every signal has its writer.
    ///
    /// # Errors
    /// Somebody is missing, or a signal has no writer.
    pub fn start(self) -> Result<Lockstep, FormationError> {
        if self.session.missing_clients().next().is_some() {
            return Err(FormationError::Missing { missing: self.missing(), patience: Duration::ZERO, refused: None });
        }
        let unwritten: Vec<String> = self.session.unwritten_signals().map(|name| format!("`{name}`")).collect();
        if !unwritten.is_empty() {
            return Err(FormationError::Unwritten(unwritten.join(", ")));
        }
        Ok(Lockstep::new(self.session, self.carriers.into_iter().flatten().collect()))
    }
}
