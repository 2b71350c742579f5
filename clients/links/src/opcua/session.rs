//! A session served over OPC UA, by whoever has the protocol.

use std::net::SocketAddr;
use std::sync::OnceLock;
use std::time::Duration;

use onescan_server::client::{Client, JoinRequest};
use onescan_server::mailbox::Mailbox;
use onescan_server::observer::Observer;
use onescan_server::plan::SessionPlan;
use onescan_server::published::Published;

use super::{ABSENT, Access, ServeError};

/// Serves a session; `JoinRequest`s are of the clients that are to join over OPC UA, each at the seat with its index.
///
/// # Errors
/// The address cannot be listened on, or the server cannot be set up.
pub type ServeSession =
    fn(SocketAddr, &SessionPlan, &[JoinRequest], Mailbox, &Access) -> Result<Box<dyn ServedSession>, ServeError>;

/// A session that is served until this is dropped.
pub trait ServedSession {
    /// The endpoint, as an OPC UA client takes it.
    fn url(&self) -> String;
    /// Why the server refused somebody last.
    fn refused(&self) -> Option<String>;
    /// The client at a seat, as the session sees it; it waits `patience` for each answer.
    fn client(&self, seat: usize, request: JoinRequest, patience: Duration) -> Box<dyn Client>;
    /// Where the session is to publish its views.
    fn published(&self) -> Published;
    /// What notifies subscribers of each step.
    fn observer(&self) -> Box<dyn Observer>;
    /// The clients that have not started yet.
    fn missing(&self) -> Vec<String>;
    /// Returns when a client has started, at the latest after `moment`.
    fn wait_for_start(&self, moment: Duration);
}

static SERVE: OnceLock<ServeSession> = OnceLock::new();

/// Gives the program a way to serve sessions. A program has one; later calls change nothing.
pub fn install(serve: ServeSession) {
    SERVE.get_or_init(|| serve);
}

/// The program's way to serve sessions.
///
/// # Errors
/// The program was built without OPC UA.
pub fn serve() -> Result<ServeSession, ServeError> {
    SERVE.get().copied().ok_or(ServeError::Absent(ABSENT))
}
