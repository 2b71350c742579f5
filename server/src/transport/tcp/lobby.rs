//! The lobby: a listener whose connections are moved by the [`Acceptor`]. What it decides is done here, with sockets and
//! a clock; nothing is decided here.

use std::net::SocketAddr;
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use onescan_base::threads;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::Notify;
use tokio::time::MissedTickBehavior;
use tokio_rustls::TlsAcceptor;
use tokio_util::task::TaskTracker;

use super::holders::Holders;
use super::host::Host;
use super::order::Application;
use super::pending::TcpPendingClient;
use super::{AGENT, attend};
use crate::access::{Register, RevocationList};
use crate::carrier::{ClientListener, PendingClient};
use crate::lobby::acceptor::CLOSE_TIMEOUT;
use crate::lobby::{Acceptor, Terms, Visitor};
use crate::mailbox::Mailbox;
use crate::plan::SessionPlan;
use crate::transport::tls::Identity;
use crate::transport::{accept, runtime};
use crate::wire::{FRAME_BYTES_MAX, ServerMessage, VERSIONS};

/// How often it is looked whether certificates have been revoked.
const LOOK: Duration = Duration::from_secs(1);

/// What a session asks of those who come.
#[derive(Clone, Debug, Default)]
pub struct House {
    /// The tokens that are good; whoever comes is let in without.
    pub register: Option<Register>,
    /// The session's certificate; plain text without.
    pub identity: Option<Identity>,
    /// Certificates of those who come that have been revoked; none without.
    pub revocations: Option<RevocationList>,
}

/// A listener with a thread of its own; closed when dropped.
pub struct Lobby {
    address: SocketAddr,
    /// Nothing once the client listener is shut.
    pending_clients: Mutex<Option<Receiver<Application>>>,
    host: Arc<Host>,
    close: Arc<Notify>,
    thread: Option<std::thread::JoinHandle<()>>,
}

impl Lobby {
    /// Listens on `address` for clients of the session `plan` and for operators, whose wishes go to
    /// `mailbox`. Whoever comes is let in.
    ///
    /// # Errors
    /// The address cannot be listened on.
    pub fn open(address: SocketAddr, plan: &SessionPlan, mailbox: Mailbox) -> std::io::Result<Self> {
        Self::open_house(address, plan, mailbox, House::default())
    }

    /// As [`open`](Self::open), for those whom `house` lets in.
    ///
    /// # Errors
    /// The address cannot be listened on.
    pub fn open_house(
        address: SocketAddr,
        plan: &SessionPlan,
        mailbox: Mailbox,
        house: House,
    ) -> std::io::Result<Self> {
        let listener = std::net::TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let (pending_clients, receiver) = channel();
        let runtime = runtime::of_this_thread()?;
        let tls_acceptor = house.identity.map(|identity| TlsAcceptor::from(identity.0));
        let holders = Holders::new(house.revocations);
        let host = Arc::new(Host::new(terms(plan, house.register)?, pending_clients, mailbox, (tls_acceptor, holders)));
        let close = Arc::new(Notify::new());
        let (hosting, closing) = (Arc::clone(&host), Arc::clone(&close));
        let thread =
            threads::start("lobby", move || runtime.block_on(receive_connections(listener, hosting, closing)))?;
        Ok(Self { address, pending_clients: Mutex::new(Some(receiver)), host, close, thread: Some(thread) })
    }

    /// Where it listens; gives the port where none was asked for.
    pub fn address(&self) -> SocketAddr {
        self.address
    }
}

fn terms(plan: &SessionPlan, register: Option<Register>) -> std::io::Result<Terms> {
    let welcome = ServerMessage::Welcome {
        protocol: VERSIONS.max,
        agent: AGENT.to_owned(),
        step: plan.step(),
        frame_bytes_max: FRAME_BYTES_MAX as u32,
        signals: plan.signals().to_vec(),
    };
    let welcome_bytes = crate::wire::frame::to_json(&welcome)?.len();
    Ok(Terms { welcome: Arc::new(welcome), welcome_bytes, register: register.map(Arc::new) })
}

impl ClientListener for Lobby {
    fn next_pending(&self, patience: Duration) -> Option<Box<dyn PendingClient>> {
        let waiting = self.pending_clients.lock().unwrap_or_else(PoisonError::into_inner);
        let application = waiting.as_ref()?.recv_timeout(patience).ok()?;
        Some(Box::new(TcpPendingClient { application, host: Arc::clone(&self.host) }))
    }

    fn shut(&self) {
        let waiting = self.pending_clients.lock().unwrap_or_else(PoisonError::into_inner).take();
        // Whoever is waiting is notified by the acceptor, like whoever comes later.
        drop(waiting);
        self.host.act(Acceptor::shut);
    }
}

impl Drop for Lobby {
    fn drop(&mut self) {
        self.close.notify_one();
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has nothing left to close.
            let _ = thread.join();
        }
    }
}

async fn receive_connections(listener: std::net::TcpListener, host: Arc<Host>, closing: Arc<Notify>) {
    let listener = match TcpListener::from_std(listener) {
        Ok(listener) => listener,
        Err(error) => return tracing::error!(%error, "the lobby cannot listen"),
    };
    let tasks = TaskTracker::new();
    let mut look = tokio::time::interval(LOOK);
    look.set_missed_tick_behavior(MissedTickBehavior::Delay);
    let mut number = 0;
    loop {
        tokio::select! {
            () = closing.notified() => return part_from_all(&host, &tasks).await,
            _ = look.tick(), if host.holders.are_revocable() => host.end_revoked(),
            (stream, peer) = accept::next(&listener, "the session") => {
                come(Visitor(number), stream, peer, &host, &tasks);
                number += 1;
            }
        }
    }
}

/// A connection of its own task.
fn come(visitor: Visitor, stream: TcpStream, peer: SocketAddr, host: &Arc<Host>, tasks: &TaskTracker) {
    // It only costs time where it cannot be set.
    let _ = stream.set_nodelay(true);
    let orders = host.open_line(visitor);
    host.act(|acceptor, now| acceptor.opened(visitor, peer.ip(), now));
    let task = attend::newcomer(stream, peer, visitor, orders, Arc::clone(host));
    tasks.spawn(task);
}

/// One who asked for the session's end still hears that it came: what has been taken from the mailbox is answered
/// before the connections close.
async fn part_from_all(host: &Host, tasks: &TaskTracker) {
    host.act(Acceptor::closing);
    // Nobody takes these any more.
    while host.mailbox.take().is_some() {}
    tasks.close();
    // One who does not read is left, and its task ends with the runtime.
    let _ = tokio::time::timeout(CLOSE_TIMEOUT, tasks.wait()).await;
}
