//! Character strings and the functions on them (2nd ed. 2.3.1 Table 10, 2.5.1.5.5).
//!
//! A character is one byte in a STRING (ISO 8859-1), two in a WSTRING (UTF-16). How characters lie in memory is the
//! dialect's, see [`StringMemory`]; what lies behind the last one is zero.

use onescan_base::ElementaryType;

use super::expr::{Expr, Place};
use crate::dialect::StringMemory;

/// Most characters of a literal, and of a string with a count, so that every position is an INT.
pub const MAX_CAPACITY: u32 = 32_767;

/// Bits of a capacity in [`TextShape::code`].
const CAPACITY_BITS: u32 = 28;

/// Bytes of the count in front of the characters, where there is one.
const COUNT_SIZE: u32 = 2;

/// Width, capacity and memory of a string type.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct TextShape {
    pub wide: bool,
    pub capacity: u32,
    pub memory: StringMemory,
}

impl TextShape {
    /// Most characters of a string that lies so in memory. Where it ends with a 0, the PLC's memory is a limit before.
    pub fn most(memory: StringMemory) -> u32 {
        match memory {
            StringMemory::Counted => MAX_CAPACITY,
            StringMemory::ZeroTerminated => (1 << CAPACITY_BITS) - 1,
        }
    }

    /// The type of a number of its characters: an INT while that holds all of them.
    pub fn number(self) -> ElementaryType {
        if self.capacity > MAX_CAPACITY { ElementaryType::Dint } else { ElementaryType::Int }
    }

    /// Bytes of one character.
    pub fn unit(self) -> u32 {
        if self.wide { 2 } else { 1 }
    }

    /// Bytes in memory.
    pub fn size(self) -> u32 {
        match self.memory {
            StringMemory::Counted => COUNT_SIZE + self.capacity * self.unit(),
            StringMemory::ZeroTerminated => (self.capacity + 1) * self.unit(),
        }
    }

    /// Bytes in front of the first character.
    pub fn first(self) -> u32 {
        match self.memory {
            StringMemory::Counted => COUNT_SIZE,
            StringMemory::ZeroTerminated => 0,
        }
    }

    /// The keyword.
    pub fn keyword(self) -> &'static str {
        if self.wide { "WSTRING" } else { "STRING" }
    }

    /// As one number, for calls of the host.
    pub fn code(self) -> i32 {
        let terminated = self.memory == StringMemory::ZeroTerminated;
        self.capacity.cast_signed()
            | i32::from(self.wide) << CAPACITY_BITS
            | i32::from(terminated) << (CAPACITY_BITS + 1)
    }

    /// What [`Self::code`] made.
    pub fn from_code(code: i32) -> Self {
        let terminated = code >> (CAPACITY_BITS + 1) & 1 == 1;
        let memory = if terminated { StringMemory::ZeroTerminated } else { StringMemory::Counted };
        let capacity = code.cast_unsigned() & ((1 << CAPACITY_BITS) - 1);
        Self { wide: code >> CAPACITY_BITS & 1 == 1, capacity, memory }
    }

    /// The bytes of these characters; what does not fit is cut off.
    pub fn encode(self, units: &[u16]) -> Vec<u8> {
        let used = units.len().min(self.capacity as usize);
        let mut bytes = Vec::with_capacity(self.size() as usize);
        if self.memory == StringMemory::Counted {
            bytes.extend_from_slice(&(used as u16).to_le_bytes());
        }
        for unit in units.iter().take(used) {
            bytes.extend_from_slice(&unit.to_le_bytes()[..self.unit() as usize]);
        }
        bytes.resize(self.size() as usize, 0);
        bytes
    }

    /// How many characters of a string are in use; never more than there is room for, whatever stands in memory.
    pub fn used(self, bytes: &[u8]) -> usize {
        let capacity = self.capacity as usize;
        match self.memory {
            StringMemory::Counted => {
                let count = bytes.first_chunk::<2>().map_or(0, |count| u16::from_le_bytes(*count));
                usize::from(count).min(capacity)
            }
            StringMemory::ZeroTerminated if self.wide => {
                bytes.chunks_exact(2).take(capacity).take_while(|unit| *unit != [0, 0]).count()
            }
            StringMemory::ZeroTerminated => bytes.iter().take(capacity).take_while(|byte| **byte != 0).count(),
        }
    }

    /// The characters of a string in memory.
    pub fn decode(self, bytes: &[u8]) -> Vec<u16> {
        // Bytes of another application, which may be fewer, hold no characters.
        let units = bytes.get(self.first() as usize..).unwrap_or_default().chunks_exact(self.unit() as usize);
        let unit = |unit: &[u8]| unit.iter().rev().fold(0, |whole, byte| whole << 8 | u16::from(*byte));
        units.take(self.used(bytes)).map(unit).collect()
    }
}

/// A function on strings.
#[derive(Debug, Clone)]
pub struct TextCall {
    pub function: TextFunction,
    /// The strings first, then length and position as LINT.
    pub operands: Vec<Expr>,
    /// Where a resulting string is made; it overlaps no operand.
    pub target: Option<Place>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TextFunction {
    /// Characters in use, as [`TextShape::number`] has it.
    Length,
    /// -1, 0 or 1 as DINT: how two strings are ordered, character by character.
    Compare,
    /// Position of the second string in the first, 0 if it is not there.
    Find,
    Edit(Edit),
    /// The text of a value.
    Format(ElementaryType),
    /// The text of a LTIME without sign, as vendors write it: `LTIME#1ns`.
    FormatLongTime,
    /// The value of a text.
    Parse(ElementaryType),
}

/// What makes a string of others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Edit {
    /// The same characters in another type, as far as they fit.
    Fit,
    Left,
    Right,
    Middle,
    Concat,
    Insert,
    Delete,
    Replace,
}

impl Edit {
    /// Every form; the position of a form is its number in calls of the host.
    pub const ALL: [Self; 8] =
        [Self::Fit, Self::Left, Self::Right, Self::Middle, Self::Concat, Self::Insert, Self::Delete, Self::Replace];

    /// How many of the operands are strings.
    pub fn strings(self) -> usize {
        if matches!(self, Self::Concat | Self::Insert | Self::Replace) { 2 } else { 1 }
    }

    /// True if a length stands among the operands.
    pub fn has_length(self) -> bool {
        matches!(self, Self::Left | Self::Right | Self::Middle | Self::Delete | Self::Replace)
    }

    /// True if a position does.
    pub fn has_position(self) -> bool {
        matches!(self, Self::Middle | Self::Insert | Self::Delete | Self::Replace)
    }
}
