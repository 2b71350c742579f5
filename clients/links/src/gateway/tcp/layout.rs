//! What lies where in a block, as an S7 data block of standard access has it: BOOLs fill bytes bit by bit,
//! single bytes follow on the next byte, everything else and every structure on the next even byte.
//!
//! `[Nyyssönen]` Fig. 18: 16 control bits and seven REALs are 30 bytes an axis.

use std::collections::BTreeMap;
use std::ops::Range;

use onescan_base::did_you_mean;
use onescan_base::field::{DEPTH_MAX, Field, is_room};
use onescan_server::signal::SignalType;
use schemars::JsonSchema;
use serde::Deserialize;
use thiserror::Error;

use super::place::Place;
use crate::gateway::byte_order::{ByteOrder, is_number};
use crate::gateway::exchange::{Exchange, Point};
use crate::gateway::fault::MappingFault;

/// The largest block; a data block of an S7 has no more.
const BLOCK_BYTES_MAX: usize = 65_534;

/// The blocks as a scenario declares them. A field is written `Name: TYPE`, the type elementary or a
/// structure's name; fields named `_` are room that nobody uses.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Declaration {
    /// Order of the bytes of every number.
    pub byte_order: ByteOrder,
    /// True if everything that comes must be 0 where no field and no point lies.
    pub reserve_zero: bool,
    /// The block that the gateway sends.
    pub to_plc: Vec<String>,
    /// The block that the PLC sends.
    pub from_plc: Vec<String>,
    /// Structures by name, each a list of fields.
    pub structures: BTreeMap<String, Vec<String>>,
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
    /// The bits that must be 0, a byte each of the block's; empty if nothing must.
    reserve: Vec<u8>,
    /// True if the block has no fields but the points, so that all of it is the gateway's and the PLC's own.
    is_own: bool,
}

/// Bits that are set where the layout has nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("{bits} bits are set in the reserve, the first in byte {byte},")]
pub struct Stray {
    /// How many.
    pub bits: u32,
    /// The first byte of the block that has one.
    pub byte: usize,
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
        let layouts = Self {
            to_plc: Layout::new(declaration, &declaration.to_plc, exchange.to_plc(), "to_plc")?,
            from_plc: Layout::new(declaration, &declaration.from_plc, exchange.from_plc(), "from_plc")?,
        };
        if declaration.reserve_zero && layouts.from_plc.reserve.iter().all(|mask| *mask == 0) {
            let message = "`reserve_zero` has nothing to look at: `from_plc` has no reserve";
            return Err(MappingFault::new("reserve_zero", message));
        }
        Ok(layouts)
    }

    /// The first point that is not in one piece, of those that `exchange` has.
    pub(crate) fn in_parts<'e>(&self, exchange: &'e Exchange) -> Option<&'e Point> {
        let of = |layout: &Layout, points: &'e [Point]| {
            layout.moves.iter().zip(points).find(|(moved, _)| moved.place.is_in_parts()).map(|(_, point)| point)
        };
        of(&self.to_plc, exchange.to_plc()).or_else(|| of(&self.from_plc, exchange.from_plc()))
    }

    /// The offsets of the points of both directions, as a map writes them.
    pub fn places(&self) -> [Vec<String>; 2] {
        [&self.to_plc, &self.from_plc].map(|layout| layout.moves.iter().map(|moved| moved.place.to_string()).collect())
    }

    /// Byte and bit of the points of both directions.
    pub fn keys(&self) -> [Vec<(usize, u8)>; 2] {
        let key = |moved: &Move| moved.place.key();
        [&self.to_plc, &self.from_plc].map(|layout| layout.moves.iter().map(key).collect())
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
        let mut taken = Taken::default();
        for (index, point) in points.iter().enumerate() {
            let place = place_of(point, &ruler.places, size, block)?;
            match taken.by(index, &place) {
                Some(other) if other == index => {
                    let message =
                        format!("`{}` is mapped to {place} of `{block}`, which has a bit twice", point.label());
                    return Err(MappingFault::new(&point.name, message));
                }
                Some(other) => return Err(points[other].doubled(point, &format!("{place} of `{block}`"))),
                None => moves.push(Move { packed: point.range(), place }),
            }
        }
        let mut reserve = if declaration.reserve_zero { vec![0xff; size] } else { Vec::new() };
        if declaration.reserve_zero {
            let places = ruler.places.values().chain(moves.iter().map(|each| &each.place));
            places.flat_map(Place::masks).for_each(|(byte, mask)| reserve[byte] &= !mask);
        }
        Ok(Self { order: declaration.byte_order, moves, size, reserve, is_own: fields.is_empty() })
    }

    /// Bytes of the block.
    pub fn size(&self) -> usize {
        self.size
    }

    /// The bytes of the last point, where it is in one piece.
    pub fn last(&self) -> Range<usize> {
        self.moves.last().and_then(|each| each.place.ranges().next()).unwrap_or(0..0)
    }

    /// What is set in the reserve of a block, if that must be 0.
    pub fn stray(&self, block: &[u8]) -> Option<Stray> {
        let stray = |(byte, mask): (&u8, &u8)| (byte & mask).count_ones();
        let bits = block.iter().zip(&self.reserve).map(stray);
        let byte = bits.clone().position(|bits| bits > 0)?;
        Some(Stray { bits: bits.sum(), byte })
    }

    /// The bytes that may be written: all of a block that has no fields but the points, and otherwise those in which
    /// points lie. As few ranges as there are, in their order.
    pub fn owned(&self) -> Vec<Range<usize>> {
        if self.is_own {
            return std::iter::once(0..self.size).collect();
        }
        let mut places: Vec<Range<usize>> = self.moves.iter().flat_map(|each| each.place.ranges()).collect();
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
        let chosen = self.moves.iter().enumerate().filter(move |(_, each)| each.place.ranges().any(touches));
        chosen.map(|(index, each)| (index, each.packed.clone()))
    }

    /// Puts packed values into a block.
    pub fn encode(&self, packed: &[u8], block: &mut [u8]) {
        for Move { packed: range, place } in &self.moves {
            place.put(self.order, &packed[range.clone()], block);
        }
    }

    /// Takes packed values out of a block.
    pub fn decode(&self, block: &[u8], packed: &mut [u8]) {
        for Move { packed: range, place } in &self.moves {
            place.take(self.order, block, &mut packed[range.clone()]);
        }
    }
}

/// Which bits have points.
#[derive(Default)]
struct Taken(BTreeMap<usize, Vec<(u8, usize)>>);

impl Taken {
    /// Point `index` takes `place`; gives the first point that has a bit of it already.
    fn by(&mut self, index: usize, place: &Place) -> Option<usize> {
        let mut first = None;
        for (byte, mask) in place.masks() {
            let there = self.0.entry(byte).or_default();
            let others = there.iter().filter(|(other, _)| other & mask != 0).map(|(_, index)| *index);
            first = first.into_iter().chain(others).min();
            there.push((mask, index));
        }
        first
    }
}

fn place_of(point: &Point, places: &BTreeMap<String, Place>, size: usize, block: &str) -> Result<Place, MappingFault> {
    let own = || {
        let path = point.variable.as_deref().filter(|path| places.contains_key(*path));
        path.map_or_else(|| point.key(), str::to_owned)
    };
    let address = &point.address.clone().unwrap_or_else(own);
    let place = match (places.get(address.as_str()), Place::parse(address, point.ty, size)) {
        (Some(place), _) => place.clone(),
        (None, Some(Ok(place))) => place,
        (None, Some(Err(why))) => {
            return Err(MappingFault::new(
                &point.name,
                format!("`{}` has no place in `{block}`: {why}", point.label()),
            ));
        }
        (None, None) => {
            let help = did_you_mean(address, places.keys().map(String::as_str));
            let message = format!("`{}` is mapped to `{address}`, which is not a field of `{block}`", point.label());
            return Err(MappingFault::new(&point.name, message).with_help(help));
        }
    };
    if place.ty() != point.ty {
        let message =
            format!("`{}` is {}, but field `{address}` of `{block}` is {}", point.label(), point.ty, place.ty());
        return Err(MappingFault::new(&point.name, message));
    }
    Ok(place)
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
        let Some(Field { name, ty }) = Field::parse(field) else {
            let message = format!("`{field}` is not a field: write `Name: TYPE`");
            return Err(MappingFault::new(field, message));
        };
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
        if !is_room(path) && self.places.insert(path.to_owned(), place).is_some() {
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
            Place::bit(self.at - 1, self.bits - 1)
        } else if is_number(ty) {
            if ty.size() == 1 {
                self.bits = 0;
            } else {
                self.even();
            }
            let byte = self.at;
            self.at += ty.size();
            Place::row(byte, ty)
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
