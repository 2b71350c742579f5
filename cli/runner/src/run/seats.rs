//! Clients that take part over OPC UA, and the server of the session's information model.

use std::net::{Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use onescan_links::opcua::{self, ServeError, ServedSession};
use onescan_server::client::{Client, JoinRequest};
use onescan_server::formation::FormationError;
use onescan_server::observer::Observer;
use onescan_server::plan::SessionPlan;
use onescan_server::published::Published;

use super::config::Doors;
use super::error::RunError;
use super::processes::{Passed, Processes};
use crate::error::{ListenError, Usage};
use crate::interrupt::Interrupt;
use onescan_base::notice::NOTICE;

/// A client that is to come over OPC UA, with the command that starts it; empty if somebody else does.
struct Expected {
    request: JoinRequest,
    command: Vec<String>,
}

/// The clients that are to come, before the server is there.
#[derive(Default)]
pub(super) struct Seats {
    expected: Vec<Expected>,
}

/// The session over OPC UA.
pub(super) struct OpcUaSeats {
    served: Box<dyn ServedSession>,
    /// Where certificates are kept.
    pki: Option<PathBuf>,
    expected: Vec<Expected>,
}

impl Seats {
    /// A place for one more.
    pub(super) fn add(&mut self, request: JoinRequest, command: Vec<String>) {
        self.expected.push(Expected { request, command });
    }

    /// Serves the session, if anybody is to come or `--opcua` asks for it.
    pub(super) fn open(
        self,
        doors: &Doors,
        plan: &SessionPlan,
        interrupt: &Interrupt,
    ) -> Result<Option<OpcUaSeats>, RunError> {
        if self.expected.is_empty() && doors.opcua.is_none() {
            return Ok(None);
        }
        let requests: Vec<JoinRequest> = self.expected.iter().map(|expected| expected.request.clone()).collect();
        let address = doors.opcua.unwrap_or(SocketAddr::from((Ipv4Addr::LOCALHOST, 0)));
        let serve = |serve: opcua::ServeSession| serve(address, plan, &requests, interrupt.mailbox(), &doors.access);
        let served = opcua::serve().and_then(serve).map_err(|error| match error {
            ServeError::Io(source) => RunError::from(ListenError { address, source }),
            error => Usage::new(error.to_string(), None).into(),
        })?;
        if doors.opcua.is_some() {
            tracing::info!(target: NOTICE, "serving the session at {}", served.url());
        }
        let pki = doors.access.pki.clone();
        Ok(Some(OpcUaSeats { served, pki, expected: self.expected }))
    }
}

impl OpcUaSeats {
    /// The clients as the session sees them.
    pub(super) fn clients(&self, patience: Duration) -> impl Iterator<Item = Box<dyn Client>> {
        let client = move |(seat, expected): (usize, &Expected)| -> Box<dyn Client> {
            self.served.client(seat, expected.request.clone(), patience)
        };
        self.expected.iter().enumerate().map(client)
    }

    /// Where the session is to publish its views.
    pub(super) fn published(&self) -> Published {
        self.served.published()
    }

    /// What notifies subscribers of each step over OPC UA.
    pub(super) fn observer(&self) -> Box<dyn Observer> {
        self.served.observer()
    }

    /// Starts those that have a command.
    pub(super) fn start(&self, folder: &Path, named: &[String], processes: &mut Processes) -> Result<(), RunError> {
        let url = self.served.url();
        for Expected { request, command } in &self.expected {
            let pass = Passed { named, shown: Vec::new() };
            processes.start_command(&request.name, command, folder, &url, pass)?;
            if command.is_empty() {
                tracing::info!(target: NOTICE, "waiting at {url} for client `{}`", request.name);
            }
        }
        Ok(())
    }

    /// Who tried to come in last and was sent away, and why.
    fn refused(&self) -> Option<String> {
        if let Some(refused) = self.served.refused() {
            return Some(refused);
        }
        let rejected = self.pki.as_ref()?.join("rejected");
        let is_any = std::fs::read_dir(&rejected).is_ok_and(|mut entries| entries.next().is_some());
        let reported = || {
            let rejected = rejected.display();
            format!(
                "an OPC UA client whose certificate is not trusted; move it from {rejected} to the folder `trusted`"
            )
        };
        is_any.then(reported)
    }

    /// Waits until all have started.
    pub(super) fn wait(
        &self,
        patience: Duration,
        interrupt: &Interrupt,
        processes: &mut Processes,
    ) -> Result<(), RunError> {
        const LOOK_UP: Duration = Duration::from_millis(50);
        let deadline = Instant::now() + patience;
        loop {
            let missing = self.served.missing().join(", ");
            if missing.is_empty() {
                return Ok(());
            }
            if let Some(ended) = processes.first_ended() {
                return Err(ended);
            }
            if interrupt.is_raised() {
                return Err(FormationError::Interrupted { missing }.into());
            }
            if Instant::now() > deadline {
                let refused = self.refused().map(|who| format!("somebody tried and was refused: {who}"));
                return Err(FormationError::Missing { missing, patience, refused }.into());
            }
            self.served.wait_for_start(LOOK_UP);
        }
    }
}
