//! A connection, or the line of a communication module, as `OnescanPorts` has it, in `plc-shim/iec/library/vendor/onescan_ports.st`, on which the blocks of vendors stand.

use onescan_iec_run::{Application, SoftPlc, WriteError};

use super::{PortError, variable};
use onescan_stream::Port;
use onescan_stream::connection::Link;
use onescan_stream::serial::Rate;

/// Ports of TCP and of modules that a PLC can have: the length of `OnescanPorts`.
pub(super) const COUNT: usize = 8;

/// Bytes of either buffer.
const ROOM: usize = 8192;

/// Bytes that a communication module keeps.
pub(super) const MODULE_BYTES: usize = 1024;

/// Bit times of silence that end a message at a module.
const PAUSE_BITS: u64 = 12;

/// Whom a program reaches, as it says it.
#[derive(Clone, Copy)]
pub(super) enum Reached<'h> {
    /// A host and the number of its port.
    Host(&'h str, u16),
    /// A communication module, whose line has this rate.
    Module(u16, Rate),
}

impl Reached<'_> {
    /// What the program receives: members of an element of `OnescanPorts`, and literals. A module's line is always
    /// there.
    fn parameters(&self) -> Vec<(&'static str, String)> {
        let yes = || "TRUE".to_owned();
        match self {
            Self::Host(host, number) => {
                vec![("exists", yes()), ("host", format!("'{host}'")), ("number", number.to_string())]
            }
            Self::Module(number, rate) => {
                let pause_ms = (PAUSE_BITS * 1000).div_ceil(u64::from(rate.baud.get()));
                let pause = ("pause", format!("T#{pause_ms}ms"));
                vec![("exists", yes()), ("number", number.to_string()), pause, ("used", yes()), ("wanted", yes())]
            }
        }
    }
}

/// Where the members of an element of `OnescanPorts` lie in the PLC's memory.
pub(super) struct Socket {
    /// Paths of what the program receives at the set-up, with literals.
    parameters: Vec<(String, String)>,
    attempt: usize,
    served: usize,
    wanted: usize,
    link: usize,
    to_send: usize,
    arrived: usize,
    outgoing: usize,
    incoming: usize,
}

impl Socket {
    pub(super) fn bind(
        application: &Application,
        port: &str,
        index: usize,
        reached: Reached<'_>,
    ) -> Result<Self, PortError> {
        if index >= COUNT {
            return Err(PortError::Many { port: port.to_owned() });
        }
        if application.variable("OnescanPorts[0].exists").is_err() {
            let port = port.to_owned();
            return Err(match reached {
                Reached::Host(..) => PortError::NoBlock { port },
                Reached::Module(..) => PortError::NoModuleBlock { port },
            });
        }
        let found = |member: &str| variable(application, port, &format!("OnescanPorts[{index}].{member}"));
        let place = |member: &str| found(member).map(|variable| variable.offset as usize);
        let parameters = reached.parameters().into_iter();
        Ok(Self {
            parameters: parameters
                .map(|(member, literal)| (format!("OnescanPorts[{index}].{member}"), literal))
                .collect(),
            attempt: place("attempt")?,
            served: place("served")?,
            wanted: place("wanted")?,
            link: place("link")?,
            to_send: place("toSend")?,
            arrived: place("arrived")?,
            outgoing: place("outgoing")?,
            incoming: place("incoming")?,
        })
    }

    /// Notifies the program that there is such a port.
    pub(super) fn begin(&self, plc: &mut SoftPlc) -> Result<(), WriteError> {
        self.parameters.iter().try_for_each(|(path, literal)| plc.write(path, literal))
    }

    /// Before a scan: how the connection is, and what has arrived.
    pub(super) fn arrive(&self, port: &mut Port, memory: &mut [u8]) {
        if !self.is_wanted(memory) || number(memory, self.served) != number(memory, self.attempt) {
            return;
        }
        let link: i16 = match port.link() {
            Link::Closed => 0,
            Link::Connecting => 1,
            Link::Open => 2,
            Link::Ended => 3,
        };
        write(memory, self.link, &link.to_le_bytes());
        let arrived = number(memory, self.arrived) as usize;
        let bytes = port.take(ROOM.saturating_sub(arrived));
        write(memory, self.incoming + arrived.min(ROOM), &bytes);
        write(memory, self.arrived, &((arrived + bytes.len()) as u32).to_le_bytes());
    }

    /// After a scan: connects, sends and disconnects as the program wants.
    pub(super) fn depart(&self, port: &mut Port, memory: &mut [u8]) {
        let (attempt, served) = (number(memory, self.attempt), number(memory, self.served));
        let is_wanted = self.is_wanted(memory);
        if is_wanted && attempt == served {
            // what waits already is to be on its way first, so that the program sees when there is room
            if port.pending() == 0 {
                self.send(port, memory);
            }
            return;
        }
        // a program that connects again has given up what it had not sent
        if !is_wanted {
            self.send(port, memory);
        }
        port.disconnect();
        if is_wanted && port.link() == Link::Closed {
            port.connect();
            write(memory, self.served, &attempt.to_le_bytes());
        }
    }

    fn send(&self, port: &mut Port, memory: &mut [u8]) {
        let count = (number(memory, self.to_send) as usize).min(ROOM);
        if count > 0 && port.link() == Link::Open {
            if let Some(bytes) = memory.get(self.outgoing..self.outgoing + count) {
                port.send(bytes);
            }
            write(memory, self.to_send, &[0; 4]);
        }
    }

    fn is_wanted(&self, memory: &[u8]) -> bool {
        memory.get(self.wanted).is_some_and(|wanted| *wanted != 0)
    }
}

/// A place of another application, beyond the end of memory, holds 0.
fn number(memory: &[u8], at: usize) -> u32 {
    let bytes = memory.get(at..at + 4).and_then(|bytes| <[u8; 4]>::try_from(bytes).ok());
    bytes.map_or(0, u32::from_le_bytes)
}

/// Writes what lies in the memory.
fn write(memory: &mut [u8], at: usize, bytes: &[u8]) {
    if let Some(place) = memory.get_mut(at..at + bytes.len()) {
        place.copy_from_slice(bytes);
    }
}
