//! Direct addresses, `%IX0.0`, `%MW10` (2nd ed. 2.4.1.1, Table 15; 3rd ed. 6.5.5, Table 16).

use thiserror::Error;

use crate::dialect::AddressUnit;

/// Most bytes of an area.
pub const AREA_LIMIT: u32 = 1 << 20;

/// A part of memory that is reached by direct addresses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Area {
    Input,
    Output,
    Memory,
}

impl Area {
    pub const ALL: [Self; 3] = [Self::Input, Self::Output, Self::Memory];

    /// Its letter.
    pub fn letter(self) -> char {
        match self {
            Self::Input => 'I',
            Self::Output => 'Q',
            Self::Memory => 'M',
        }
    }
}

/// How much a direct address takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Width {
    /// `X` or no letter
    Bit,
    Byte,
    Word,
    Dword,
    Lword,
}

impl Width {
    /// The width of this letter, in any case.
    pub fn find(letter: char) -> Option<Self> {
        Some(match letter.to_ascii_uppercase() {
            'X' => Self::Bit,
            'B' => Self::Byte,
            'W' => Self::Word,
            'D' => Self::Dword,
            'L' => Self::Lword,
            _ => return None,
        })
    }

    /// Bits.
    pub fn bits(self) -> u32 {
        match self {
            Self::Bit => 1,
            Self::Byte => 8,
            Self::Word => 16,
            Self::Dword => 32,
            Self::Lword => 64,
        }
    }

    /// Bytes that hold it.
    pub fn bytes(self) -> u32 {
        self.bits().div_ceil(8)
    }
}

/// Where in its area an address lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Position {
    /// `*`: another place says so (2nd ed. 2.4.3.1, `VAR_CONFIG`).
    Open,
    /// `%MW3`, `%Q75`: a count of units of the width.
    Number(u32),
    /// `%IX2.7`: a byte and a bit of it.
    Bit(u32, u8),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DirectAddress {
    pub area: Area,
    pub width: Width,
    pub position: Position,
}

/// Why a text is not a direct address.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum AddressError {
    /// The area's letter is missing.
    #[error("a direct address begins with %I, %Q or %M")]
    Area,
    /// The width's letter is none.
    #[error("behind the area stands X, B, W, D, L or a number")]
    Width,
    /// There is no number.
    #[error("a number is missing")]
    Number,
    /// More numbers than a place in one area has.
    #[error("an address has one number, a bit's address a byte and a bit")]
    Levels,
    #[error("a byte has the bits 0 to 7")]
    Bit,
    /// The letter of an area, or an open place, where a member stands.
    #[error("a member's address counts from the beginning of its structure, as in %B4 or %X4.0")]
    Relative,
    #[error("an area ends at byte {}", AREA_LIMIT - 1)]
    TooLarge,
}

impl DirectAddress {
    /// Reads an address as written, with its `%`.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn parse(text: &str) -> Result<Self, AddressError> {
        let mut letters = text.strip_prefix('%').unwrap_or(text).chars();
        let area = match letters.next().map(|letter| letter.to_ascii_uppercase()) {
            Some('I') => Area::Input,
            Some('Q') => Area::Output,
            Some('M') => Area::Memory,
            _ => return Err(AddressError::Area),
        };
        let rest = letters.as_str();
        let (width, rest) = match letters.next() {
            Some(letter) if letter.is_ascii_alphabetic() => {
                (Width::find(letter).ok_or(AddressError::Width)?, letters.as_str())
            }
            _ => (Width::Bit, rest),
        };
        Ok(Self { area, width, position: position(width, rest)? })
    }

    /// True for an address of more levels than a place in an area has, as in `%IW2.5.7.1` (2nd ed. 2.4.1.1, Table 15):
    /// rack, module and channel, whose order the standard leaves to the maker.
    pub fn is_hierarchical(text: &str) -> bool {
        let width = text.chars().nth(2).and_then(Width::find);
        let levels = text.split('.').count();
        let numbers = text.trim_start_matches(|letter: char| !letter.is_ascii_digit()).split('.');
        let deepest = if width.is_none_or(|width| width == Width::Bit) { 2 } else { 1 };
        levels > deepest && numbers.clone().all(|level| number(level).is_ok())
    }

    /// The area and width of a hierarchical address.
    ///
    /// # Errors
    /// What is wrong with its letters.
    pub fn parse_hierarchical(text: &str) -> Result<(Area, Width), AddressError> {
        let end = text.find('.').unwrap_or(text.len());
        Self::parse(text.get(..end).unwrap_or(text)).map(|first| (first.area, first.width))
    }

    /// First byte and, of a bit, its number in that byte; nothing if the place is open.
    ///
    /// # Errors
    /// It lies beyond [`AREA_LIMIT`].
    pub fn place(self, unit: AddressUnit) -> Result<Option<(u32, Option<u8>)>, AddressError> {
        place(self.width, self.position, unit)
    }
}

/// Where a member lies in its structure: `%B4`, `%X3.0` (3rd ed. 6.4.4.6, Table 11).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RelativeAddress {
    pub width: Width,
    pub byte: u32,
    /// Of a bit, its number in that byte.
    pub bit: Option<u8>,
}

impl RelativeAddress {
    /// Reads an address as written, with its `%`.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn parse(text: &str, unit: AddressUnit) -> Result<Self, AddressError> {
        let text = text.strip_prefix('%').unwrap_or(text);
        let width = text.chars().next().and_then(Width::find).ok_or(AddressError::Relative)?;
        let position = position(width, text.get(1..).unwrap_or_default())?;
        let (byte, bit) = place(width, position, unit)?.ok_or(AddressError::Relative)?;
        Ok(Self { width, byte, bit })
    }
}

/// First byte and bit of a place in its area; nothing if it is open.
fn place(width: Width, position: Position, unit: AddressUnit) -> Result<Option<(u32, Option<u8>)>, AddressError> {
    let (byte, bit) = match (position, width) {
        (Position::Open, _) => return Ok(None),
        (Position::Bit(byte, bit), _) => (byte, Some(bit)),
        (Position::Number(number), Width::Bit) => (number / 8, Some((number % 8) as u8)),
        (Position::Number(number), width) => {
            let scale = if unit == AddressUnit::Element { width.bytes() } else { 1 };
            (number.checked_mul(scale).ok_or(AddressError::TooLarge)?, None)
        }
    };
    let end = byte.checked_add(width.bytes()).filter(|end| *end <= AREA_LIMIT);
    end.map(|_| Some((byte, bit))).ok_or(AddressError::TooLarge)
}

fn position(width: Width, text: &str) -> Result<Position, AddressError> {
    if text == "*" {
        return Ok(Position::Open);
    }
    let mut numbers = text.split('.').map(number);
    let first = numbers.next().unwrap_or(Err(AddressError::Number))?;
    match (numbers.next(), numbers.next()) {
        (None, _) => Ok(Position::Number(first)),
        (Some(bit), None) if width == Width::Bit => match bit? {
            bit @ 0..=7 => Ok(Position::Bit(first, bit as u8)),
            _ => Err(AddressError::Bit),
        },
        _ => Err(AddressError::Levels),
    }
}

fn number(text: &str) -> Result<u32, AddressError> {
    if text.is_empty() || !text.bytes().all(|byte| byte.is_ascii_digit()) {
        return Err(AddressError::Number);
    }
    // Only what is too long is left.
    text.parse().map_err(|_| AddressError::TooLarge)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(text: &str, unit: AddressUnit) -> Result<Option<(u32, Option<u8>)>, AddressError> {
        DirectAddress::parse(text)?.place(unit)
    }

    #[test]
    fn iec2_2_4_1_1_table_15_an_address_is_an_area_a_width_and_a_place() {
        use AddressUnit::{Byte, Element};
        for (text, element, byte) in [
            ("%IX0.0", (0, Some(0)), (0, Some(0))),
            ("%qx2.7", (2, Some(7)), (2, Some(7))),
            ("%I3.4", (3, Some(4)), (3, Some(4))),
            ("%Q75", (9, Some(3)), (9, Some(3))),
            ("%MB5", (5, None), (5, None)),
            ("%MW5", (10, None), (5, None)),
            ("%MD5", (20, None), (5, None)),
            ("%ML5", (40, None), (5, None)),
        ] {
            assert_eq!(place(text, Element), Ok(Some(element)), "{text}");
            assert_eq!(place(text, Byte), Ok(Some(byte)), "{text}");
        }
        assert_eq!(place("%IW*", Element), Ok(None));
    }

    #[test]
    fn iec3_table_11_members_have_addresses_in_their_structure() {
        let parse = |text| RelativeAddress::parse(text, AddressUnit::Element);
        let at = |width, byte, bit| Ok(RelativeAddress { width, byte, bit });
        assert_eq!(parse("%B25"), at(Width::Byte, 25, None));
        assert_eq!(parse("%x3.7"), at(Width::Bit, 3, Some(7)));
        assert_eq!(parse("%W2"), at(Width::Word, 4, None));
        assert_eq!(RelativeAddress::parse("%W2", AddressUnit::Byte), at(Width::Word, 2, None));
        for (text, error) in [
            ("%IX0.0", AddressError::Relative),
            ("%5", AddressError::Relative),
            ("%B*", AddressError::Relative),
            ("%B", AddressError::Number),
            ("%X1.8", AddressError::Bit),
            ("%B1.2", AddressError::Levels),
            ("%L999999", AddressError::TooLarge),
        ] {
            assert_eq!(parse(text), Err(error), "{text}");
        }
    }

    #[test]
    fn what_is_no_address_is_reported() {
        for (text, error) in [
            ("%", AddressError::Area),
            ("%Z1", AddressError::Area),
            ("%IY1", AddressError::Width),
            ("%IX", AddressError::Number),
            ("%IX1.", AddressError::Number),
            ("%MW1.2", AddressError::Levels),
            ("%IX1.2.3", AddressError::Levels),
            ("%IX1.8", AddressError::Bit),
            ("%MB1048576", AddressError::TooLarge),
            ("%MD262144", AddressError::TooLarge),
            ("%MB99999999999", AddressError::TooLarge),
        ] {
            assert_eq!(place(text, AddressUnit::Element), Err(error), "{text}");
        }
        assert_eq!(place("%MB1048575", AddressUnit::Element), Ok(Some((1_048_575, None))));
    }
}
