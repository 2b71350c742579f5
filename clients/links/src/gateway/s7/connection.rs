//! Requests and their answers, one at a time.

use std::io::{ErrorKind, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use super::iso::{self, Incoming, Message};
use super::options::Options;
use super::pdu::{self, Answer, Item};
use crate::gateway::fault::LinkFault;
use crate::gateway::socket::{connect, host_and_port};

/// Bytes asked for in one read of the socket.
const READ_BYTES: usize = 4096;

/// Why a request was not answered with what was asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Refusal {
    /// The PLC says no to all of it.
    Request(u16),
    /// The PLC says no to a value.
    Value(u8),
    Link(LinkFault),
}

impl From<LinkFault> for Refusal {
    fn from(fault: LinkFault) -> Self {
        Self::Link(fault)
    }
}

/// A connection to a CPU, over which messages of an agreed length go.
#[derive(Debug)]
pub(super) struct Connection {
    stream: TcpStream,
    incoming: Incoming,
    number: u16,
    pdu: u16,
    timeout: Duration,
}

impl Connection {
    /// Connects to `address`, a host and perhaps a port.
    ///
    /// # Errors
    /// Nobody is there, or who is there does not let this client in.
    pub(super) fn open(address: &str, options: Options, timeout: Duration) -> Result<Self, LinkFault> {
        let url = || format!("s7://{address}");
        let unreachable = |reason: String| LinkFault::Unreachable { url: url(), reason };
        let stream = host_and_port(address, iso::PORT).and_then(|at| connect(at, timeout)).map_err(unreachable)?;
        stream.set_read_timeout(Some(timeout)).map_err(|error| unreachable(error.to_string()))?;
        let mut connection = Self { stream, incoming: Incoming::default(), number: 0, pdu: pdu::PDU_MIN, timeout };
        // A CPU that has no connection left closes it as one does that is not in this slot.
        let unanswered = |fault: LinkFault| match fault {
            LinkFault::Lost(reason) => unreachable(format!("{reason}; are rack and slot right?")),
            fault => fault,
        };
        let refused =
            |what: &str| LinkFault::Refused { url: url(), reason: format!("{what}: are rack and slot right?") };
        connection.send(&iso::connect_request(options.tsap())).map_err(unanswered)?;
        if connection.message().map_err(unanswered)? != Message::ConnectConfirm {
            return Err(refused("it does not take the connection"));
        }
        match connection.call(|number| pdu::setup(number, pdu::PDU_MAX)) {
            // No S7 has a shorter message, and no answer may be longer than what was asked for.
            Ok(Answer::Setup(pdu)) if pdu >= pdu::PDU_MIN => connection.pdu = pdu.min(pdu::PDU_MAX),
            Ok(answer) => return Err(LinkFault::Nonsense(format!("no length of messages is agreed on: {answer:?}"))),
            Err(Refusal::Link(fault)) => return Err(unanswered(fault)),
            Err(Refusal::Request(code)) => {
                return Err(refused(&format!("it does not take the session (S7 {code:#06x})")));
            }
            Err(Refusal::Value(code)) => {
                return Err(refused(&format!("it does not take the session (S7 {code:#04x})")));
            }
        }
        Ok(connection)
    }

    /// The most bytes of a message.
    pub(super) fn pdu(&self) -> u16 {
        self.pdu
    }

    fn send(&mut self, telegram: &[u8]) -> Result<(), LinkFault> {
        self.stream.write_all(telegram).map_err(|error| lost(&error, self.timeout))
    }

    /// The next whole message, however many segments it comes in.
    fn message(&mut self) -> Result<Message, LinkFault> {
        let begun = Instant::now();
        let mut buffer = [0; READ_BYTES];
        loop {
            if let Some(message) = self.incoming.next_message().map_err(|bad| LinkFault::Nonsense(bad.to_string()))? {
                return Ok(message);
            }
            match self.stream.read(&mut buffer) {
                Ok(0) => return Err(LinkFault::Lost("closed by the PLC".to_owned())),
                Ok(count) => self.incoming.take(&buffer[..count]),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(lost(&error, self.timeout)),
            }
            // An answer may come in parts, but not for ever.
            if begun.elapsed() > self.timeout {
                return Err(late(self.timeout));
            }
        }
    }

    /// Sends a request and waits for its answer.
    fn call(&mut self, request: impl FnOnce(u16) -> Vec<u8>) -> Result<Answer, Refusal> {
        self.number = self.number.wrapping_add(1);
        let request = iso::data(&request(self.number));
        self.send(&request)?;
        let begun = Instant::now();
        loop {
            let message = match self.message()? {
                Message::Data(message) => message,
                Message::Disconnect => return Err(LinkFault::Lost("closed by the PLC".to_owned()).into()),
                other => return Err(nonsense(format!("{other:?} for an answer"))),
            };
            match pdu::answer(&message) {
                // What has been answered may be answered twice.
                Some((number, _)) if number != self.number && begun.elapsed() < self.timeout => {}
                Some((number, _)) if number != self.number => return Err(late(self.timeout).into()),
                Some((_, Some(Answer::Refused(code)))) => return Err(Refusal::Request(code)),
                Some((_, Some(Answer::NotRead(code)))) => return Err(Refusal::Value(code)),
                Some((_, Some(answer))) => return Ok(answer),
                Some((_, None)) | None => {
                    return Err(nonsense(format!("{} bytes that are not an answer", message.len())));
                }
            }
        }
    }

    /// Reads the first bytes of a data block, in as many messages as they need.
    ///
    /// # Errors
    /// See [`Refusal`].
    pub(super) fn read(&mut self, db: u16, bytes: &mut [u8]) -> Result<(), Refusal> {
        let at_most = pdu::read_max(self.pdu);
        for (index, part) in bytes.chunks_mut(at_most).enumerate() {
            let item = Item { db, at: (index * at_most) as u32, len: part.len() as u16 };
            match self.call(|number| pdu::read(number, item))? {
                Answer::Bytes(read) if read.len() == part.len() => part.copy_from_slice(&read),
                Answer::Bytes(read) => return Err(nonsense(format!("{} bytes for {}", read.len(), part.len()))),
                answer => return Err(nonsense(format!("{answer:?} for values"))),
            }
        }
        Ok(())
    }

    /// Writes bytes of a data block in one message; see [`pdu::write_max`].
    ///
    /// # Errors
    /// See [`Refusal`].
    pub(super) fn write(&mut self, item: Item, bytes: &[u8]) -> Result<(), Refusal> {
        match self.call(|number| pdu::write(number, item, bytes))? {
            Answer::Written(codes) if codes == [pdu::DONE] => Ok(()),
            Answer::Written(codes) if codes.len() == 1 => Err(Refusal::Value(codes[0])),
            answer => Err(nonsense(format!("{answer:?} for a written value"))),
        }
    }
}

fn late(timeout: Duration) -> LinkFault {
    LinkFault::Lost(format!("no answer within {timeout:?}"))
}

fn lost(error: &std::io::Error, timeout: Duration) -> LinkFault {
    match error.kind() {
        ErrorKind::WouldBlock | ErrorKind::TimedOut => late(timeout),
        ErrorKind::ConnectionReset | ErrorKind::BrokenPipe => LinkFault::Lost("closed by the PLC".to_owned()),
        _ => LinkFault::Lost(error.to_string()),
    }
}

fn nonsense(text: String) -> Refusal {
    Refusal::Link(LinkFault::Nonsense(text))
}
