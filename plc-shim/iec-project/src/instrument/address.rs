//! Where variables lie in a PLC with direct addresses (2nd ed. 2.4.1.1), and where Modbus finds them in OpenPLC.
//!
//! | address | in OpenPLC v3 |
//! |---|---|
//! | `%QXn.m` | coil 8n + m |
//! | `%QWn` | holding register n, up to 1023 |
//! | `%MWn` | holding register 1024 + n |
//! | `%MDn` | holding registers from 2048 + 2n |
//! | `%MLn` | holding registers from 4096 + 4n |
//! | `%IXn.m`, `%IWn` | a discrete input, an input register: a gateway cannot write them |

use std::collections::BTreeSet;
use std::fmt;

use super::exchanged::Way;

/// An address of the areas that Modbus reaches.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Address {
    area: Area,
    width: Width,
    index: u32,
    /// Of a bit alone.
    bit: u32,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Area {
    Input,
    Output,
    Memory,
}

/// How much an address holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Width {
    Bit,
    Byte,
    Word,
    Double,
    Long,
}

impl Width {
    const LETTERS: [(char, Self); 5] =
        [('X', Self::Bit), ('B', Self::Byte), ('W', Self::Word), ('D', Self::Double), ('L', Self::Long)];

    fn letter(self) -> char {
        Self::LETTERS.iter().find(|(_, width)| *width == self).map_or('X', |(letter, _)| *letter)
    }

    /// Bytes of a value; a bit is a part of one.
    fn bytes(self) -> u32 {
        match self {
            Self::Bit | Self::Byte => 1,
            Self::Word => 2,
            Self::Double => 4,
            Self::Long => 8,
        }
    }
}

/// So many values of a width OpenPLC has in an area; and bytes of bits.
const COUNT: u32 = 1024;

impl Address {
    /// The address in a text such as `%QX0.1`.
    pub fn parse(text: &str) -> Option<Self> {
        let text = text.trim().to_ascii_uppercase();
        let mut letters = text.strip_prefix('%')?.chars();
        let area = match letters.next()? {
            'I' => Area::Input,
            'Q' => Area::Output,
            'M' => Area::Memory,
            _ => return None,
        };
        let rest = letters.as_str();
        let first = rest.chars().next()?;
        let named = Width::LETTERS.iter().find(|(letter, _)| *letter == first);
        let (width, number) = match named {
            Some((_, width)) => (*width, rest.get(1..)?),
            None => (Width::Bit, rest),
        };
        let (index, bit) = match number.split_once('.') {
            Some((index, bit)) if width == Width::Bit => (index, bit.parse().ok().filter(|bit| *bit < 8)?),
            None => (number, 0),
            _ => return None,
        };
        Some(Self { area, width, index: index.parse().ok()?, bit })
    }

    /// True if a gateway can write it over Modbus.
    pub fn is_writable(self) -> bool {
        self.area != Area::Input && self.modbus().is_some()
    }

    /// Where Modbus finds it in OpenPLC v3, as a gateway's mapping has it; nothing if that does not serve it.
    pub fn modbus(self) -> Option<String> {
        if self.index >= COUNT {
            return None;
        }
        let (table, at) = match (self.area, self.width) {
            (Area::Output, Width::Bit) => ("coil", 8 * self.index + self.bit),
            (Area::Input, Width::Bit) => ("di", 8 * self.index + self.bit),
            (Area::Output, Width::Word) => ("hr", self.index),
            (Area::Input, Width::Word) => ("ir", self.index),
            (Area::Memory, Width::Word) => ("hr", COUNT + self.index),
            (Area::Memory, Width::Double) => ("hr", 2 * COUNT + 2 * self.index),
            (Area::Memory, Width::Long) => ("hr", 4 * COUNT + 4 * self.index),
            _ => return None,
        };
        Some(format!("{table}:{at}"))
    }

    /// The address that Modbus finds at `coil:3` or `hr:2048` in OpenPLC v3.
    pub fn at_modbus(text: &str) -> Option<Self> {
        let (table, at) = text.split_once(':')?;
        let at: u32 = at.trim().parse().ok()?;
        let of = |area, width, index| Some(Self { area, width, index, bit: 0 });
        match (table.trim(), at) {
            ("coil", at) if at < 8 * COUNT => {
                Some(Self { area: Area::Output, width: Width::Bit, index: at / 8, bit: at % 8 })
            }
            ("hr", at) if at < COUNT => of(Area::Output, Width::Word, at),
            ("hr", at) if at < 2 * COUNT => of(Area::Memory, Width::Word, at - COUNT),
            ("hr", at) if at < 4 * COUNT && at % 2 == 0 => of(Area::Memory, Width::Double, (at - 2 * COUNT) / 2),
            ("hr", at) if at < 8 * COUNT && at % 4 == 0 => of(Area::Memory, Width::Long, (at - 4 * COUNT) / 4),
            _ => None,
        }
    }

    pub(super) fn width(self) -> Width {
        self.width
    }

    fn places(self) -> impl Iterator<Item = Place> {
        let bytes = self.width.bytes();
        let bits = if self.width == Width::Bit { self.bit..self.bit + 1 } else { 0..8 };
        let first = self.index * bytes;
        (first..first + bytes).flat_map(move |byte| bits.clone().map(move |bit| (self.area, byte, bit)))
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let area = match self.area {
            Area::Input => 'I',
            Area::Output => 'Q',
            Area::Memory => 'M',
        };
        write!(f, "%{area}{}{}", self.width.letter(), self.index)?;
        if self.width == Width::Bit { write!(f, ".{}", self.bit) } else { Ok(()) }
    }
}

/// A bit of an area: the area, the byte, the bit.
type Place = (Area, u32, u32);

/// What is free. Addresses of different widths share their bytes, as the standard has it, whether the PLC does so or not.
#[derive(Debug, Clone)]
pub(super) struct Room {
    taken: BTreeSet<Place>,
    /// The first byte of the memory that is given out.
    memory_from: u32,
}

/// The first byte of bits that the gateway writes: below are outputs of the board and of slaves that the PLC writes.
const TO_PLC_FROM: u32 = 512;
/// And of those that it reads. They share no byte with the others: OpenPLC fills the last byte of a request that
/// writes coils with FALSE, whatever lies there.
const FROM_PLC_FROM: u32 = 768;

impl Room {
    /// All that `used` leaves, behind `words_at` if that is given.
    pub(super) fn beside(used: impl Iterator<Item = Address>, words_at: Option<Address>) -> Self {
        let memory_from = words_at.map_or(0, |first| first.index * first.width.bytes());
        Self { taken: used.flat_map(Address::places).collect(), memory_from }
    }

    /// The next free address for a value of this width: bits are outputs, values lie in the memory.
    pub(super) fn next(&mut self, width: Width, way: Way) -> Option<Address> {
        let found = if width == Width::Bit {
            // The last byte of each part stays free.
            let bytes = match way {
                Way::ToPlc => TO_PLC_FROM..FROM_PLC_FROM - 1,
                Way::FromPlc => FROM_PLC_FROM..COUNT - 1,
            };
            let bits = bytes.flat_map(|index| (0..8).map(move |bit| (index, bit)));
            bits.map(|(index, bit)| Address { area: Area::Output, width, index, bit }).find(|each| self.is_free(*each))
        } else {
            let first = self.memory_from.div_ceil(width.bytes());
            let all = (first..COUNT).map(|index| Address { area: Area::Memory, width, index, bit: 0 });
            all.into_iter().find(|each| self.is_free(*each))
        };
        self.taken.extend(found.into_iter().flat_map(Address::places));
        found
    }

    fn is_free(&self, address: Address) -> bool {
        !address.places().any(|place| self.taken.contains(&place))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn modbus(text: &str) -> Option<String> {
        Address::parse(text).and_then(Address::modbus)
    }

    #[test]
    fn openplc_serves_each_area_in_a_range_of_its_own() {
        let all = ["%QX0.0", "%QX1.3", "%IX2.1", "%QW1023", "%MW0", "%MD0", "%MD3", "%ML2", "%IW7"];
        let found: Vec<_> = all.iter().map(|text| modbus(text).expect("it is served")).collect();
        let expected = ["coil:0", "coil:11", "di:17", "hr:1023", "hr:1024", "hr:2048", "hr:2054", "hr:4104", "ir:7"];
        assert_eq!(found, expected);
        for text in all.iter().filter(|text| !text.starts_with("%I")) {
            let there = modbus(text).expect("it is served");
            assert_eq!(Address::at_modbus(&there).map(|address| address.to_string()).as_deref(), Some(*text));
        }
        for text in ["%QX1024.0", "%MD1024", "%QB0", "%MX0.0", "%QX0.8", "%Z1", "%MD", "x"] {
            assert_eq!(modbus(text), None, "{text}");
        }
        assert!(Address::parse("%IX0.0").is_some_and(|address| !address.is_writable()));
    }

    #[test]
    fn what_the_project_uses_is_not_given_out() {
        let used = ["%MW0", "%QX512.0", "%QX512.1"].map(|text| Address::parse(text).expect("an address"));
        let mut room = Room::beside(used.into_iter(), None);
        let bit = room.next(Width::Bit, Way::FromPlc).map(|address| address.to_string());
        assert_eq!(bit.as_deref(), Some("%QX768.0"));
        let mut next = |width| room.next(width, Way::ToPlc).map(|address| address.to_string());
        assert_eq!(next(Width::Bit).as_deref(), Some("%QX512.2"));
        assert_eq!(next(Width::Double).as_deref(), Some("%MD1"));
        assert_eq!(next(Width::Long).as_deref(), Some("%ML1"));
        assert_eq!(next(Width::Word).as_deref(), Some("%MW1"));
        let mut room = Room::beside(std::iter::empty(), Address::parse("%MD100"));
        assert_eq!(room.next(Width::Long, Way::ToPlc).map(|address| address.to_string()).as_deref(), Some("%ML50"));
    }
}
