//! What the connections of the lobby share: the acceptor, and where the orders for each of them go.

use std::collections::BTreeMap;
use std::sync::mpsc::{SendError, Sender, channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};
use tokio::time::Instant;
use tokio_rustls::TlsAcceptor;

use super::holders::{Holders, REVOKED};
use super::order::{Application, Order};
use super::socket::Socket;
use crate::access::Day;
use crate::lobby::acceptor::BEGUN;
use crate::lobby::{Acceptor, Action, Now, Terms, Visitor};
use crate::mailbox::Mailbox;

/// What the tasks of all connections share.
pub(super) struct Host {
    acceptor: Mutex<Acceptor>,
    /// Where the orders for each connection go.
    lines: Mutex<BTreeMap<Visitor, UnboundedSender<Order>>>,
    opened: Instant,
    pending_clients: Sender<Application>,
    pub(super) mailbox: Mailbox,
    pub(super) tls_acceptor: Option<TlsAcceptor>,
    /// Who has come in with a certificate.
    pub(super) holders: Holders,
}

impl Host {
    /// Nobody is there; clients that want a seat go to `pending_clients`.
    pub(super) fn new(
        terms: Terms,
        pending_clients: Sender<Application>,
        mailbox: Mailbox,
        (tls_acceptor, holders): (Option<TlsAcceptor>, Holders),
    ) -> Self {
        let (acceptor, lines) = (Mutex::new(Acceptor::new(terms)), Mutex::default());
        Self { acceptor, lines, opened: Instant::now(), pending_clients, mailbox, tls_acceptor, holders }
    }

    /// Sends away those whose certificate has been revoked since they came, and ends the connections of those who take part.
    pub(super) fn end_revoked(&self) {
        for visitor in self.holders.end_revoked() {
            self.act(|acceptor, now| acceptor.refused(visitor, REVOKED, now));
        }
    }

    /// Where the orders for a connection go from here on.
    pub(super) fn open_line(&self, visitor: Visitor) -> UnboundedReceiver<Order> {
        let (line, orders) = unbounded_channel();
        self.lines().insert(visitor, line);
        orders
    }

    /// What time it is. The clock of the wall says the day only, which no session knows.
    fn now(&self) -> Now {
        let since_epoch = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        Now { at: self.opened.elapsed(), today: Day::of(since_epoch) }
    }

    fn acceptor(&self) -> MutexGuard<'_, Acceptor> {
        self.acceptor.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn lines(&self) -> MutexGuard<'_, BTreeMap<Visitor, UnboundedSender<Order>>> {
        self.lines.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Reports to the acceptor what has happened, and passes on what is to be done.
    pub(super) fn act(&self, happened: impl FnOnce(&mut Acceptor, Now) -> Vec<Action>) {
        let mut acceptor = self.acceptor();
        let actions = happened(&mut acceptor, self.now());
        // Both locks, always in this order: what the acceptor decides reaches a connection in the order in which it was decided.
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
        self.acceptor().deadline_of(visitor).map(|deadline| self.opened + deadline)
    }

    /// The other side says no more; true if it still waits for an answer.
    pub(super) fn hung_up(&self, visitor: Visitor) -> bool {
        self.acceptor().hung_up(visitor)
    }

    /// The connection is no longer attended to.
    pub(super) fn leave(&self, visitor: Visitor) {
        self.lines().remove(&visitor);
        self.holders.leave(visitor);
    }

    /// A client waits for the session's thread to decide.
    pub(super) fn wait_for_seat(&self, application: Application) {
        if let Err(SendError(Application { visitor, .. })) = self.pending_clients.send(application) {
            self.act(|acceptor, now| acceptor.refused(visitor, BEGUN, now));
        }
    }

    /// The connection of a client that has got its seat; nothing if it is gone, or has been sent away meanwhile.
    pub(super) fn hand_over(&self, visitor: Visitor) -> Option<Socket> {
        let (sender, receiver) = channel();
        // Before the order, with which the connection leaves the lobby.
        let shown = self.holders.shown_by(visitor);
        {
            let mut acceptor = self.acceptor();
            if !acceptor.seated(visitor) {
                return None;
            }
            self.lines().get(&visitor)?.send(Order::HandOver(sender)).ok()?;
        }
        // Without the locks, which the lobby's one thread needs to get to the order.
        // The task of a connection that has gone drops the sender.
        let socket = receiver.recv().ok()?.ok()?;
        self.holders.seat(shown, socket.tcp());
        Some(socket)
    }
}
