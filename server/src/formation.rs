//! A session that is being formed: clients join until nobody is missing.

use std::time::{Duration, Instant};

use thiserror::Error;

use crate::carrier::{Carrier, ClientListener, InProcess, PendingClient};
use crate::client::{Client, ClientId};
use crate::end::{FailureCause, SessionEnd};
use crate::join::JoinRefusal;
use crate::lobby::{Registration, Verdict};
use crate::lockstep::Lockstep;
use crate::mailbox::{Mailbox, Request, Wish};
use crate::operation::Control;
use crate::plan::SessionPlan;
use crate::signal::PortLayout;
use crate::time::VirtualTime;

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
    registration: Registration,
    carriers: Joined,
    mailbox: Mailbox,
}

/// The ways to those who have joined, by the rank of their names. Who is still here when the session comes to nothing
/// hears that it is over.
#[derive(Default)]
struct Joined(Vec<Option<Box<dyn Carrier>>>);

impl Drop for Joined {
    fn drop(&mut self) {
        let end = SessionEnd::Stopped { t_v: VirtualTime::ZERO };
        self.0.iter_mut().flatten().for_each(|carrier| carrier.end(&end));
        self.0.iter_mut().flatten().for_each(|carrier| carrier.close());
    }
}

/// Why a session cannot begin.
#[derive(Debug, Error)]
pub enum FormationError {
    /// A client of this process does not fit the plan.
    #[error(transparent)]
    Refused(#[from] JoinRefusal),
    #[error("client {missing} did not join within {} s{}", patience.as_secs_f64(), sent_away(refused.as_ref()))]
    Missing {
        missing: String,
        /// How long the server waited.
        patience: Duration,
        /// Who tried last and was not let in or has gone again, and why.
        refused: Option<String>,
    },
    /// The wait was called off, here or by an operator.
    #[error("stopped while waiting for client {missing} to join")]
    Interrupted { missing: String },
    /// A signal that nobody writes.
    #[error("signal {0} has no writer: no client that joined writes it")]
    Unwritten(String),
}

fn sent_away(refused: Option<&String>) -> String {
    refused.map(|who| format!("; {who}")).unwrap_or_default()
}

/// Called while the server waits, with the missing clients' names. False calls the wait off.
pub type WhileWaiting<'a> = &'a mut dyn FnMut(&str) -> bool;

impl Formation {
    /// Nobody has joined.
    pub fn new(plan: SessionPlan) -> Self {
        let registration = Registration::new(plan);
        let carriers = Joined(registration.session().clients().map(|_| None).collect());
        Self { registration, carriers, mailbox: Mailbox::new() }
    }

    /// Takes wishes of operators from `mailbox` while it waits: how the session is, and its end. All others wait for
    /// its beginning.
    pub fn set_mailbox(&mut self, mailbox: Mailbox) {
        self.mailbox = mailbox;
    }

    /// A client of this process joins.
    ///
    /// # Errors
    /// The session's plan has no place for it.
    pub fn join(&mut self, client: Box<dyn Client>) -> Result<ClientId, JoinRefusal> {
        let id = self.registration.apply(&client.join(), "this process")?;
        self.carriers.0[id.index()] = Some(Box::new(InProcess::new(client)));
        Ok(id)
    }

    /// Lets clients in through `client_listener` until nobody is missing. Clients that do not fit receive the reason
    /// and sent away; the wait goes on.
    ///
    /// # Errors
    /// Somebody is still missing after `patience`.
    pub fn admit_from(
        &mut self,
        client_listener: &dyn ClientListener,
        patience: Duration,
        reply_timeout: Duration,
        while_waiting: WhileWaiting<'_>,
    ) -> Result<(), FormationError> {
        // How often `while_waiting` is asked, so that Ctrl-C is heard at once.
        const LOOK_UP: Duration = Duration::from_millis(50);
        let (begun, mut later) = (Instant::now(), Vec::new());
        loop {
            // A session does not begin with one who has gone meanwhile.
            if self.registration.is_complete() && !self.let_go_who_left() {
                break;
            }
            if !while_waiting(&self.registration.missing()) || self.is_called_off(&mut later) {
                return Err(FormationError::Interrupted { missing: self.registration.missing() });
            }
            match client_listener.next_pending(LOOK_UP) {
                Some(pending_client) => {
                    // Who comes back may be there before it is seen that it had gone.
                    if self.registration.is_taken(pending_client.request()) {
                        self.let_go_who_left();
                    }
                    self.admit(pending_client, reply_timeout);
                }
                None => drop(self.let_go_who_left()),
            }
            if let Verdict::TooLate { sent_away } = self.registration.verdict(begun.elapsed(), patience) {
                let missing = self.registration.missing();
                return Err(FormationError::Missing { missing, patience, refused: sent_away });
            }
        }
        client_listener.shut();
        for request in later {
            self.mailbox.post(request);
        }
        Ok(())
    }

    /// Answers operators; true if one of them has ended the session. What acts on a session that runs is left for `later`.
    fn is_called_off(&self, later: &mut Vec<Request>) -> bool {
        while let Some(request) = self.mailbox.take() {
            let (ends, signals) = match &request.wish {
                Wish::Do(operation) if operation.control() == Some(Control::Stop) => (true, &[][..]),
                Wish::Do(_) => {
                    later.push(request);
                    continue;
                }
                Wish::Look(signals) => (false, &signals[..]),
            };
            let status = self.registration.session().look(signals);
            if let Some(reply) = request.reply
                && reply.send(status).is_err()
            {
                tracing::debug!("the operator left before it heard how the session is");
            }
            if ends {
                return true;
            }
        }
        false
    }

    /// Frees the places of clients that have gone since they joined; true if there are any.
    fn let_go_who_left(&mut self) -> bool {
        let mut any = false;
        for (id, carrier) in (0..).map(ClientId::from_index).zip(&mut self.carriers.0) {
            let Some(cause) = carrier.as_mut().and_then(|carrier| carrier.find_lost()) else { continue };
            if self.registration.left(id, &cause) {
                tracing::warn!(client = id.index(), %cause, "has gone before the session began");
                (any, *carrier) = (true, None);
            }
        }
        any
    }

    /// Gives a pending client its seat, or sends it away.
    fn admit(&mut self, pending_client: Box<dyn PendingClient>, reply_timeout: Duration) {
        let (origin, name) = (pending_client.origin(), pending_client.request().name.clone());
        match self.registration.apply(pending_client.request(), &origin) {
            Ok(id) => {
                tracing::info!(client = %name, %origin, "joined");
                let inputs = PortLayout::new(pending_client.request().reads.clone());
                let outputs = PortLayout::new(pending_client.request().writes.clone());
                match pending_client.admit(&inputs, &outputs, reply_timeout) {
                    Ok(carrier) => self.carriers.0[id.index()] = Some(carrier),
                    Err(error) => {
                        tracing::warn!(client = %name, %origin, %error, "has gone before it had its seat");
                        self.registration.left(id, &FailureCause::Disconnected);
                    }
                }
            }
            Err(refusal) => {
                tracing::warn!(client = %name, %origin, %refusal, "refused");
                pending_client.refuse(&refusal.to_string());
            }
        }
    }

    /// The session begins: everybody is in and every signal has its writer.
    ///
    /// # Errors
    /// Somebody is missing, or a signal has no writer.
    pub fn start(mut self) -> Result<Lockstep, FormationError> {
        if !self.registration.is_complete() {
            let missing = self.registration.missing();
            return Err(FormationError::Missing { missing, patience: Duration::ZERO, refused: None });
        }
        let session = self.registration.into_session();
        let unwritten: Vec<String> = session.unwritten_signals().map(|name| format!("`{name}`")).collect();
        if !unwritten.is_empty() {
            return Err(FormationError::Unwritten(unwritten.join(", ")));
        }
        Ok(Lockstep::new(session, std::mem::take(&mut self.carriers.0).into_iter().flatten().collect()))
    }
}
