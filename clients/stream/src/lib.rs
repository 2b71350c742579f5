//! Ports at which clients send and receive bytes, on virtual time.
//!
//! Each direction of a line is a signal `BYTES[n]` ([`onescan_base::byte_line`]). A port belongs to a client: it reads one
//! such signal, writes the other, and its state is part of the client's.
//!
//! | module | subject |
//! |---|---|
//! | this file | a port, serial or of connections, and a turn of it |
//! | [`serial`] | bytes one behind the other at a baud rate |
//! | [`connection`] | connects, segments that may be cut anywhere, disconnects, as of TCP |
//!
//! In a turn that ends at `t_v` a client first lets bytes [`arrive`](Port::arrive), then receives and sends, then lets
//! them [`depart`](Port::depart).

pub mod connection;
pub mod serial;

#[cfg(test)]
mod tests;

use std::collections::VecDeque;

use onescan_base::SignalType;
use onescan_base::byte_line::{ByteLine, ByteLineMut, Sent};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use connection::{Connection, Cuts, Link, Role};
use serial::{Rate, Serial};

/// Bytes that a port keeps for its client if nothing else is set.
pub const RECEIVE_BUFFER: usize = 65_536;

/// How a port sends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    Serial(Rate),
    /// In segments, while connected.
    Connection(Role, Cuts),
}

/// A port that takes no turn, with the types of its signals.
#[derive(Clone, Debug)]
pub struct Port {
    form: Form,
    /// Of the signal that it reads, and of that which it writes.
    types: [SignalType; 2],
    /// Bytes that wait for its client at most; what comes then is lost on a serial line, and waits on a connection.
    buffer: usize,
    state: PortState,
}

/// What a port remembers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PortState {
    /// The value of the signal that it writes.
    line: Vec<u8>,
    /// Bytes of the other direction that it has taken off the line, or missed.
    read: u64,
    /// Bytes for its client.
    received: VecDeque<u8>,
    /// Bytes that wait to be sent.
    queue: VecDeque<u8>,
    losses: Losses,
    way: Way,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum Way {
    Serial(Serial),
    Connection(Connection),
}

/// Bytes that did not get through, by where they were lost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Losses {
    /// On the line, by a fault.
    pub line: u64,
    /// The client slept for longer than the window of the signal covers.
    pub window: u64,
    /// The receive buffer was full.
    pub buffer: u64,
}

/// Bytes that are not the state of a port.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("its line of bytes is of another form")]
pub struct ForeignPort;

impl Port {
    /// A port that reads and writes signals with windows of so many bytes; `seed` is for cuts at random.
    #[must_use]
    pub fn new(form: Form, [reads, writes]: [u16; 2], seed: u64) -> Self {
        let way = match form {
            Form::Serial(_) => Way::Serial(Serial::default()),
            Form::Connection(role, _) => Way::Connection(Connection::new(role, seed)),
        };
        let types = [reads, writes].map(SignalType::Bytes);
        let state = PortState {
            line: vec![0; types[1].size()],
            read: 0,
            received: VecDeque::new(),
            queue: VecDeque::new(),
            losses: Losses::default(),
            way,
        };
        Self { form, types, buffer: RECEIVE_BUFFER, state }
    }

    /// Keeps so many bytes for its client at most.
    #[must_use]
    pub fn with_buffer(mut self, bytes: usize) -> Self {
        self.buffer = bytes;
        self
    }

    /// Types of the signals that it reads and writes.
    #[must_use]
    pub fn types(&self) -> [SignalType; 2] {
        self.types
    }

    /// Whether it is serial or has connections, and how.
    #[must_use]
    pub fn form(&self) -> Form {
        self.form
    }

    /// First part of a turn that ends at `now_ns`: takes what is new on the line, and sends what was under way.
    pub fn arrive(&mut self, now_ns: u64, input: &[u8]) {
        if let (Way::Serial(serial), Form::Serial(rate)) = (&mut self.state.way, self.form) {
            let done = serial.done(rate, now_ns, self.state.queue.len());
            put(self.types[1], &mut self.state.line, self.state.queue.drain(..done));
        }
        let Some(line) = ByteLine::of(self.types[0], input) else { return };
        if let Way::Connection(connection) = &mut self.state.way {
            if connection.meet(&line) {
                // what is left of a connection before is nobody's any more
                self.state.queue.clear();
                self.state.received.clear();
                self.state.read = line.since();
            }
            if !connection.reads(&line) {
                return;
            }
        }
        self.read(&line);
        if let Way::Connection(connection) = &mut self.state.way {
            connection.end_of(&line, self.state.read == line.count());
        }
    }

    fn read(&mut self, line: &ByteLine<'_>) {
        let PortState { read, received, losses, way, .. } = &mut self.state;
        // a line that restarts, as after a write from outside
        *read = (*read).min(line.count());
        let oldest = line.oldest();
        losses.window += oldest.saturating_sub(*read);
        *read = (*read).max(oldest);
        while *read < line.count() {
            match line.at(*read) {
                Sent::Lost => losses.line += 1,
                Sent::Byte(byte) if received.len() < self.buffer => received.push_back(byte),
                Sent::Byte(_) if matches!(way, Way::Connection(_)) => break,
                Sent::Byte(_) => losses.buffer += 1,
            }
            *read += 1;
        }
    }

    /// Last part of a turn that ends at `now_ns`: begins to send what waits, and writes the signal.
    pub fn depart(&mut self, now_ns: u64, input: &[u8], output: &mut [u8]) {
        let PortState { line, queue, way, read, .. } = &mut self.state;
        match way {
            Way::Serial(serial) => serial.begin(now_ns, queue.len()),
            Way::Connection(connection) => {
                let lines = ByteLineMut::of(self.types[1], line).zip(ByteLine::of(self.types[0], input));
                if let Some((own, other)) = lines {
                    connection.flush(queue, own, &other, *read);
                }
            }
        }
        self.show(output);
    }

    /// Writes the signal as it is, as at the set-up.
    pub fn show(&self, output: &mut [u8]) {
        if output.len() == self.state.line.len() {
            output.copy_from_slice(&self.state.line);
        }
    }

    /// Bytes that have arrived and wait for the client.
    #[must_use]
    pub fn available(&self) -> usize {
        self.state.received.len()
    }

    /// The next byte that has arrived.
    pub fn receive(&mut self) -> Option<u8> {
        self.state.received.pop_front()
    }

    /// The next bytes that have arrived, at most so many.
    pub fn take(&mut self, most: usize) -> Vec<u8> {
        let count = most.min(self.state.received.len());
        self.state.received.drain(..count).collect()
    }

    /// Forgets what has arrived, and what waits to be sent.
    pub fn purge(&mut self) {
        self.state.received.clear();
        // the byte that is being sent is sent to its end
        let kept = usize::from(matches!(&self.state.way, Way::Serial(serial) if serial.is_busy()));
        self.state.queue.truncate(kept);
    }

    /// Sends bytes, one behind the other, behind those that wait. False, and nothing is sent, if there is no connection.
    pub fn send(&mut self, bytes: &[u8]) -> bool {
        if let (Way::Connection(connection), Form::Connection(_, cuts)) = (&mut self.state.way, self.form) {
            if connection.link() != Link::Open {
                return false;
            }
            connection.cut(cuts, self.state.queue.len(), bytes.len(), &self.state.line, self.types[1]);
        }
        self.state.queue.extend(bytes);
        true
    }

    /// Bytes that wait to be sent, or are being sent.
    #[must_use]
    pub fn pending(&self) -> usize {
        self.state.queue.len()
    }

    /// Begins to connect, if it is a side that connects and is not connected.
    pub fn connect(&mut self) {
        self.with_connection(Connection::connect);
    }

    /// Ends the connection once all that waits is sent.
    pub fn disconnect(&mut self) {
        self.with_connection(|connection, _| connection.disconnect());
    }

    /// Whether a side that waits for connections takes them.
    pub fn listen(&mut self, listens: bool) {
        self.with_connection(|connection, _| connection.listen(listens));
    }

    fn with_connection(&mut self, act: impl FnOnce(&mut Connection, ByteLineMut<'_>)) {
        let PortState { line, way, .. } = &mut self.state;
        if let (Way::Connection(connection), Some(line)) = (way, ByteLineMut::of(self.types[1], line)) {
            act(connection, line);
        }
    }

    /// How its connection is; a serial line is always open.
    #[must_use]
    pub fn link(&self) -> Link {
        match &self.state.way {
            Way::Serial(_) => Link::Open,
            Way::Connection(connection) => connection.link(),
        }
    }

    /// Bytes that did not get through so far.
    #[must_use]
    pub fn losses(&self) -> Losses {
        self.state.losses
    }

    /// What it remembers.
    #[must_use]
    pub fn state(&self) -> &PortState {
        &self.state
    }

    /// Whether a state is one of such a port.
    ///
    /// # Errors
    /// It is of another form, or for a signal of another length.
    pub fn check(&self, state: &PortState) -> Result<(), ForeignPort> {
        let same_way = std::mem::discriminant(&state.way) == std::mem::discriminant(&self.state.way);
        let fits = same_way && state.line.len() == self.types[1].size() && state.received.len() <= self.buffer;
        if fits { Ok(()) } else { Err(ForeignPort) }
    }

    /// Goes on from a state.
    ///
    /// # Errors
    /// See [`check`](Self::check). Nothing has changed then.
    pub fn restore(&mut self, state: PortState) -> Result<(), ForeignPort> {
        self.check(&state)?;
        self.state = state;
        Ok(())
    }
}

fn put(ty: SignalType, value: &mut [u8], bytes: impl Iterator<Item = u8>) {
    if let Some(mut line) = ByteLineMut::of(ty, value) {
        bytes.for_each(|byte| line.put(byte));
    }
}
