//! Requests and their responses, one at a time.

use std::io::Write;
use std::net::{IpAddr, Ipv4Addr, TcpStream};
use std::time::Duration;

use super::command::{self, meaning};
use super::frame::{AmsAddress, Bytes, Frame, Kind, NetId};
use super::options::Options;
use crate::gateway::fault::LinkFault;
use crate::gateway::socket::{connect, host_and_port};

/// Where AMS routers listen.
const TCP_PORT: u16 = 48_898;

/// Why a request was not answered with what was asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Refusal {
    /// The device or a router says no, with this return code.
    Code(u32),
    Link(LinkFault),
}

impl From<LinkFault> for Refusal {
    fn from(fault: LinkFault) -> Self {
        Self::Link(fault)
    }
}

impl Refusal {
    /// As a fault of the link, if nobody knows better.
    pub(super) fn into_fault(self) -> LinkFault {
        match self {
            Self::Code(code) => LinkFault::Lost(described(code)),
            Self::Link(fault) => fault,
        }
    }
}

/// A return code for people.
pub(super) fn described(code: u32) -> String {
    format!("{} (ADS {code:#x})", meaning(code))
}

/// A connection to a device's router.
#[derive(Debug)]
pub(super) struct Connection {
    stream: TcpStream,
    target: AmsAddress,
    source: AmsAddress,
    invoke_id: u32,
    timeout: Duration,
}

impl Connection {
    /// Connects to `address`, a host and perhaps a port.
    pub(super) fn open(address: &str, options: &Options, timeout: Duration) -> Result<Self, LinkFault> {
        let unreachable = |reason: String| LinkFault::Unreachable { url: format!("ads://{address}"), reason };
        let stream = host_and_port(address, TCP_PORT).and_then(|at| connect(at, timeout)).map_err(unreachable)?;
        stream.set_read_timeout(Some(timeout)).map_err(|error| unreachable(error.to_string()))?;
        let ends = stream.local_addr().and_then(|local| Ok((local.ip(), stream.peer_addr()?.ip())));
        let (local, peer) = ends.map_err(|error| unreachable(error.to_string()))?;
        let target = AmsAddress { net_id: options.net_id.unwrap_or_else(|| usual(peer)), port: options.port };
        let net_id = options.source_net_id.unwrap_or_else(|| usual(local));
        let source = AmsAddress { net_id, port: options.source_port };
        Ok(Self { stream, target, source, invoke_id: 0, timeout })
    }

    /// Who this side says that it is.
    pub(super) fn source(&self) -> AmsAddress {
        self.source
    }

    /// Sends a request and waits for its response; gives what is behind the return code.
    fn call(&mut self, command: u16, parts: &[&[u8]]) -> Result<Vec<u8>, Refusal> {
        self.invoke_id = self.invoke_id.wrapping_add(1);
        let (target, source, invoke_id) = (self.target, self.source, self.invoke_id);
        let request = Frame { target, source, command, kind: Kind::Request, error: 0, invoke_id, data: parts.concat() };
        let timeout = self.timeout;
        let lost = |error: std::io::Error| match error.kind() {
            std::io::ErrorKind::InvalidData => LinkFault::Nonsense(error.to_string()),
            std::io::ErrorKind::WouldBlock | std::io::ErrorKind::TimedOut => {
                LinkFault::Lost(format!("no answer within {timeout:?}"))
            }
            _ => LinkFault::Lost(error.to_string()),
        };
        self.stream.write_all(&request.encoded()).map_err(lost)?;
        let response = loop {
            let frame = Frame::read(&mut self.stream).map_err(lost)?;
            let frame = frame.ok_or_else(|| LinkFault::Lost("closed by the PLC or its router".to_owned()))?;
            // What was asked before a time-out may be answered late; a router may speak to others here.
            if frame.target == self.source && frame.invoke_id == invoke_id {
                break frame;
            }
        };
        if response.kind != Kind::Response || response.command != command {
            return Err(nonsense(format!("command {} for {command}", response.command)));
        }
        if response.error != 0 {
            return Err(Refusal::Code(response.error));
        }
        let mut data = Bytes(&response.data);
        match data.u32() {
            Some(0) => Ok(data.0.to_vec()),
            Some(code) => Err(Refusal::Code(code)),
            None => Err(nonsense("an answer without a return code".to_owned())),
        }
    }

    /// The device's state.
    pub(super) fn state(&mut self) -> Result<u16, Refusal> {
        let answer = self.call(command::READ_STATE, &[])?;
        Bytes(&answer).u16().ok_or_else(|| nonsense("a state that is cut short".to_owned()))
    }

    /// Reads at most `length` bytes.
    pub(super) fn read(&mut self, group: u32, offset: u32, length: u32) -> Result<Vec<u8>, Refusal> {
        let head = numbers(&[group, offset, length]);
        let answer = self.call(command::READ, &[&head])?;
        counted(&answer, length)
    }

    /// Writes `written`, then reads at most `length` bytes.
    pub(super) fn read_write(
        &mut self,
        group: u32,
        offset: u32,
        length: u32,
        written: &[u8],
    ) -> Result<Vec<u8>, Refusal> {
        let head = numbers(&[group, offset, length, written.len() as u32]);
        let answer = self.call(command::READ_WRITE, &[&head, written])?;
        counted(&answer, length)
    }
}

/// Little-endian numbers, one behind the other.
pub(super) fn numbers(numbers: &[u32]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

pub(super) fn nonsense(text: String) -> Refusal {
    Refusal::Link(LinkFault::Nonsense(text))
}

/// What stands behind its own length.
fn counted(answer: &[u8], length: u32) -> Result<Vec<u8>, Refusal> {
    let mut bytes = Bytes(answer);
    match bytes.u32() {
        Some(count) if count as usize == bytes.0.len() && count <= length => Ok(bytes.0.to_vec()),
        _ => Err(nonsense(format!("{} bytes for {length}", answer.len()))),
    }
}

/// The `NetId` that a device at this address has if nobody has changed it.
fn usual(address: IpAddr) -> NetId {
    match address {
        IpAddr::V4(address) => NetId::of(address),
        IpAddr::V6(address) => NetId::of(address.to_ipv4().unwrap_or(Ipv4Addr::LOCALHOST)),
    }
}
