//! Connections as of TCP: one side connects, the other takes it; bytes come in their order, in segments that may be cut
//! anywhere, and no more of them than the other side has room for.
//!
//! Each side says in its signal how often it has connected and disconnected: `link`, odd while connected. The side that
//! connects counts on; the other follows with the same number. A side whose number is the other's next even one has
//! disconnected.

use std::collections::VecDeque;

use onescan_base::SignalType;
use onescan_base::byte_line::{ByteLine, ByteLineMut};
use onescan_server::random::Random;
use serde::{Deserialize, Serialize};

/// Which side of a connection a port is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Role {
    /// It connects, as a client of TCP does.
    Connects,
    /// It takes connections, as a server of TCP does.
    Listens,
}

/// Where what is sent at once is cut: the rest goes on its way in the sender's next turn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Cuts {
    #[default]
    Nowhere,
    /// Once, behind so many bytes.
    Behind(u32),
    /// Into segments of at most so many bytes.
    Every(u32),
    /// Once, at random: by the seed of the port.
    Random,
    /// Once, of messages of one length each a byte further on than the one before: from the first uncut one to one that is
    /// cut behind its last byte but one, and again.
    Onwards,
}

/// How a connection is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Link {
    Closed,
    /// The other side has not answered yet.
    Connecting,
    /// Bytes go both ways.
    Open,
    /// The other side has ended it; bytes that have arrived before can still be received.
    Ended,
}

/// One side of a connection.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Connection {
    role: Role,
    link: Link,
    /// Connects and disconnects so far; odd while it holds the line.
    number: u32,
    listens: bool,
    /// It ends once all is sent.
    is_closing: bool,
    /// Counts of its line at which a turn sends no further, the lowest first.
    stops: VecDeque<u64>,
    random: Random,
}

impl Connection {
    pub(super) fn new(role: Role, seed: u64) -> Self {
        let (listens, random) = (true, Random::new(seed));
        Self { role, link: Link::Closed, number: 0, listens, is_closing: false, stops: VecDeque::new(), random }
    }

    pub(super) fn link(&self) -> Link {
        self.link
    }

    pub(super) fn connect(&mut self, mut line: ByteLineMut<'_>) {
        if self.role == Role::Connects && matches!(self.link, Link::Closed | Link::Ended) {
            self.number = if self.number % 2 == 1 { self.number.wrapping_add(2) } else { self.number.wrapping_add(1) };
            self.link = Link::Connecting;
            self.is_closing = false;
            self.stops.clear();
            line.set_link(self.number);
        }
    }

    pub(super) fn disconnect(&mut self) {
        self.is_closing = matches!(self.link, Link::Connecting | Link::Open | Link::Ended);
    }

    pub(super) fn listen(&mut self, listens: bool) {
        self.listens = listens;
        if !listens {
            self.disconnect();
        }
    }

    /// Looks whether the other side connects, or takes the connection; true if a connection begins.
    pub(super) fn meet(&mut self, other: &ByteLine<'_>) -> bool {
        let theirs = other.link();
        let begins = match self.role {
            // it may have taken it and ended it again since
            Role::Connects => {
                self.link == Link::Connecting && (theirs == self.number || theirs == self.number.wrapping_add(1))
            }
            Role::Listens => self.listens && theirs % 2 == 1 && theirs > self.number,
        };
        if begins {
            if self.role == Role::Listens {
                self.number = theirs;
            }
            (self.link, self.is_closing) = (Link::Open, false);
            self.stops.clear();
        }
        begins
    }

    /// Whether what is on the other's line is for this side.
    pub(super) fn reads(&self, other: &ByteLine<'_>) -> bool {
        self.link == Link::Open && (other.link() == self.number || other.link() == self.number.wrapping_add(1))
    }

    /// Looks whether the other side has ended the connection; what it sent before is read first.
    pub(super) fn end_of(&mut self, other: &ByteLine<'_>, all_read: bool) {
        if self.link == Link::Open && other.link() == self.number.wrapping_add(1) && all_read {
            self.link = Link::Ended;
            // nobody on this side has to say so
            self.is_closing |= self.role == Role::Listens;
        }
    }

    /// Notes where a message of so many bytes is cut, behind `queued` bytes that wait.
    pub(super) fn cut(&mut self, cuts: Cuts, queued: usize, message: usize, line: &[u8], ty: SignalType) {
        let Some(line) = ByteLine::of(ty, line) else { return };
        let (first, message) = (line.count() + queued as u64, message as u64);
        let mut stop = |at: u64| {
            if (1..message).contains(&at) {
                self.stops.push_back(first + at);
            }
        };
        match cuts {
            Cuts::Nowhere => {}
            Cuts::Behind(at) => stop(u64::from(at)),
            Cuts::Every(most) => {
                let most = u64::from(most.max(1));
                (1..message.div_ceil(most)).for_each(|segment| stop(segment * most));
            }
            // the bytes sent so far give the number of messages
            Cuts::Onwards => {
                let messages = first.checked_div(message).unwrap_or(0);
                stop(messages.checked_rem(message).unwrap_or(0));
            }
            Cuts::Random => {
                if let Some(at) = self.random.bits().checked_rem(message) {
                    stop(at);
                }
            }
        }
    }

    /// Sends what may be sent in this turn.
    pub(super) fn flush(
        &mut self,
        queue: &mut VecDeque<u8>,
        mut own: ByteLineMut<'_>,
        other: &ByteLine<'_>,
        read: u64,
    ) {
        own.acknowledge(read);
        if self.link == Link::Open && self.role == Role::Listens && own.line().link() != self.number {
            own.set_link(self.number);
        }
        if matches!(self.link, Link::Open) {
            let count = own.line().count();
            let under_way = count.saturating_sub(other.acknowledged());
            let mut most = u64::from(own.line().window()).saturating_sub(under_way);
            if let Some(stop) = self.stops.front().copied() {
                let until = stop.saturating_sub(count);
                if until <= most {
                    self.stops.pop_front();
                    most = until;
                }
            }
            let bytes = usize::try_from(most).unwrap_or(usize::MAX).min(queue.len());
            queue.drain(..bytes).for_each(|byte| own.put(byte));
        }
        let all_sent = queue.is_empty() || !matches!(self.link, Link::Open);
        if self.is_closing && all_sent {
            (self.link, self.is_closing) = (Link::Closed, false);
            self.stops.clear();
            queue.clear();
            if self.number % 2 == 1 {
                self.number = self.number.wrapping_add(1);
                own.set_link(self.number);
            }
        }
    }
}
