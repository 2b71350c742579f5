//! Two data blocks of an S7 over ISO-on-TCP (RFC 1006), one a direction, laid out as [`super::tcp::layout`] has it:
//! as a block of standard access, big-endian. What the gateway writes is nobody else's to write.
//!
//! A PLC answers a request between two scans, but a block that is longer than its PDU takes several. So a long
//! block is written with the grant before, and the grant alone behind it; and it is read twice, the words taken
//! from the first time and the outputs from the second.

use std::time::Duration;

use rust7::client::{S7Client, S7Error};
use schemars::JsonSchema;
use serde::Deserialize;

use super::exchange::{Direction, Exchange};
use super::fault::{LinkFault, MappingFault};
use super::link::Link;
use super::socket::{TIMEOUT, host_and_port};
use super::tcp::Layouts;

/// Where ISO-on-TCP listens.
const ISO_PORT: u16 = 102;
/// Bytes that the smallest PDU of an S7 (240) has room for.
const SHORT_BYTES: usize = 200;
/// Bytes of `SDSP_Grant`.
const GRANT_BYTES: usize = 4;

/// What a scenario says of an S7 link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// Rack of the CPU.
    pub rack: u16,
    /// Slot of the CPU: 0 or 1 in an S7-1200 or 1500, 2 in an S7-300.
    pub slot: u16,
    /// Number of the block that the gateway writes.
    pub db_to_plc: u16,
    /// Number of the block that it reads.
    pub db_from_plc: u16,
}

impl Default for Options {
    fn default() -> Self {
        Self { rack: 0, slot: 1, db_to_plc: 1, db_from_plc: 2 }
    }
}

/// Two data blocks of an S7.
pub struct S7Link {
    address: String,
    options: Options,
    exchange: Exchange,
    layouts: Layouts,
    client: Option<S7Client>,
    block: Vec<u8>,
    /// The grant that was written last.
    grant: [u8; GRANT_BYTES],
}

impl S7Link {
    /// A link to `address`, a host and perhaps a port.
    pub fn new(address: &str, options: Options, exchange: &Exchange, layouts: Layouts) -> Self {
        let block = Vec::new();
        Self {
            address: address.to_owned(),
            options,
            exchange: exchange.clone(),
            layouts,
            client: None,
            block,
            grant: [0; 4],
        }
    }

    fn open(&self) -> Result<S7Client, S7Error> {
        let (host, port) = host_and_port(&self.address, ISO_PORT).map_err(S7Error::Other)?;
        let mut client = S7Client::new();
        let ms = TIMEOUT.as_millis() as u64;
        client.set_timeout(ms, ms, ms)?;
        client.set_connection_port(port)?;
        client.connect_rack_slot(host, self.options.rack, self.options.slot)?;
        Ok(client)
    }

    fn write_block(&mut self, packed: &[u8]) -> Result<(), LinkFault> {
        let (db, size) = (self.options.db_to_plc, self.layouts.to_plc.size());
        self.block.clear();
        self.block.resize(size, 0);
        self.layouts.to_plc.encode(packed, &mut self.block);
        let client = self.client.as_mut().ok_or_else(LinkFault::not_connected)?;
        client.write_db(db, 0, &self.block).map_err(|error| fault(&error, db, size))
    }

    fn read_block(&mut self, packed: &mut [u8]) -> Result<(), LinkFault> {
        let (db, size) = (self.options.db_from_plc, self.layouts.from_plc.size());
        self.block.clear();
        self.block.resize(size, 0);
        let client = self.client.as_mut().ok_or_else(LinkFault::not_connected)?;
        client.read_db(db, 0, &mut self.block).map_err(|error| fault(&error, db, size))?;
        self.layouts.from_plc.decode(&self.block, packed);
        Ok(())
    }
}

fn fault(error: &S7Error, db: u16, size: usize) -> LinkFault {
    let block = |what: &str| MappingFault::new(&format!("DB{db}"), format!("data block DB{db} {what}"));
    match error {
        S7Error::S7NotFound => block("is not there").into(),
        S7Error::S7InvalidAddress => {
            let help = "compare it with `layout`; take `optimized block access` off and allow access by PUT/GET";
            block(&format!("has no {size} bytes, or is optimised")).with_help(Some(help.to_owned())).into()
        }
        S7Error::IsoInvalidHeader | S7Error::IsoFragmentedPacket => LinkFault::Nonsense(error.to_string()),
        _ => LinkFault::Lost(error.to_string()),
    }
}

impl Link for S7Link {
    fn connect(&mut self) -> Result<(), LinkFault> {
        self.client = None;
        let url = format!("s7://{}", self.address);
        let refused = |error: S7Error| match error {
            S7Error::IsoConnectionFailed | S7Error::PduNegotiationFailed => {
                LinkFault::Refused { url: url.clone(), reason: format!("{error}: are rack and slot right?") }
            }
            error => LinkFault::Unreachable { url: url.clone(), reason: error.to_string() },
        };
        self.client = Some(self.open().map_err(refused)?);
        let mut scratch = vec![0; self.exchange.size(Direction::FromPlc)];
        self.read_block(&mut scratch)?;
        // What is to be written is there if it can be read.
        let (db, size) = (self.options.db_to_plc, self.layouts.to_plc.size());
        self.block.clear();
        self.block.resize(size, 0);
        let client = self.client.as_mut().ok_or_else(LinkFault::not_connected)?;
        client.read_db(db, 0, &mut self.block).map_err(|error| fault(&error, db, size))
    }

    fn write(&mut self, to_plc: &[u8]) -> Result<(), LinkFault> {
        if self.layouts.to_plc.size() > SHORT_BYTES {
            let mut before = to_plc.to_vec();
            let at = before.len() - GRANT_BYTES;
            before[at..].copy_from_slice(&self.grant);
            self.write_block(&before)?;
        }
        self.write_block(to_plc)?;
        self.grant.copy_from_slice(&to_plc[to_plc.len() - GRANT_BYTES..]);
        Ok(())
    }

    fn read(&mut self, _patience: Duration, from_plc: &mut [u8]) -> Result<bool, LinkFault> {
        self.read_block(from_plc)?;
        if self.layouts.from_plc.size() > SHORT_BYTES {
            let words = from_plc[..self.exchange.outputs().start].to_vec();
            self.read_block(from_plc)?;
            from_plc[..words.len()].copy_from_slice(&words);
        }
        Ok(true)
    }
}
