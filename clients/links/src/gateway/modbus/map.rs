//! Which point is which register or coil.
//!
//! An address is written `hr:100` (holding register), `ir:100` (input register), `coil:3`, `di:3` (discrete
//! input), all counted from 0 as on the wire; `hr:100.3` is a bit of a register. Values of more than 16 bits take
//! the registers that follow.

use std::fmt;

use onescan_server::signal::SignalType;
use schemars::JsonSchema;
use serde::Deserialize;

use crate::gateway::byte_order::{ByteOrder, is_number};
use crate::gateway::exchange::{Direction, Exchange, Point};
use crate::gateway::fault::MappingFault;

/// What a scenario says of a Modbus link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// The unit, for gateways to serial lines; 255 for the PLC itself.
    pub unit: u8,
    /// Which word of a long value comes first.
    pub word_order: ByteOrder,
}

impl Default for Options {
    fn default() -> Self {
        Self { unit: 255, word_order: ByteOrder::BigEndian }
    }
}

/// The four tables of Modbus (sec. 4.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Table {
    /// Bits that can be written.
    Coil,
    /// Bits that can be read only.
    DiscreteInput,
    /// Words that can be read only.
    InputRegister,
    /// Words that can be written.
    HoldingRegister,
}

impl Table {
    const PREFIXES: [(&'static str, Self); 4] =
        [("coil", Self::Coil), ("di", Self::DiscreteInput), ("ir", Self::InputRegister), ("hr", Self::HoldingRegister)];

    fn is_bits(self) -> bool {
        matches!(self, Self::Coil | Self::DiscreteInput)
    }

    fn is_writable(self) -> bool {
        matches!(self, Self::Coil | Self::HoldingRegister)
    }

    /// The most that one request reads, and writes (secs. 6.1, 6.3, 6.11, 6.12).
    pub(crate) fn at_most(self, direction: Direction) -> u16 {
        match (self.is_bits(), direction) {
            (true, Direction::FromPlc) => 2000,
            (true, Direction::ToPlc) => 1968,
            (false, Direction::FromPlc) => 125,
            (false, Direction::ToPlc) => 123,
        }
    }
}

/// Where a point is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Address {
    /// In which table.
    pub table: Table,
    /// The register or coil, from 0.
    pub at: u16,
    /// The bit of a register.
    pub bit: Option<u8>,
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let prefix = Table::PREFIXES.iter().find(|(_, table)| *table == self.table).map_or("?", |(prefix, _)| prefix);
        write!(f, "{prefix}:{}", self.at)?;
        self.bit.map_or(Ok(()), |bit| write!(f, ".{bit}"))
    }
}

/// The address in `text`.
fn parse(text: &str) -> Option<Address> {
    let (prefix, place) = text.split_once(':')?;
    let table = Table::PREFIXES.iter().find(|(known, _)| *known == prefix.trim())?.1;
    let (at, bit) = match place.trim().split_once('.') {
        Some((at, bit)) => (at, Some(bit.parse().ok().filter(|bit| *bit < 16)?)),
        None => (place.trim(), None),
    };
    Some(Address { table, at: at.parse().ok()?, bit })
}

/// A point and its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// The point.
    pub point: Point,
    /// Its place.
    pub address: Address,
    /// Registers or coils that it takes.
    pub count: u16,
}

impl Entry {
    fn end(&self) -> u32 {
        u32::from(self.address.at) + u32::from(self.count)
    }
}

/// What one request carries: neighbours in one table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// The table.
    pub table: Table,
    /// The first register or coil.
    pub at: u16,
    /// How many.
    pub count: u16,
}

/// All points of a PLC with their places.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RegisterMap {
    /// What the gateway writes.
    pub to_plc: Vec<Entry>,
    /// What it reads.
    pub from_plc: Vec<Entry>,
    /// Which word of a long value comes first.
    pub word_order: ByteOrder,
}

/// Where points without an address are put: those to the PLC from here.
const TO_PLC_AT: u16 = 0;
/// And those from the PLC from here.
const FROM_PLC_AT: u16 = 1000;

impl RegisterMap {
    /// The places of all points: those of their addresses, or else holding registers in the order of the points, to the
    /// PLC from 0, from the PLC from 1000. A point with an address leaves its register free, so that the others stay
    /// where they are.
    ///
    /// # Errors
    /// An address that is none, or does not suit its point; two points in one place.
    pub fn new(options: &Options, exchange: &Exchange) -> Result<Self, MappingFault> {
        Ok(Self {
            to_plc: entries(exchange.to_plc(), Direction::ToPlc, TO_PLC_AT)?,
            from_plc: entries(exchange.from_plc(), Direction::FromPlc, FROM_PLC_AT)?,
            word_order: options.word_order,
        })
    }

    /// The addresses of the points of both directions, as a map writes them.
    pub fn places(&self) -> [Vec<String>; 2] {
        [&self.to_plc, &self.from_plc].map(|entries| entries.iter().map(|entry| entry.address.to_string()).collect())
    }

    /// The requests that write all points, in the order of the points: the grant is in the last.
    pub fn writes(&self) -> Vec<Span> {
        spans(&self.to_plc, Direction::ToPlc)
    }

    /// The requests that read all points, in the order of the points: `SDSP_Done` is in the first.
    pub fn reads(&self) -> Vec<Span> {
        spans(&self.from_plc, Direction::FromPlc)
    }
}

fn entries(points: &[Point], direction: Direction, mut next: u16) -> Result<Vec<Entry>, MappingFault> {
    let mut entries: Vec<Entry> = Vec::new();
    for point in points {
        let entry = entry(point, direction, next)?;
        next = next
            .checked_add(entry.count)
            .ok_or_else(|| MappingFault::new(&point.name, "there are no more registers"))?;
        if let Some(other) = entries.iter().find(|other| overlap(other, &entry)) {
            return Err(other.point.doubled(point, &entry.address.to_string()));
        }
        entries.push(entry);
    }
    Ok(entries)
}

fn entry(point: &Point, direction: Direction, next: u16) -> Result<Entry, MappingFault> {
    let fault =
        |message: String, help: &str| Err(MappingFault::new(&point.name, message).with_help(Some(help.to_owned())));
    let (name, ty) = (point.label(), point.ty);
    let address = match &point.address {
        None => Address { table: Table::HoldingRegister, at: next, bit: None },
        Some(text) => {
            let Some(address) = parse(text) else {
                let message = format!("`{name}` is mapped to `{text}`, which is not a Modbus address");
                return fault(message, "write `hr:100`, `ir:100`, `hr:100.3`, `coil:3` or `di:3`");
            };
            address
        }
    };
    let is_bool = ty == SignalType::BOOL;
    if !is_bool && !is_number(ty) {
        return fault(format!("`{name}` is {ty}: texts do not travel in registers"), "take it out of the session");
    }
    if !is_bool && (address.table.is_bits() || address.bit.is_some()) {
        return fault(format!("`{name}` is {ty} and does not fit into the bit {address}"), "give it a register");
    }
    if direction == Direction::ToPlc && !address.table.is_writable() {
        return fault(
            format!("`{name}` is written by the gateway, and {address} can only be read"),
            "use `hr:` or `coil:`",
        );
    }
    let count = ty.size().div_ceil(2) as u16;
    let entry = Entry { point: point.clone(), address, count };
    if entry.end() > 0x1_0000 {
        return fault(format!("`{name}` at {address} goes beyond register 65535"), "give it a lower one");
    }
    Ok(entry)
}

fn overlap(a: &Entry, b: &Entry) -> bool {
    let is_apart = matches!((a.address.bit, b.address.bit), (Some(x), Some(y)) if x != y);
    a.address.table == b.address.table
        && !is_apart
        && u32::from(a.address.at) < b.end()
        && u32::from(b.address.at) < a.end()
}

/// Neighbours in one request. To the PLC nothing between two points may be written, from it a gap costs less
/// than a request.
fn spans(entries: &[Entry], direction: Direction) -> Vec<Span> {
    /// Registers or coils that are read in vain rather than with a request of their own.
    const GAP_MAX: u32 = 32;
    let mut spans: Vec<Span> = Vec::new();
    for Entry { address, count, .. } in entries {
        let (at, end) = (u32::from(address.at), u32::from(address.at) + u32::from(*count));
        if let Some(last) = spans.last_mut().filter(|last| last.table == address.table) {
            let (first, past) = (u32::from(last.at), u32::from(last.at) + u32::from(last.count));
            let gap_max = if direction == Direction::FromPlc { GAP_MAX } else { 0 };
            let is_near = at >= first && at <= past + gap_max;
            let whole = end.max(past) - first;
            if is_near && whole <= u32::from(address.table.at_most(direction)) {
                last.count = whole as u16;
                continue;
            }
        }
        spans.push(Span { table: address.table, at: address.at, count: *count });
    }
    spans
}

#[cfg(test)]
#[path = "map_tests.rs"]
mod tests;
