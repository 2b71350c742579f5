//! What is to be done with a connection of the lobby.

use std::net::SocketAddr;
use std::sync::{Arc, mpsc};

use super::socket::Socket;
use crate::client::JoinRequest;
use crate::lobby::{Action, Visitor};
use crate::mailbox::Wish;
use crate::wire::ServerMessage;

/// A client that wants a seat.
pub(super) struct Application {
    pub(super) visitor: Visitor,
    pub(super) request: JoinRequest,
    pub(super) peer: SocketAddr,
}

/// What is to be done with a connection.
pub(super) enum Order {
    Send(Arc<ServerMessage>),
    Apply(JoinRequest),
    /// The connection goes over to the session's thread.
    HandOver(mpsc::Sender<std::io::Result<Socket>>),
    Ask(Wish),
    Part,
    Close,
}

impl Order {
    /// The order of an action, and for whom it is.
    pub(super) fn of(action: Action) -> (Visitor, Self) {
        match action {
            Action::Send(visitor, message) => (visitor, Self::Send(message)),
            Action::Apply(visitor, request) => (visitor, Self::Apply(request)),
            Action::Ask(visitor, wish) => (visitor, Self::Ask(wish)),
            Action::Part(visitor) => (visitor, Self::Part),
            Action::Close(visitor) => (visitor, Self::Close),
        }
    }
}
