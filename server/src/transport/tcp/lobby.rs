//! The lobby: a listener whose connections are moved by the [`Reception`]. What it decides is done here, with sockets and
//! a clock; nothing is decided here.

use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::sync::mpsc::{Receiver, SendError, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use tokio::net::{TcpListener, TcpStream};
use tokio::sync::Notify;
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};
use tokio::time::Instant;
use tokio_rustls::TlsAcceptor;
use tokio_util::task::TaskTracker;

use super::AGENT;
use super::attend::{self, Order};
use super::guest::Guest;
use super::socket::Socket;
use crate::access::{Day, Register};
use crate::carrier::{Applicant, Door};
use crate::lobby::reception::{BEGUN, FAREWELL_TIMEOUT};
use crate::lobby::{Action, Now, Reception, Terms, Visitor};
use crate::mailbox::Mailbox;
use crate::plan::SessionPlan;
use crate::transport::tls::Identity;
use crate::wire::{FRAME_BYTES_MAX, ServerMessage, VERSIONS};

/// What a session asks of those who come.
#[derive(Clone, Debug, Default)]
pub struct House {
    /// The tokens that are good; whoever comes is let in without.
    pub register: Option<Register>,
    /// The session's certificate; plain text without.
    pub identity: Option<Identity>,
}

/// A listener with a thread of its own; closed when dropped.
pub struct Lobby {
    address: SocketAddr,
    /// Nothing once the door is shut.
    applicants: Mutex<Option<Receiver<Guest>>>,
    host: Arc<Host>,
    close: Arc<Notify>,
    thread: Option<std::thread::JoinHandle<()>>,
}

/// What the tasks of all connections share.
pub(super) struct Host {
    reception: Mutex<Reception>,
    /// Where the orders for each connection go.
    lines: Mutex<BTreeMap<Visitor, UnboundedSender<Order>>>,
    opened: Instant,
    applicants: Sender<Guest>,
    pub(super) mailbox: Mailbox,
    pub(super) acceptor: Option<TlsAcceptor>,
    tasks: TaskTracker,
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
        let (applicants, receiver) = channel();
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        let host = Arc::new(Host {
            reception: Mutex::new(Reception::new(terms(plan, house.register)?)),
            lines: Mutex::default(),
            opened: Instant::now(),
            applicants,
            mailbox,
            acceptor: house.identity.map(|identity| TlsAcceptor::from(identity.0)),
            tasks: TaskTracker::new(),
        });
        let close = Arc::new(Notify::new());
        let (hosting, closing) = (Arc::clone(&host), Arc::clone(&close));
        let thread = std::thread::Builder::new()
            .name("lobby".to_owned())
            .spawn(move || runtime.block_on(receive_guests(listener, hosting, closing)))?;
        Ok(Self { address, applicants: Mutex::new(Some(receiver)), host, close, thread: Some(thread) })
    }

    /// Where it listens; tells the port where none was asked for.
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

impl Door for Lobby {
    fn next_applicant(&self, patience: Duration) -> Option<Box<dyn Applicant>> {
        let waiting = self.applicants.lock().unwrap_or_else(PoisonError::into_inner);
        let guest = waiting.as_ref()?.recv_timeout(patience).ok()?;
        Some(Box::new(guest))
    }

    fn shut(&self) {
        let waiting = self.applicants.lock().unwrap_or_else(PoisonError::into_inner).take();
        // Who was waiting is told; who comes later is told by the reception.
        waiting.iter().flat_map(Receiver::try_iter).for_each(|guest| Box::new(guest).refuse(BEGUN));
        self.host.act(Reception::shut);
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

impl Host {
    /// What time it is. The clock of the wall says the day only, which no session knows.
    fn now(&self) -> Now {
        let since_epoch = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        Now { at: self.opened.elapsed(), today: Day::of(since_epoch) }
    }

    fn reception(&self) -> MutexGuard<'_, Reception> {
        self.reception.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn lines(&self) -> MutexGuard<'_, BTreeMap<Visitor, UnboundedSender<Order>>> {
        self.lines.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Tells the reception what has happened, and passes on what is to be done.
    pub(super) fn act(&self, happened: impl FnOnce(&mut Reception, Now) -> Vec<Action>) {
        let mut reception = self.reception();
        let actions = happened(&mut reception, self.now());
        let lines = self.lines();
        for action in actions {
            let (visitor, order) = Order::of(action);
            if let Some(line) = lines.get(&visitor) {
                // A connection that is gone has nothing left to do.
                let _ = line.send(order);
            }
        }
    }

    /// When the stage of a connection ends.
    pub(super) fn deadline_of(&self, visitor: Visitor) -> Option<Instant> {
        self.reception().deadline_of(visitor).map(|deadline| self.opened + deadline)
    }

    /// The other side says no more; true if it still waits for an answer.
    pub(super) fn hung_up(&self, visitor: Visitor) -> bool {
        self.reception().hung_up(visitor)
    }

    /// The connection is no longer attended to.
    pub(super) fn leave(&self, visitor: Visitor) {
        self.lines().remove(&visitor);
    }

    /// A client waits for the session's thread to decide.
    pub(super) fn wait_for_seat(&self, guest: Guest) {
        if let Err(SendError(guest)) = self.applicants.send(guest) {
            Box::new(guest).refuse(BEGUN);
        }
    }

    /// The connection of a client that has got its seat; nothing if it is gone, or has been sent away meanwhile.
    pub(super) fn hand_over(&self, visitor: Visitor) -> Option<Socket> {
        let (sender, receiver) = channel();
        {
            let mut reception = self.reception();
            if !reception.seated(visitor) {
                return None;
            }
            self.lines().get(&visitor)?.send(Order::HandOver(sender)).ok()?;
        }
        // The task of a connection that has gone drops the sender.
        receiver.recv().ok()?.ok()
    }
}

async fn receive_guests(listener: std::net::TcpListener, host: Arc<Host>, closing: Arc<Notify>) {
    let listener = match TcpListener::from_std(listener) {
        Ok(listener) => listener,
        Err(error) => return tracing::error!(%error, "the lobby cannot listen"),
    };
    for number in 0.. {
        let accepted = tokio::select! {
            () = closing.notified() => return part_from_all(&host).await,
            accepted = listener.accept() => accepted,
        };
        match accepted {
            Ok((stream, peer)) => come(Visitor(number), stream, peer, &host),
            Err(error) => {
                // Out of descriptors, mostly: others may leave meanwhile.
                tracing::warn!(%error, "cannot accept a connection");
                tokio::time::sleep(Duration::from_millis(100)).await;
            }
        }
    }
}

/// A connection of its own task.
fn come(visitor: Visitor, stream: TcpStream, peer: SocketAddr, host: &Arc<Host>) {
    // It only costs time where it cannot be set.
    let _ = stream.set_nodelay(true);
    let orders = open_line(visitor, host);
    host.act(|reception, now| reception.opened(visitor, peer.ip(), now));
    let task = attend::newcomer(stream, peer, visitor, orders, Arc::clone(host));
    host.tasks.spawn(task);
}

fn open_line(visitor: Visitor, host: &Host) -> UnboundedReceiver<Order> {
    let (line, orders) = unbounded_channel();
    host.lines().insert(visitor, line);
    orders
}

/// One who asked for the session's end still hears that it came: what has been taken from the mailbox is answered
/// before the connections close.
async fn part_from_all(host: &Host) {
    host.act(Reception::closing);
    // Nobody takes these any more.
    while host.mailbox.take().is_some() {}
    host.tasks.close();
    // One who does not read is left.
    let _ = tokio::time::timeout(FAREWELL_TIMEOUT, host.tasks.wait()).await;
}
