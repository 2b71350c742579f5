//! One connection in the acceptor.

use std::net::IpAddr;
use std::time::Duration;

use bytes::BytesMut;
use tokio_util::codec::Decoder;

use crate::access::Holder;
use crate::wire::{ClientMessage, Frame, FrameCodec, FrameError, HANDSHAKE_FRAME_BYTES_MAX};

/// How far a connection has come.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum Stage {
    Greeting,
    /// A client whose `join` is due.
    Applying,
    /// A client that waits for the answer to `join`.
    Waiting,
    /// An operator that may ask.
    Operating,
    /// An operator that waits for an answer.
    Asking,
    /// It has heard its last message, and is to close.
    Leaving,
}

#[derive(Clone, Debug)]
pub(super) struct Connection {
    pub(super) address: IpAddr,
    pub(super) stage: Stage,
    /// When the stage ends whatever happens; it does not in those in which the session is to act.
    pub(super) until: Option<Duration>,
    /// Whose certificate it showed, or, from `hello` on, whose token where tokens are asked for.
    pub(super) holder: Option<Holder>,
    /// An operator that has asked for something.
    pub(super) has_asked: bool,
    limit: usize,
    incoming: BytesMut,
}

/// What the bytes of a connection are.
#[derive(Debug)]
pub(super) enum Said {
    Message(ClientMessage),
    /// Not yet a whole one.
    Nothing,
    /// Nothing that can be understood, and why.
    Nonsense(String),
}

impl Connection {
    pub(super) fn new(address: IpAddr, until: Duration) -> Self {
        let (limit, incoming) = (HANDSHAKE_FRAME_BYTES_MAX, BytesMut::new());
        Self { address, stage: Stage::Greeting, until: Some(until), holder: None, has_asked: false, limit, incoming }
    }

    /// What distinguishes this connection from others that are as far.
    pub(super) fn key(&self) -> impl std::hash::Hash + Eq + use<'_> {
        (self.address, &self.stage, self.until, &self.holder, self.has_asked, self.limit, &self.incoming)
    }

    /// From here on frames may be so long.
    pub(super) fn set_limit(&mut self, limit: usize) {
        self.limit = limit;
    }

    /// Takes bytes in. No more are kept than a frame may have, and what comes with its last piece.
    pub(super) fn take_in(&mut self, bytes: &[u8]) {
        self.incoming.extend_from_slice(bytes);
    }

    /// True until it takes part, operates or leaves.
    pub(super) fn is_guest(&self) -> bool {
        matches!(self.stage, Stage::Greeting | Stage::Applying | Stage::Waiting)
    }

    /// Bytes that have come and have not been understood yet.
    pub(super) fn held_bytes(&self) -> usize {
        self.incoming.len()
    }

    /// True if it has said something that has not been looked at.
    pub(super) fn has_more(&self) -> bool {
        !self.incoming.is_empty()
    }

    /// True if it holds more bytes than a frame may have: nobody who waits for an answer has so much to say.
    pub(super) fn says_too_much(&self) -> bool {
        self.incoming.len() > self.limit
    }

    /// True if what came begins as TLS does: the type and the version of a record.
    pub(super) fn speaks_tls(&self) -> bool {
        matches!(self.incoming[..], [0x16, 3, 1..=4, ..])
    }

    /// Forgets what it said: it has nothing to say any more.
    pub(super) fn turn_deaf(&mut self) {
        self.incoming = BytesMut::new();
    }

    /// The next message.
    pub(super) fn next(&mut self) -> Said {
        match FrameCodec::new(self.limit).decode(&mut self.incoming) {
            Ok(None) => Said::Nothing,
            Ok(Some(Frame::Json(text))) => match serde_json::from_slice(&text) {
                Ok(message) => Said::Message(message),
                Err(error) => Said::Nonsense(format!("not a message of this protocol: {error}")),
            },
            Ok(Some(_)) => Said::Nonsense("a binary frame where a JSON message is due".to_owned()),
            Err(FrameError::Io(error)) => Said::Nonsense(error.to_string()),
            Err(error) => Said::Nonsense(error.to_string()),
        }
    }
}
