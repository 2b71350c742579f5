//! A place in a block: a bit, bytes in a row, or parts at several offsets.
//!
//! A PLC that was not made for a handshake has no room for its words in one piece, but often a spare byte or a few spare
//! bits in each structure. A word in parts fills these, and the block stays as long as it is.

use std::fmt;
use std::ops::Range;

use onescan_server::signal::SignalType;

use crate::gateway::byte_order::{ByteOrder, is_number};

/// Bits of one byte that are next to each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Bits {
    byte: usize,
    /// The least significant one, 0 to 7.
    first: u8,
    /// How many, 1 to 8.
    count: u8,
}

impl Bits {
    fn mask(self) -> u8 {
        (0xff >> (8 - self.count)) << self.first
    }
}

/// Where in a block.
#[derive(Clone, Debug, PartialEq, Eq)]
enum At {
    Bit(Bits),
    /// Bytes in the order of the block, from this one on.
    Row(usize),
    /// The most significant part first, whatever the order of the block.
    Parts(Vec<Bits>),
}

/// A place in a block for a value of a type.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Place {
    ty: SignalType,
    at: At,
}

impl Place {
    /// A BOOL.
    pub(super) fn bit(byte: usize, bit: u8) -> Self {
        Self { ty: SignalType::BOOL, at: At::Bit(Bits { byte, first: bit, count: 1 }) }
    }

    /// A number whose bytes are in a row.
    pub(super) fn row(byte: usize, ty: SignalType) -> Self {
        Self { ty, at: At::Row(byte) }
    }

    /// The type of the value there.
    pub(super) fn ty(&self) -> SignalType {
        self.ty
    }

    /// The place of a value of type `ty` at an offset: `12`; for a BOOL `0.3`; for a number in parts `1+11.0-3+21.4-7`.
    /// Nothing for what is not an offset.
    ///
    /// # Errors
    /// The type has no such place in a block of `size` bytes: why not.
    pub(super) fn parse(address: &str, ty: SignalType, size: usize) -> Option<Result<Self, String>> {
        let parts: Vec<Part> = address.split('+').map(|part| Part::parse(part.trim())).collect::<Option<_>>()?;
        let place = match (&parts[..], ty) {
            ([Part { bits, is_bit: true, .. }], SignalType::BOOL) => Self { ty, at: At::Bit(*bits) },
            ([Part { bits: Bits { byte, .. }, is_whole: true, .. }], _) if is_number(ty) => Self::row(*byte, ty),
            _ if is_number(ty) && !matches!(&parts[..], [Part { is_bit: true, .. }]) => {
                let parts: Vec<Bits> = parts.iter().map(|part| part.bits).collect();
                let (given, needed) = (parts.iter().map(|part| usize::from(part.count)).sum::<usize>(), 8 * ty.size());
                if given != needed {
                    return Some(Err(format!("`{address}` has {given} of the {needed} bits of {ty}")));
                }
                Self { ty, at: At::Parts(parts) }
            }
            _ => return Some(Err(format!("`{address}` is not a place for {ty}"))),
        };
        if place.ranges().any(|range| range.end > size) {
            return Some(Err(format!("`{address}` is not a place for {ty} in a block of {size} bytes")));
        }
        Some(Ok(place))
    }

    /// True for a value that is not in one piece.
    pub(super) fn is_in_parts(&self) -> bool {
        matches!(self.at, At::Parts(_))
    }

    /// The bytes in which it lies, a range a piece.
    pub(super) fn ranges(&self) -> impl Iterator<Item = Range<usize>> {
        let (row, parts) = match &self.at {
            At::Bit(bits) => (Some(bits.byte..bits.byte + 1), &[][..]),
            At::Row(byte) => (Some(*byte..byte + self.ty.size()), &[][..]),
            At::Parts(parts) => (None, &parts[..]),
        };
        row.into_iter().chain(parts.iter().map(|part| part.byte..part.byte + 1))
    }

    /// The bits that it takes: bytes of the block, and which of their bits.
    pub(super) fn masks(&self) -> impl Iterator<Item = (usize, u8)> {
        let (row, parts) = match &self.at {
            At::Bit(bits) => (0..0, std::slice::from_ref(bits)),
            At::Row(byte) => (*byte..byte + self.ty.size(), &[][..]),
            At::Parts(parts) => (0..0, &parts[..]),
        };
        row.map(|byte| (byte, 0xff)).chain(parts.iter().map(|part| (part.byte, part.mask())))
    }

    /// Its first byte and bit, by which places are sorted for people.
    pub(super) fn key(&self) -> (usize, u8) {
        match &self.at {
            At::Bit(bits) => (bits.byte, bits.first),
            At::Row(byte) => (*byte, 0),
            At::Parts(parts) => parts.first().map_or((0, 0), |part| (part.byte, part.first)),
        }
    }

    /// Puts a packed value, which is little-endian, into a block.
    pub(super) fn put(&self, order: ByteOrder, value: &[u8], block: &mut [u8]) {
        let set = |bits: &Bits, value: u64, block: &mut [u8]| {
            let mask = bits.mask();
            block[bits.byte] = block[bits.byte] & !mask | (value << bits.first) as u8 & mask;
        };
        match &self.at {
            At::Bit(bits) => set(bits, u64::from(value[0] != 0), block),
            At::Row(byte) => order.copy(value, &mut block[*byte..byte + value.len()]),
            At::Parts(parts) => {
                let mut rest = number(value);
                for part in parts.iter().rev() {
                    set(part, rest, block);
                    rest = rest.checked_shr(u32::from(part.count)).unwrap_or(0);
                }
            }
        }
    }

    /// Takes a packed value out of a block.
    pub(super) fn take(&self, order: ByteOrder, block: &[u8], value: &mut [u8]) {
        let get = |bits: &Bits| (block[bits.byte] & bits.mask()) >> bits.first;
        match &self.at {
            At::Bit(bits) => value[0] = get(bits),
            At::Row(byte) => order.copy(&block[*byte..byte + value.len()], value),
            At::Parts(parts) => {
                let whole = parts.iter().fold(0, |high: u64, part| high << part.count | u64::from(get(part)));
                value.copy_from_slice(&whole.to_le_bytes()[..value.len()]);
            }
        }
    }
}

/// A packed number of at most eight bytes.
fn number(value: &[u8]) -> u64 {
    value.iter().rev().fold(0, |high, byte| high << 8 | u64::from(*byte))
}

/// A part as it is written: `12`, `12.3` or `12.3-7`.
struct Part {
    bits: Bits,
    is_bit: bool,
    is_whole: bool,
}

impl Part {
    fn parse(text: &str) -> Option<Self> {
        let bit = |text: &str| text.parse::<u8>().ok().filter(|bit| *bit < 8);
        let (byte, bits) = text.split_once('.').map_or((text, None), |(byte, bits)| (byte, Some(bits)));
        let byte = usize::from(byte.parse::<u16>().ok()?);
        let (first, last) = match bits.map(|bits| bits.split_once('-').unwrap_or((bits, bits))) {
            Some((first, last)) => (bit(first)?, bit(last)?),
            None => (0, 7),
        };
        let count = last.checked_sub(first)? + 1;
        Some(Self { bits: Bits { byte, first, count }, is_bit: bits.is_some() && count == 1, is_whole: bits.is_none() })
    }
}

impl fmt::Display for Bits {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { byte, first, count } = self;
        match count {
            8 => write!(f, "{byte}"),
            1 => write!(f, "{byte}.{first}"),
            _ => write!(f, "{byte}.{first}-{}", first + count - 1),
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.at {
            At::Bit(bits) => bits.fmt(f),
            At::Row(byte) => byte.fmt(f),
            At::Parts(parts) => {
                for (index, part) in parts.iter().enumerate() {
                    write!(f, "{}{part}", if index == 0 { "" } else { "+" })?;
                }
                Ok(())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_offset_is_read_as_it_is_written() {
        let said = |address: &str, ty| match Place::parse(address, ty, 40) {
            None => "no offset".to_owned(),
            Some(place) => place.map_or_else(|why| why, |place| place.to_string()),
        };
        assert_eq!(said("12", SignalType::REAL), "12");
        assert_eq!(said("0.3", SignalType::BOOL), "0.3");
        assert_eq!(said(" 1 + 11+21+31", SignalType::UDINT), "1+11+21+31");
        assert_eq!(said("0.2-7+10.2-7+20.4-7", SignalType::INT), "0.2-7+10.2-7+20.4-7");
        assert_eq!(said("0.2-7+10.2-7+20.4+1", SignalType::INT), "`0.2-7+10.2-7+20.4+1` has 21 of the 16 bits of INT");
        assert_eq!(said("1+11", SignalType::UDINT), "`1+11` has 16 of the 32 bits of UDINT");
        assert_eq!(said("38", SignalType::REAL), "`38` is not a place for REAL in a block of 40 bytes");
        assert_eq!(said("1+40", SignalType::INT), "`1+40` is not a place for INT in a block of 40 bytes");
        assert_eq!(said("12", SignalType::BOOL), "`12` is not a place for BOOL");
        assert_eq!(said("0.3", SignalType::INT), "`0.3` is not a place for INT");
        for no in ["", "+", "x", "1+x", "0.8", "0.7-2", "-1", "65536", "99999999999999999999", "1.2-", "1.-2"] {
            assert_eq!(said(no, SignalType::UDINT), "no offset", "{no}");
        }
    }

    #[test]
    fn the_most_significant_part_comes_first() {
        let place = Place::parse("3+1.4-7+0.0-3", SignalType::INT, 4).unwrap().unwrap();
        for order in [ByteOrder::BigEndian, ByteOrder::LittleEndian] {
            let mut block = [0xff, 0xff, 0xff, 0xff];
            place.put(order, &0x1234_i16.to_le_bytes(), &mut block);
            assert_eq!(block, [0xf4, 0x3f, 0xff, 0x12]);
            let mut value = [0; 2];
            place.take(order, &block, &mut value);
            assert_eq!(i16::from_le_bytes(value), 0x1234);
        }
    }
}
