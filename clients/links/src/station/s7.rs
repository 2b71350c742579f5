//! Two data blocks over ISO-on-TCP: the PLC's side, as an S7 with blocks of standard access has them. What a message
//! asks for is done between two cycles.

use std::io::{Read, Write};
use std::net::SocketAddr;
use std::ops::Range;
use std::sync::Arc;

use onescan_base::threads;
use onescan_server::transport::listeners;

use super::controller::Controller;
use crate::accept::{Peer, serve_each};
use crate::gateway::exchange::Direction;
use crate::gateway::s7::Options;
use crate::gateway::s7::iso::{self, Incoming, Message};
use crate::gateway::s7::pdu::{self, Item, Request};
use crate::gateway::tcp::Layouts;
use crate::listener::bind;

/// Bytes asked for in one read of the socket.
const READ_BYTES: usize = 4096;

/// Serves the PLC's blocks at `address`, numbered as `options` says; gives the address that it got. The server ends with
/// the controller.
///
/// # Errors
/// The address cannot be listened on, or there is no thread.
pub fn serve(
    address: SocketAddr,
    controller: &Arc<Controller>,
    options: Options,
    layouts: Layouts,
) -> std::io::Result<SocketAddr> {
    let (listener, address) = bind(address)?;
    let cpu = Arc::new(Cpu { controller: Arc::clone(controller), options, layouts });
    threads::start("S7", move || {
        serve_each(&listener, listeners::S7, &cpu, || cpu.controller.is_over(), Cpu::attend);
    })?;
    Ok(address)
}

struct Cpu {
    controller: Arc<Controller>,
    options: Options,
    layouts: Layouts,
}

impl Cpu {
    /// Answers what a client asks until it goes.
    fn attend(&self, peer: &mut Peer) -> std::io::Result<()> {
        let nonsense = |error| std::io::Error::new(std::io::ErrorKind::InvalidData, error);
        let (mut incoming, mut buffer) = (Incoming::default(), [0; READ_BYTES]);
        loop {
            match peer.read(&mut buffer)? {
                0 => return Ok(()),
                count => incoming.take(&buffer[..count]),
            }
            while let Some(message) = incoming.next_message().map_err(nonsense)? {
                if self.controller.is_over() {
                    return Ok(());
                }
                peer.stay()?;
                let answer = match message {
                    Message::ConnectRequest(reference) => iso::connect_confirm(reference),
                    Message::Data(message) => match pdu::asked(&message) {
                        Some((number, request)) => iso::data(&self.answer(number, request)),
                        None => return Ok(()),
                    },
                    Message::ConnectConfirm | Message::Disconnect => return Ok(()),
                };
                peer.write_all(&answer)?;
            }
        }
    }

    fn answer(&self, number: u16, request: Request) -> Vec<u8> {
        match request {
            Request::Setup(wanted) => pdu::set_up(number, wanted.clamp(pdu::PDU_MIN, pdu::PDU_MAX)),
            Request::Read(items) if items.len() <= pdu::ITEMS_MAX => {
                let blocks = self.blocks();
                let values: Vec<_> = items.into_iter().map(|item| blocks.read(item)).collect();
                // Nobody may have more written for him than a message has.
                let bytes: usize = values.iter().flatten().map(Vec::len).sum();
                if bytes > pdu::read_max(pdu::PDU_MAX) {
                    return pdu::refused(number, pdu::NOT_AVAILABLE);
                }
                pdu::values(number, &values)
            }
            Request::Write(values) if values.len() <= pdu::ITEMS_MAX => pdu::written(number, &self.write(&values)),
            Request::Read(_) | Request::Write(_) | Request::Other => pdu::refused(number, pdu::NOT_AVAILABLE),
        }
    }

    /// Both blocks, between the same two cycles.
    fn blocks(&self) -> Blocks {
        let snapshot = self.controller.snapshot();
        let mut to_plc = vec![0; self.layouts.to_plc.size()];
        let mut from_plc = vec![0; self.layouts.from_plc.size()];
        self.layouts.to_plc.encode(snapshot.of(Direction::ToPlc), &mut to_plc);
        self.layouts.from_plc.encode(snapshot.of(Direction::FromPlc), &mut from_plc);
        Blocks { options: self.options, to_plc, from_plc }
    }

    /// Writes all values as one request; gives what became of each.
    fn write(&self, values: &[(Option<Item>, Vec<u8>)]) -> Vec<u8> {
        let mut blocks = self.blocks();
        let mut written = Vec::new();
        let mut codes = Vec::new();
        for (item, bytes) in values {
            codes.push(match blocks.write(*item, bytes) {
                Ok(range) => {
                    written.push(range);
                    pdu::DONE
                }
                Err(code) => code,
            });
        }
        let mut packed = vec![0; self.controller.wires().exchange().size(Direction::ToPlc)];
        self.layouts.to_plc.decode(&blocks.to_plc, &mut packed);
        let touched = written.iter().flat_map(|range| self.layouts.to_plc.touched(range));
        self.controller.write_points(touched.map(|(index, range)| (index, &packed[range])));
        codes
    }
}

/// The bytes of both blocks.
struct Blocks {
    options: Options,
    to_plc: Vec<u8>,
    from_plc: Vec<u8>,
}

impl Blocks {
    fn read(&self, item: Option<Item>) -> Result<Vec<u8>, u8> {
        let item = item.ok_or(pdu::NO_TYPE)?;
        let block = match item.db {
            db if db == self.options.db_to_plc => &self.to_plc,
            db if db == self.options.db_from_plc => &self.from_plc,
            _ => return Err(pdu::NO_OBJECT),
        };
        block.get(range(item)).map(<[u8]>::to_vec).ok_or(pdu::OUT_OF_RANGE)
    }

    /// Gives the bytes of the block that were written.
    fn write(&mut self, item: Option<Item>, bytes: &[u8]) -> Result<Range<usize>, u8> {
        let item = item.ok_or(pdu::NO_TYPE)?;
        if item.db == self.options.db_to_plc {
            let place = self.to_plc.get_mut(range(item)).ok_or(pdu::OUT_OF_RANGE)?;
            if place.len() != bytes.len() {
                return Err(pdu::NO_TYPE);
            }
            place.copy_from_slice(bytes);
            Ok(range(item))
        } else if item.db == self.options.db_from_plc {
            Err(pdu::NO_ACCESS)
        } else {
            Err(pdu::NO_OBJECT)
        }
    }
}

fn range(item: Item) -> Range<usize> {
    let at = item.at as usize;
    at..at + usize::from(item.len)
}
