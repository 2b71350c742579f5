//! What lies where in a block, as an S7 data block of standard access has it: BOOLs fill bytes bit by bit,
//! single bytes follow on the next byte, everything else and every structure on the next even byte.
//!
//! `[Nyyssönen]` Fig. 18: 16 control bits and seven REALs are 30 bytes an axis.

use std::collections::BTreeMap;
use std::fmt;
use std::ops::Range;

use onescan_base::did_you_mean;
use onescan_server::signal::SignalType;
use schemars::JsonSchema;
use serde::Deserialize;

use crate::gateway::byte_order::{ByteOrder, is_number};
use crate::gateway::exchange::{Exchange, Point};
use crate::gateway::fault::MappingFault;

/// The largest block; a data block of an S7 has no more.
const BLOCK_BYTES_MAX: usize = 65_534;
/// How deep structures may lie in structures.
const DEPTH_MAX: u32 = 8;

/// The blocks as a scenario declares them. A field is written `Name: TYPE`, the type elementary or a
/// structure's name; fields named `_` are room that nobody uses.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Declaration {
    /// Order of the bytes of every number.
    pub byte_order: ByteOrder,
    /// The block that the gateway sends.
    pub to_plc: Vec<String>,
    /// The block that the PLC sends.
    pub from_plc: Vec<String>,
    /// Structures by name, each a list of fields.
    pub structures: BTreeMap<String, Vec<String>>,
}

/// A place in a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Place {
    byte: usize,
    bit: u8,
    ty: SignalType,
}

impl Place {
    fn bytes(self) -> Range<usize> {
        self.byte..self.byte + self.ty.size()
    }
}

/// A value in packed bytes and in a block.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Move {
    packed: Range<usize>,
    place: Place,
}

/// Where the points of one direction lie in its block.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layout {
    order: ByteOrder,
    moves: Vec<Move>,
    size: usize,
    /// True if the block has no fields but the points, so that all of it is the gateway's and the PLC's own.
    is_own: bool,
}

/// Both blocks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layouts {
    /// The block that the gateway sends.
    pub to_plc: Layout,
    /// The block that the PLC sends.
    pub from_plc: Layout,
}

impl Layouts {
    /// The blocks for the points of `exchange`. Each point is the field of its address, of its variable or of its
    /// signal, or lies at an offset like `12` or, for a BOOL, `0.3`. A direction without declared fields has a field a
    /// point.
    ///
    /// # Errors
    /// A point without a field, a field of another type, two points in one place, a declaration that is wrong.
    pub fn new(declaration: &Declaration, exchange: &Exchange) -> Result<Self, MappingFault> {
        Ok(Self {
            to_plc: Layout::new(declaration, &declaration.to_plc, exchange.to_plc(), "to_plc")?,
            from_plc: Layout::new(declaration, &declaration.from_plc, exchange.from_plc(), "from_plc")?,
        })
    }
}

impl Layouts {
    /// The offsets of the points of both directions, as a map writes them.
    pub fn places(&self) -> [Vec<String>; 2] {
        [&self.to_plc, &self.from_plc].map(|layout| layout.moves.iter().map(|moved| moved.place.to_string()).collect())
    }

    /// Byte and bit of the points of both directions.
    pub fn keys(&self) -> [Vec<(usize, u8)>; 2] {
        let key = |moved: &Move| (moved.place.byte, moved.place.bit);
        [&self.to_plc, &self.from_plc].map(|layout| layout.moves.iter().map(key).collect())
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.ty == SignalType::BOOL { write!(f, "{}.{}", self.byte, self.bit) } else { write!(f, "{}", self.byte) }
    }
}

impl Place {
    /// True if the two share a bit.
    fn overlaps(self, other: Self) -> bool {
        let is_apart = self.ty == SignalType::BOOL && other.ty == SignalType::BOOL && self.bit != other.bit;
        !is_apart && self.byte < other.byte + other.ty.size() && other.byte < self.byte + self.ty.size()
    }
}

impl Layout {
    fn new(declaration: &Declaration, fields: &[String], points: &[Point], block: &str) -> Result<Self, MappingFault> {
        let mut ruler = Ruler { structures: &declaration.structures, places: BTreeMap::new(), at: 0, bits: 0 };
        if fields.is_empty() {
            for point in points {
                ruler.add(&point.key(), &point.ty.to_string(), 0)?;
            }
        } else {
            for field in fields {
                ruler.field("", field, 0)?;
            }
        }
        let size = ruler.size();
        let mut moves: Vec<Move> = Vec::new();
        for point in points {
            let place = place_of(point, &ruler.places, size, block)?;
            if let Some(index) = moves.iter().position(|other| other.place.overlaps(place)) {
                return Err(points[index].doubled(point, &format!("{place} of `{block}`")));
            }
            moves.push(Move { packed: point.range(), place });
        }
        Ok(Self { order: declaration.byte_order, moves, size, is_own: fields.is_empty() })
    }

    /// Bytes of the block.
    pub fn size(&self) -> usize {
        self.size
    }

    /// The bytes of the last point.
    pub fn last(&self) -> Range<usize> {
        self.moves.last().map_or(0..0, |each| each.place.bytes())
    }

    /// The bytes that may be written: all of a block that has no fields but the points, and otherwise those in which
    /// points lie. As few ranges as there are, in their order.
    pub fn owned(&self) -> Vec<Range<usize>> {
        if self.is_own {
            return std::iter::once(0..self.size).collect();
        }
        let mut places: Vec<Range<usize>> = self.moves.iter().map(|each| each.place.bytes()).collect();
        places.sort_by_key(|place| place.start);
        let mut runs: Vec<Range<usize>> = Vec::new();
        for place in places {
            match runs.last_mut().filter(|last| place.start <= last.end) {
                Some(last) => last.end = last.end.max(place.end),
                None => runs.push(place),
            }
        }
        runs
    }

    /// The points that lie in these bytes of the block in part or whole, by their index and packed bytes.
    pub(crate) fn touched(&self, bytes: &Range<usize>) -> impl Iterator<Item = (usize, Range<usize>)> {
        let touches = |place: Range<usize>| place.start < bytes.end && bytes.start < place.end;
        let chosen = self.moves.iter().enumerate().filter(move |(_, each)| touches(each.place.bytes()));
        chosen.map(|(index, each)| (index, each.packed.clone()))
    }

    /// Puts packed values into a block.
    pub fn encode(&self, packed: &[u8], block: &mut [u8]) {
        for Move { packed: range, place } in &self.moves {
            let value = &packed[range.clone()];
            if place.ty == SignalType::BOOL {
                let mask = 1 << place.bit;
                block[place.byte] = block[place.byte] & !mask | if value[0] != 0 { mask } else { 0 };
            } else {
                self.order.copy(value, &mut block[place.byte..place.byte + value.len()]);
            }
        }
    }

    /// Takes packed values out of a block.
    pub fn decode(&self, block: &[u8], packed: &mut [u8]) {
        for Move { packed: range, place } in &self.moves {
            let value = &mut packed[range.clone()];
            if place.ty == SignalType::BOOL {
                value[0] = block[place.byte] >> place.bit & 1;
            } else {
                let len = value.len();
                self.order.copy(&block[place.byte..place.byte + len], value);
            }
        }
    }
}

fn place_of(point: &Point, places: &BTreeMap<String, Place>, size: usize, block: &str) -> Result<Place, MappingFault> {
    let own = || {
        let path = point.variable.as_deref().filter(|path| places.contains_key(*path));
        path.map_or_else(|| point.key(), str::to_owned)
    };
    let address = &point.address.clone().unwrap_or_else(own);
    let place = match (places.get(address.as_str()), offset(address)) {
        (Some(place), _) => *place,
        (None, Some((byte, bit))) => {
            let is_bool = point.ty == SignalType::BOOL;
            if byte + if is_bool { 1 } else { point.ty.size() } > size || (bit.is_some() != is_bool) {
                let message =
                    format!("`{address}` is no place for {} `{}` in a block of {size} bytes", point.ty, point.label());
                return Err(MappingFault::new(&point.name, message));
            }
            Place { byte, bit: bit.unwrap_or(0), ty: point.ty }
        }
        (None, None) => {
            let help = did_you_mean(address, places.keys().map(String::as_str));
            let message = format!("`{}` is mapped to `{address}`, which is no field of `{block}`", point.label());
            return Err(MappingFault::new(&point.name, message).with_help(help));
        }
    };
    if place.ty != point.ty {
        let message =
            format!("`{}` is {}, but field `{address}` of `{block}` is {}", point.label(), point.ty, place.ty);
        return Err(MappingFault::new(&point.name, message));
    }
    Ok(place)
}

/// `12` or `12.3`: a byte, and a bit of it.
fn offset(address: &str) -> Option<(usize, Option<u8>)> {
    match address.split_once('.') {
        None => Some((address.parse().ok()?, None)),
        Some((byte, bit)) => {
            let bit = bit.parse().ok().filter(|bit| *bit < 8)?;
            Some((byte.parse().ok()?, Some(bit)))
        }
    }
}

/// Lays field behind field.
struct Ruler<'d> {
    structures: &'d BTreeMap<String, Vec<String>>,
    places: BTreeMap<String, Place>,
    at: usize,
    /// Bits of the byte before `at` that are taken; 0 if none is open.
    bits: u8,
}

impl Ruler<'_> {
    fn field(&mut self, prefix: &str, field: &str, depth: u32) -> Result<(), MappingFault> {
        let Some((name, ty)) = field.split_once(':') else {
            let message = format!("`{field}` is no field: write `Name: TYPE`");
            return Err(MappingFault::new(field, message));
        };
        let (name, ty) = (name.trim(), ty.trim());
        let path = if prefix.is_empty() { name.to_owned() } else { format!("{prefix}.{name}") };
        self.add(&path, ty, depth)
    }

    fn add(&mut self, path: &str, ty: &str, depth: u32) -> Result<(), MappingFault> {
        if let Some(fields) = self.structures.get(ty) {
            return self.structure(path, ty, fields, depth);
        }
        let Ok(elementary) = ty.parse::<SignalType>() else {
            let help = did_you_mean(ty, self.structures.keys().map(String::as_str));
            let message = format!("field `{path}` is of type `{ty}`, which is neither elementary nor a structure");
            return Err(MappingFault::new(path, message).with_help(help));
        };
        let place = self.place(path, elementary)?;
        let is_room = path.rsplit('.').next() == Some("_");
        if !is_room && self.places.insert(path.to_owned(), place).is_some() {
            return Err(MappingFault::new(path, format!("field `{path}` is declared twice")));
        }
        Ok(())
    }

    fn structure(&mut self, path: &str, ty: &str, fields: &[String], depth: u32) -> Result<(), MappingFault> {
        if depth >= DEPTH_MAX {
            let message = format!("structure `{ty}` lies {DEPTH_MAX} structures deep, or in itself");
            return Err(MappingFault::new(path, message));
        }
        self.even();
        for field in fields {
            self.field(path, field, depth + 1)?;
        }
        self.even();
        Ok(())
    }

    fn place(&mut self, path: &str, ty: SignalType) -> Result<Place, MappingFault> {
        let place = if ty == SignalType::BOOL {
            if self.bits == 0 || self.bits == 8 {
                self.at += 1;
                self.bits = 0;
            }
            self.bits += 1;
            Place { byte: self.at - 1, bit: self.bits - 1, ty }
        } else if is_number(ty) {
            if ty.size() == 1 {
                self.bits = 0;
            } else {
                self.even();
            }
            let byte = self.at;
            self.at += ty.size();
            Place { byte, bit: 0, ty }
        } else {
            return Err(MappingFault::new(path, format!("`{path}` is {ty}: texts do not travel in blocks")));
        };
        if self.at > BLOCK_BYTES_MAX {
            return Err(MappingFault::new(path, format!("the block is longer than {BLOCK_BYTES_MAX} bytes")));
        }
        Ok(place)
    }

    fn even(&mut self) {
        self.at = self.at.next_multiple_of(2);
        self.bits = 0;
    }

    fn size(&self) -> usize {
        self.at.next_multiple_of(2)
    }
}

#[cfg(test)]
#[path = "layout_tests.rs"]
mod tests;
