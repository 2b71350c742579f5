//! The gateway's side: blocking, as a step waits for exactly one thing at a time.

use std::io::{ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::Duration;

use super::codec::{BlockCodec, StreamFault};
use super::door::Door;
use super::layout::Layouts;
use crate::gateway::fault::{LinkFault, Partial};
use crate::gateway::link::Link;
use crate::gateway::socket;

/// Bytes asked for in one read.
const READ_BYTES: usize = 16 * 1024;
/// How long one attempt waits for a PLC to connect.
const KNOCK: Duration = Duration::from_millis(200);

/// Who connects to whom.
enum Way {
    /// The gateway connects to the PLC at this host and port.
    ToPlc(String),
    /// The PLC connects to the gateway, which listens here; from the first attempt on it does.
    FromPlc(SocketAddr, Option<Door>),
}

/// Data blocks over TCP.
pub struct TcpLink {
    way: Way,
    layouts: Layouts,
    stream: Option<TcpStream>,
    codec: BlockCodec,
    block: Vec<u8>,
    buffer: Vec<u8>,
    patience: Option<Duration>,
    /// True if nothing came when it was last waited for.
    is_silent: bool,
    /// For the connection to come about, and for a block to be taken.
    timeout: Duration,
}

impl TcpLink {
    /// A link to `address`, a host and a port.
    pub fn new(address: &str, layouts: Layouts, timeout: Duration) -> Self {
        Self::over(Way::ToPlc(address.to_owned()), layouts, timeout)
    }

    /// A link from a PLC that connects to `address`.
    pub fn listening(address: SocketAddr, layouts: Layouts, timeout: Duration) -> Self {
        Self::over(Way::FromPlc(address, None), layouts, timeout)
    }

    fn over(way: Way, layouts: Layouts, timeout: Duration) -> Self {
        Self {
            way,
            codec: BlockCodec::new(&layouts.from_plc),
            block: vec![0; layouts.to_plc.size()],
            layouts,
            stream: None,
            buffer: vec![0; READ_BYTES],
            patience: None,
            is_silent: false,
            timeout,
        }
    }

    /// The next block, in the order in which they come; false if none comes for as long as `patience`.
    ///
    /// # Errors
    /// As [`Link::read`].
    pub fn next_block(&mut self, patience: Duration, from_plc: &mut [u8]) -> Result<bool, LinkFault> {
        loop {
            if let Some(block) = self.codec.next_block().map_err(told)? {
                self.layouts.from_plc.decode(&block, from_plc);
                return Ok(true);
            }
            if !self.receive(patience)? {
                return Ok(false);
            }
        }
    }

    /// Lets go of all blocks that have come, and gives their number.
    ///
    /// # Errors
    /// As [`Link::read`].
    pub fn discard(&mut self) -> Result<u64, LinkFault> {
        let stream = self.stream.as_ref().ok_or_else(LinkFault::not_connected)?;
        stream.set_nonblocking(true).map_err(|error| lost(&error))?;
        let mut count = 0;
        let all = loop {
            match self.codec.next_block() {
                Ok(Some(_)) => count += 1,
                Ok(None) => match self.receive_now() {
                    Ok(true) => {}
                    Ok(false) => break Ok(count),
                    Err(fault) => break Err(fault),
                },
                Err(fault) => break Err(told(fault)),
            }
        };
        let stream = self.stream.as_ref().ok_or_else(LinkFault::not_connected)?;
        stream.set_nonblocking(false).map_err(|error| lost(&error))?;
        all
    }

    /// Bytes from the PLC, waited for as long as `patience`; false if there are none.
    fn receive(&mut self, patience: Duration) -> Result<bool, LinkFault> {
        let stream = self.stream.as_ref().ok_or_else(LinkFault::not_connected)?;
        if self.patience != Some(patience) {
            stream.set_read_timeout(Some(patience)).map_err(|error| lost(&error))?;
            self.patience = Some(patience);
        }
        self.receive_now()
    }

    fn receive_now(&mut self) -> Result<bool, LinkFault> {
        let stream = self.stream.as_mut().ok_or_else(LinkFault::not_connected)?;
        loop {
            match stream.read(&mut self.buffer) {
                Ok(0) => {
                    self.codec.end().map_err(told)?;
                    return Err(LinkFault::Lost("closed by the PLC".to_owned()));
                }
                Ok(count) => {
                    self.codec.take(&self.buffer[..count]);
                    self.is_silent = false;
                    return Ok(true);
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {
                    self.is_silent = true;
                    return Ok(false);
                }
                Err(error) => return Err(lost(&error)),
            }
        }
    }
}

fn lost(error: &std::io::Error) -> LinkFault {
    LinkFault::Lost(error.to_string())
}

/// A connection that ends in mid-block may come back; one that is cut wrongly is not the PLC's word.
fn told(fault: StreamFault) -> LinkFault {
    match fault {
        StreamFault::Cut(_) => LinkFault::Lost(fault.to_string()),
        StreamFault::Stray { .. } => LinkFault::Nonsense(fault.to_string()),
    }
}

impl Way {
    fn connect(&mut self, timeout: Duration) -> Result<TcpStream, LinkFault> {
        let (address, door) = match self {
            Self::ToPlc(address) => {
                let url = || format!("tcp://{address}");
                let connected = socket::connect(&address[..], timeout);
                return connected.map_err(|reason| LinkFault::Unreachable { url: url(), reason });
            }
            Self::FromPlc(address, door) => (*address, door),
        };
        let door = match door {
            Some(door) => {
                door.leave();
                door
            }
            None => door.insert(Door::open(address).map_err(|error| LinkFault::Listen {
                url: format!("tcp-listen://{address}"),
                reason: error.to_string(),
            })?),
        };
        let url = || format!("tcp-listen://{}", door.address());
        let stream = door.enter(KNOCK).ok_or_else(|| LinkFault::NobodyCame { url: url(), within: KNOCK })?;
        socket::prepare(&stream, timeout).map_err(|error| lost(&error))?;
        Ok(stream)
    }
}

impl Link for TcpLink {
    fn connect(&mut self) -> Result<(), LinkFault> {
        // The old connection goes first: a PLC may have room for one.
        self.stream = None;
        self.codec.clear();
        (self.patience, self.is_silent) = (None, false);
        self.stream = Some(self.way.connect(self.timeout)?);
        Ok(())
    }

    fn write(&mut self, to_plc: &[u8]) -> Result<(), LinkFault> {
        let stream = self.stream.as_mut().ok_or_else(LinkFault::not_connected)?;
        self.layouts.to_plc.encode(to_plc, &mut self.block);
        stream.write_all(&self.block).map_err(|error| lost(&error))
    }

    fn is_polled(&self) -> bool {
        false
    }

    fn read(&mut self, patience: Duration, from_plc: &mut [u8]) -> Result<bool, LinkFault> {
        loop {
            if let Some(block) = self.codec.newest().map_err(told)? {
                self.layouts.from_plc.decode(&block, from_plc);
                return Ok(true);
            }
            if !self.receive(patience)? {
                return Ok(false);
            }
        }
    }

    fn broken_off(&self) -> Option<Partial> {
        self.codec.partial().filter(|_| self.is_silent)
    }
}
