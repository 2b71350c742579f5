//! Character strings and the functions on them (2nd ed. 2.3.1 Table 10, 2.5.1.5.5).
//!
//! A string lies in memory as a 16 bit count of the characters in use, then room for all that it
//! may hold, zero behind the last: one byte for a character of STRING (ISO 8859-1), two for one
//! of WSTRING (UTF-16).

use onescan_base::ElementaryType;

use super::expr::{Expr, Place};

/// Most characters of a string, so that every position is an INT.
pub(crate) const MAX_CAPACITY: u16 = 32_767;

/// Width and capacity of a string type.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct TextShape {
    pub(crate) wide: bool,
    pub(crate) capacity: u16,
}

impl TextShape {
    /// Bytes of one character.
    pub(crate) fn unit(self) -> u32 {
        if self.wide { 2 } else { 1 }
    }

    /// Bytes in memory.
    pub(crate) fn size(self) -> u32 {
        2 + u32::from(self.capacity) * self.unit()
    }

    /// The keyword.
    pub(crate) fn keyword(self) -> &'static str {
        if self.wide { "WSTRING" } else { "STRING" }
    }

    /// As one number, for calls of the host.
    pub(crate) fn code(self) -> i32 {
        i32::from(self.capacity) | i32::from(self.wide) << 16
    }

    /// What [`Self::code`] made.
    pub(crate) fn from_code(code: i32) -> Self {
        Self { wide: code >> 16 & 1 == 1, capacity: code as u16 }
    }

    /// The bytes of these characters; what does not fit is cut off.
    pub(crate) fn encode(self, units: &[u16]) -> Vec<u8> {
        let used = units.len().min(usize::from(self.capacity));
        let mut bytes = Vec::with_capacity(self.size() as usize);
        bytes.extend_from_slice(&(used as u16).to_le_bytes());
        for unit in units.iter().take(used) {
            bytes.extend_from_slice(&unit.to_le_bytes()[..self.unit() as usize]);
        }
        bytes.resize(self.size() as usize, 0);
        bytes
    }
}

/// A function on strings.
#[derive(Debug, Clone)]
pub(crate) struct TextCall {
    pub(crate) function: TextFunction,
    /// The strings first, then length and position as LINT.
    pub(crate) operands: Vec<Expr>,
    /// Where a resulting string is made; it overlaps no operand.
    pub(crate) target: Option<Place>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TextFunction {
    /// Characters in use, as INT.
    Length,
    /// -1, 0 or 1 as DINT: how two strings are ordered, character by character.
    Compare,
    /// Position of the second string in the first as INT, 0 if it is not there.
    Find,
    Edit(Edit),
    /// The text of a value.
    Format(ElementaryType),
    /// The value of a text.
    Parse(ElementaryType),
}

/// What makes a string of others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Edit {
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
    pub(crate) const ALL: [Self; 8] =
        [Self::Fit, Self::Left, Self::Right, Self::Middle, Self::Concat, Self::Insert, Self::Delete, Self::Replace];

    /// How many of the operands are strings.
    pub(crate) fn strings(self) -> usize {
        if matches!(self, Self::Concat | Self::Insert | Self::Replace) { 2 } else { 1 }
    }

    /// True if a length stands among the operands.
    pub(crate) fn has_length(self) -> bool {
        matches!(self, Self::Left | Self::Right | Self::Middle | Self::Delete | Self::Replace)
    }

    /// True if a position does.
    pub(crate) fn has_position(self) -> bool {
        matches!(self, Self::Middle | Self::Insert | Self::Delete | Self::Replace)
    }
}
