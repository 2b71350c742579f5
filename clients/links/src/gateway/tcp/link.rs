//! The gateway's side: blocking, as a step waits for exactly one thing at a time.

use std::io::{ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::{Duration, Instant};

use super::codec::{BlockCodec, StreamFault};
use super::layout::Layouts;
use super::plc_listener::PlcListener;
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
    FromPlc(SocketAddr, Option<PlcListener>),
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
    /// True once a whole block has come over this connection.
    has_spoken: bool,
    /// True if the PLC is to speak first, so that one which says nothing is none.
    must_speak: bool,
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
            has_spoken: false,
            must_speak: false,
            timeout,
        }
    }

    /// The same for a PLC that sends its block by itself: whoever connects in its place and sends no block for as long as a
    /// connection may take is left, and the next one is let in.
    pub fn expecting_blocks(self) -> Self {
        Self { must_speak: matches!(self.way, Way::FromPlc(..)), ..self }
    }

    /// True where anybody may have connected in the PLC's place, and has sent no block.
    pub fn is_a_strangers(&self) -> bool {
        matches!(self.way, Way::FromPlc(..)) && !self.has_spoken
    }

    /// A whole block has come: whoever connected is the PLC.
    fn hear(&mut self) {
        if !std::mem::replace(&mut self.has_spoken, true) {
            self.way.heard();
        }
    }

    /// Waits for the first block of the PLC, which is left for whoever reads it.
    fn wait_for_block(&mut self) -> Result<(), LinkFault> {
        let deadline = Instant::now() + self.timeout;
        while !self.codec.has_block() {
            let left = deadline.saturating_duration_since(Instant::now());
            // A socket takes no time-out of 0.
            if left.is_zero() || !self.receive(left.max(Duration::from_millis(1)))? {
                self.stream = None;
                return Err(self.no_block(self.timeout));
            }
        }
        self.hear();
        Ok(())
    }

    /// Whoever connected has sent no block within this time, and is left.
    pub fn no_block(&self, within: Duration) -> LinkFault {
        let sent = match self.codec.partial() {
            Some(partial) => format!("{partial}: is the layout the same on both sides?"),
            None => "no block".to_owned(),
        };
        LinkFault::Lost(format!("who connected is let go; within {within:?} there came {sent}"))
    }

    /// The next block, in the order in which they come; false if none comes for as long as `patience`.
    ///
    /// # Errors
    /// As [`Link::read`].
    pub fn next_block(&mut self, patience: Duration, from_plc: &mut [u8]) -> Result<bool, LinkFault> {
        loop {
            if let Some(block) = self.codec.next_block().map_err(link_fault)? {
                self.hear();
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
                Ok(Some(_)) => {
                    self.hear();
                    count += 1;
                }
                Ok(None) => match self.receive_now() {
                    Ok(true) => {}
                    Ok(false) => break Ok(count),
                    Err(fault) => break Err(fault),
                },
                Err(fault) => break Err(link_fault(fault)),
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
                    self.codec.end().map_err(link_fault)?;
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
fn link_fault(fault: StreamFault) -> LinkFault {
    match fault {
        StreamFault::Cut(_) => LinkFault::Lost(fault.to_string()),
        StreamFault::Stray { .. } => LinkFault::Nonsense(fault.to_string()),
    }
}

impl Way {
    /// A block has come from the PLC.
    fn heard(&self) {
        if let Self::FromPlc(_, Some(plc_listener)) = self {
            plc_listener.heard();
        }
    }

    fn connect(&mut self, timeout: Duration) -> Result<TcpStream, LinkFault> {
        let (address, plc_listener) = match self {
            Self::ToPlc(address) => {
                let url = || format!("tcp://{address}");
                let connected = socket::connect(&address[..], timeout);
                return connected.map_err(|reason| LinkFault::Unreachable { url: url(), reason });
            }
            Self::FromPlc(address, plc_listener) => (*address, plc_listener),
        };
        let plc_listener = match plc_listener {
            Some(plc_listener) => {
                plc_listener.leave();
                plc_listener
            }
            None => plc_listener.insert(PlcListener::open(address).map_err(|error| LinkFault::Listen {
                url: format!("tcp-listen://{address}"),
                reason: error.to_string(),
            })?),
        };
        let url = || format!("tcp-listen://{}", plc_listener.address());
        let stream = plc_listener.enter(KNOCK).ok_or_else(|| LinkFault::NobodyCame { url: url(), within: KNOCK })?;
        socket::prepare(&stream, timeout).map_err(|error| lost(&error))?;
        Ok(stream)
    }
}

impl Link for TcpLink {
    fn connect(&mut self) -> Result<(), LinkFault> {
        // The old connection goes first: a PLC may have room for one.
        self.stream = None;
        self.codec.clear();
        (self.patience, self.is_silent, self.has_spoken) = (None, false, false);
        self.stream = Some(self.way.connect(self.timeout)?);
        if self.must_speak { self.wait_for_block() } else { Ok(()) }
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
            if let Some(block) = self.codec.newest().map_err(link_fault)? {
                self.hear();
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

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use onescan_server::signal::{Port, SignalName, SignalType};

    use super::*;
    use crate::gateway::exchange::{Exchange, Feed, Words};
    use crate::gateway::tcp::Declaration;

    const SOON: Duration = Duration::from_millis(20);
    const LATER: Duration = Duration::from_mins(1);

    /// A link with a block of eight bytes each way, and the PLC that has connected to it.
    fn connected() -> (TcpLink, TcpStream) {
        let feed = |name: &str| Feed::whole(&Port { name: SignalName::new(name).unwrap(), ty: SignalType::LINT }, None);
        let exchange = Exchange::new(&[feed("a")], &[feed("b")], Words::Absent, &BTreeMap::new());
        let layouts = Layouts::new(&Declaration::default(), &exchange).unwrap();
        let mut link = TcpLink::listening(SocketAddr::from(([127, 0, 0, 1], 0)), layouts, LATER);
        assert!(matches!(link.connect(), Err(LinkFault::NobodyCame { .. })));
        let Way::FromPlc(_, Some(plc_listener)) = &link.way else { panic!("it listens") };
        let plc = TcpStream::connect(plc_listener.address()).unwrap();
        plc.set_nodelay(true).unwrap();
        while link.connect().is_err() {}
        (link, plc)
    }

    #[test]
    fn silence_in_mid_block_is_named() {
        let (mut link, mut plc) = connected();
        let mut packed = [0; 8];
        assert_eq!((link.read(SOON, &mut packed), link.broken_off()), (Ok(false), None));
        plc.write_all(&[0; 5]).unwrap();
        // What has come is not silence; what comes after it is.
        while link.broken_off().is_none() {
            assert_eq!(link.read(SOON, &mut packed), Ok(false));
        }
        assert_eq!(
            link.broken_off().map(|partial| partial.to_string()).as_deref(),
            Some("5 of the 8 bytes of a block")
        );
        drop(plc);
        let closed = "closed after 5 of the 8 bytes of a block: is the layout the same on both sides?";
        assert_eq!(link.read(LATER, &mut packed), Err(LinkFault::Lost(closed.to_owned())));
    }

    /// Who sends something that is not a block is not the PLC, and does not keep it out.
    #[test]
    fn half_a_block_is_nobodys() {
        let (link, mut stranger) = connected();
        let mut link = TcpLink { timeout: SOON, ..link.expecting_blocks() };
        let Way::FromPlc(_, Some(plc_listener)) = &link.way else { panic!("it listens") };
        let address = plc_listener.address();
        let mut again = TcpStream::connect(address).unwrap();
        again.write_all(&[0; 5]).unwrap();
        let fault = loop {
            match link.connect() {
                Err(LinkFault::NobodyCame { .. }) => {}
                Err(fault) => break fault.to_string(),
                Ok(()) => panic!("it has sent no block"),
            }
        };
        assert!(fault.contains("5 of the 8 bytes of a block: is the layout"), "{fault}");
        assert_eq!(stranger.read(&mut [0]).unwrap_or(0), 0, "it is closed");
        let mut plc = TcpStream::connect(address).unwrap();
        plc.write_all(&[7; 8]).unwrap();
        link.timeout = LATER;
        while link.connect().is_err() {}
        let mut packed = [0; 8];
        assert_eq!((link.read(LATER, &mut packed), packed), (Ok(true), [7; 8]), "its first block is read");
        let mut late = TcpStream::connect(address).unwrap();
        assert_eq!(late.read(&mut [0]).unwrap_or(0), 0, "the PLC is there");
    }

    #[test]
    fn blocks_that_came_before_are_let_go_and_counted() {
        let (mut link, mut plc) = connected();
        let mut packed = [0; 8];
        let block = |number: u8| [0, 0, 0, 0, 0, 0, 0, number];
        plc.write_all(&[block(1), block(2), block(3)].concat()).unwrap();
        assert_eq!((link.next_block(LATER, &mut packed), packed[0]), (Ok(true), 1));
        let mut count = 0;
        while count < 2 {
            count += link.discard().unwrap();
        }
        assert_eq!(link.next_block(SOON, &mut packed), Ok(false));
        plc.write_all(&[block(4), block(5)].concat()).unwrap();
        assert_eq!((link.next_block(LATER, &mut packed), packed[0]), (Ok(true), 4));
        assert_eq!((link.next_block(LATER, &mut packed), packed[0]), (Ok(true), 5));
        link.write(&packed).unwrap();
        let mut sent = [0; 8];
        plc.read_exact(&mut sent).unwrap();
        assert_eq!(sent, block(5));
    }
}
