//! The gateway's side: two blocks, as few requests as the PDU allows.
//!
//! A PLC does what one message asks for between two scans, but a block that is longer than its PDU takes several. So
//! of a long block the grant is written last and alone, and it is read twice, the words taken from the first time and
//! the outputs from the second. Of a block with fields of others, only the bytes in which points lie are written.

use std::ops::Range;
use std::time::Duration;

use super::connection::{Connection, Refusal};
use super::options::Options;
use super::pdu::{self, Item};
use crate::gateway::exchange::{Direction, Exchange};
use crate::gateway::fault::{LinkFault, MappingFault};
use crate::gateway::link::Link;
use crate::gateway::tcp::Layouts;

/// Two data blocks of an S7.
pub struct S7Link {
    address: String,
    options: Options,
    exchange: Exchange,
    layouts: Layouts,
    /// Bytes of the block to the PLC that are the gateway's.
    owned: Vec<Range<usize>>,
    /// The same without those of the grant.
    before: Vec<Range<usize>>,
    /// Those of the grant.
    grant: Range<usize>,
    connection: Option<Connection>,
    block: Vec<u8>,
    timeout: Duration,
}

impl S7Link {
    /// A link to `address`, a host and perhaps a port.
    ///
    /// # Errors
    /// A point in parts: what is written in several messages is not written at once.
    pub fn new(
        address: &str,
        options: Options,
        exchange: &Exchange,
        layouts: Layouts,
        timeout: Duration,
    ) -> Result<Self, MappingFault> {
        if let Some(point) = layouts.in_parts(exchange) {
            let message = format!("`{}` is in parts, and a data block of an S7 is not written at once", point.label());
            let help = "give it one offset, or use `tcp` or `tcp-listen`, where a block travels whole";
            return Err(MappingFault::new(&point.name, message).with_help(Some(help.to_owned())));
        }
        let (owned, grant) = (layouts.to_plc.owned(), layouts.to_plc.last());
        Ok(Self {
            address: address.to_owned(),
            options,
            exchange: exchange.clone(),
            before: without(&owned, &grant),
            owned,
            grant,
            layouts,
            connection: None,
            block: Vec::new(),
            timeout,
        })
    }

    fn blank(&mut self, size: usize) {
        self.block.clear();
        self.block.resize(size, 0);
    }

    fn read_block(&mut self, packed: &mut [u8]) -> Result<(), LinkFault> {
        let (db, size) = (self.options.db_from_plc, self.layouts.from_plc.size());
        self.blank(size);
        let connection = self.connection.as_mut().ok_or_else(LinkFault::not_connected)?;
        connection.read(db, &mut self.block).map_err(|refusal| fault(refusal, db, size))?;
        if let Some(stray) = self.layouts.from_plc.stray(&self.block) {
            return Err(LinkFault::Nonsense(format!("{stray} of DB{db}: the layouts differ")));
        }
        self.layouts.from_plc.decode(&self.block, packed);
        Ok(())
    }

    /// True if what is read comes in one message.
    fn is_read_at_once(&self) -> bool {
        let pdu = self.connection.as_ref().map_or(pdu::PDU_MIN, Connection::pdu);
        self.layouts.from_plc.size() <= pdu::read_max(pdu)
    }
}

/// The bytes of a block in these places, as many to a message as it has room for.
fn messages<'b>(pdu: u16, db: u16, places: &[Range<usize>], block: &'b [u8]) -> Vec<(Item, &'b [u8])> {
    let at_most = pdu::write_max(pdu) & !1;
    let parts = places.iter().flat_map(|place| {
        block[place.clone()].chunks(at_most).enumerate().map(move |(index, bytes)| {
            let item = Item { db, at: (place.start + index * at_most) as u32, len: bytes.len() as u16 };
            (item, bytes)
        })
    });
    parts.collect()
}

/// These places without one of them.
fn without(places: &[Range<usize>], one: &Range<usize>) -> Vec<Range<usize>> {
    let parts = places.iter().flat_map(|place| {
        let (end, start) = (place.end.min(one.start), place.start.max(one.end));
        [place.start..end, start..place.end]
    });
    parts.filter(|part| !part.is_empty()).collect()
}

fn fault(refusal: Refusal, db: u16, size: usize) -> LinkFault {
    let block = |what: &str, help: &str| -> LinkFault {
        let message = format!("data block DB{db} {what}");
        MappingFault::new(&format!("DB{db}"), message).with_help(Some(help.to_owned())).into()
    };
    match refusal {
        Refusal::Link(fault) => fault,
        Refusal::Value(pdu::NO_OBJECT) => block("is not there", "its number is in `[clients.NAME.gateway.s7]`"),
        Refusal::Value(pdu::OUT_OF_RANGE) => {
            block(&format!("has no {size} bytes"), "compare it with `layout`, and take `optimized block access` off")
        }
        Refusal::Value(code) => {
            let what = format!("cannot be accessed (S7 {code:#04x})");
            block(&what, "take `optimized block access` off, and permit access with PUT/GET communication")
        }
        Refusal::Request(pdu::NOT_AVAILABLE) => {
            let help = "permit access with PUT/GET communication in the CPU's properties";
            block("cannot be accessed: the PLC does not do this", help)
        }
        Refusal::Request(code) => LinkFault::Nonsense(format!("error {code:#06x} of S7 communication, for DB{db}")),
    }
}

impl Link for S7Link {
    fn connect(&mut self) -> Result<(), LinkFault> {
        // The old connection goes first: a CPU has few.
        self.connection = None;
        self.connection = Some(Connection::open(&self.address, self.options, self.timeout)?);
        let mut scratch = vec![0; self.exchange.size(Direction::FromPlc)];
        self.read_block(&mut scratch)?;
        // What is to be written is there if it can be read.
        let (db, size) = (self.options.db_to_plc, self.layouts.to_plc.size());
        self.blank(size);
        let connection = self.connection.as_mut().ok_or_else(LinkFault::not_connected)?;
        connection.read(db, &mut self.block).map_err(|refusal| fault(refusal, db, size))
    }

    fn write(&mut self, to_plc: &[u8]) -> Result<(), LinkFault> {
        let (db, size) = (self.options.db_to_plc, self.layouts.to_plc.size());
        self.blank(size);
        self.layouts.to_plc.encode(to_plc, &mut self.block);
        let connection = self.connection.as_mut().ok_or_else(LinkFault::not_connected)?;
        let pdu = connection.pdu();
        let mut all = messages(pdu, db, &self.owned, &self.block);
        if all.len() > 1 {
            all = messages(pdu, db, &self.before, &self.block);
            all.extend(messages(pdu, db, std::slice::from_ref(&self.grant), &self.block));
        }
        for (item, bytes) in all {
            connection.write(item, bytes).map_err(|refusal| fault(refusal, db, size))?;
        }
        Ok(())
    }

    fn read(&mut self, _patience: Duration, from_plc: &mut [u8]) -> Result<bool, LinkFault> {
        self.read_block(from_plc)?;
        if !self.is_read_at_once() {
            let words = from_plc[..self.exchange.outputs().start].to_vec();
            self.read_block(from_plc)?;
            from_plc[..words.len()].copy_from_slice(&words);
        }
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_block_goes_in_messages_of_even_parts() {
        let block = vec![7; 700];
        let each = |places: &[Range<usize>]| -> Vec<(u32, u16)> {
            messages(240, 3, places, &block).iter().map(|(item, _)| (item.at, item.len)).collect()
        };
        assert_eq!(each(std::slice::from_ref(&(0..38))), [(0, 38)]);
        assert_eq!(each(&[0..500, 502..503]), [(0, 212), (212, 212), (424, 76), (502, 1)]);
    }

    /// The grant is in the last message, whole and alone, unless all is in one.
    #[test]
    fn a_grant_may_lie_anywhere() {
        assert_eq!(without(std::slice::from_ref(&(0..38)), &(34..38)), std::slice::from_ref(&(0..34)));
        assert_eq!(without(&[0..38, 40..50], &(8..12)), [0..8, 12..38, 40..50]);
        assert!(without(std::slice::from_ref(&(34..38)), &(34..38)).is_empty());
    }
}
