//! Elementary types of IEC 61131-3 (2nd ed. Table 10, 3rd ed. Table 10) and their bytes in an image.
//!
//! All values are little-endian and unpadded. TIME, LTIME and the date types are 64-bit integers:
//! nanoseconds, since midnight for TOD and since 1970-01-01 for DATE and DT. A STRING\[n\] is a
//! 16-bit count of the characters in use and then `n` bytes, zero behind the last character; a
//! WSTRING\[n\] the same with 16-bit code units.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use thiserror::Error;

/// An elementary data type of IEC 61131-3.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ElementaryType {
    /// One byte, 0 or 1.
    Bool,
    /// Bit string of 8.
    Byte,
    /// Bit string of 16.
    Word,
    /// Bit string of 32.
    Dword,
    /// Bit string of 64.
    Lword,
    /// Signed, 8 bits.
    Sint,
    /// Signed, 16 bits.
    Int,
    /// Signed, 32 bits.
    Dint,
    /// Signed, 64 bits.
    Lint,
    /// Unsigned, 8 bits.
    Usint,
    /// Unsigned, 16 bits.
    Uint,
    /// Unsigned, 32 bits.
    Udint,
    /// Unsigned, 64 bits.
    Ulint,
    /// IEC 60559 binary32.
    Real,
    /// IEC 60559 binary64.
    Lreal,
    /// Duration, ns.
    Time,
    /// Duration, ns.
    Ltime,
    /// Date, ns since 1970-01-01.
    Date,
    /// Date, ns since 1970-01-01.
    Ldate,
    /// Time of day, ns since midnight.
    Tod,
    /// Time of day, ns since midnight.
    Ltod,
    /// Date and time of day, ns since 1970-01-01.
    Dt,
    /// Date and time of day, ns since 1970-01-01.
    Ldt,
    /// One 8-bit character.
    Char,
    /// One 16-bit character.
    Wchar,
    /// Up to so many 8-bit characters.
    String(u16),
    /// Up to so many 16-bit characters.
    Wstring(u16),
}

use ElementaryType as T;

/// Every type that has one spelling; strings carry a length and are spelled apart.
const NAMES: [(&str, ElementaryType); 28] = [
    ("BOOL", T::Bool),
    ("BYTE", T::Byte),
    ("WORD", T::Word),
    ("DWORD", T::Dword),
    ("LWORD", T::Lword),
    ("SINT", T::Sint),
    ("INT", T::Int),
    ("DINT", T::Dint),
    ("LINT", T::Lint),
    ("USINT", T::Usint),
    ("UINT", T::Uint),
    ("UDINT", T::Udint),
    ("ULINT", T::Ulint),
    ("REAL", T::Real),
    ("LREAL", T::Lreal),
    ("TIME", T::Time),
    ("LTIME", T::Ltime),
    ("DATE", T::Date),
    ("LDATE", T::Ldate),
    ("TOD", T::Tod),
    ("LTOD", T::Ltod),
    ("DT", T::Dt),
    ("LDT", T::Ldt),
    ("CHAR", T::Char),
    ("WCHAR", T::Wchar),
    ("TIME_OF_DAY", T::Tod),
    ("DATE_AND_TIME", T::Dt),
    ("LDATE_AND_TIME", T::Ldt),
];

impl ElementaryType {
    /// Bytes of one value in an image.
    pub const fn size(self) -> usize {
        match self {
            T::Bool | T::Byte | T::Sint | T::Usint | T::Char => 1,
            T::Word | T::Int | T::Uint | T::Wchar => 2,
            T::Dword | T::Dint | T::Udint | T::Real => 4,
            T::String(capacity) => 2 + capacity as usize,
            T::Wstring(capacity) => 2 + 2 * capacity as usize,
            // All others: the 64-bit integers, LREAL, durations, dates.
            _ => 8,
        }
    }

    /// Natural alignment in bytes.
    pub const fn alignment(self) -> usize {
        match self {
            T::String(_) | T::Wstring(_) => 2,
            other => other.size(),
        }
    }

    /// True for the types whose range of bit patterns is smaller than their bytes allow, or whose
    /// equal values can have unequal bytes. Only these cost a look at every commit.
    pub const fn needs_canonical_form(self) -> bool {
        matches!(self, T::Bool | T::Real | T::Lreal | T::String(_) | T::Wstring(_))
    }

    /// Brings the bytes of one value to their one form: NaN to the quiet NaN with no payload, the
    /// tail of a string to zero.
    ///
    /// # Errors
    /// A BOOL that is neither 0 nor 1, a string longer than its capacity.
    pub fn canonicalise(self, bytes: &mut [u8]) -> Result<(), BadValue> {
        match self {
            T::Bool if bytes[0] > 1 => Err(BadValue::Bool(bytes[0])),
            T::Real => {
                if f32::from_le_bytes(array(bytes)).is_nan() {
                    bytes.copy_from_slice(&CANONICAL_NAN_F32.to_le_bytes());
                }
                Ok(())
            }
            T::Lreal => {
                if f64::from_le_bytes(array(bytes)).is_nan() {
                    bytes.copy_from_slice(&CANONICAL_NAN_F64.to_le_bytes());
                }
                Ok(())
            }
            T::String(capacity) => clear_tail(bytes, capacity, 1),
            T::Wstring(capacity) => clear_tail(bytes, capacity, 2),
            _ => Ok(()),
        }
    }

    /// The value as a number for plots; strings have none.
    pub fn as_f64(self, bytes: &[u8]) -> Option<f64> {
        Some(match self {
            T::Bool | T::Byte | T::Usint | T::Char => f64::from(bytes[0]),
            T::Sint => f64::from(i8::from_le_bytes(array(bytes))),
            T::Word | T::Uint | T::Wchar => f64::from(u16::from_le_bytes(array(bytes))),
            T::Int => f64::from(i16::from_le_bytes(array(bytes))),
            T::Dword | T::Udint => f64::from(u32::from_le_bytes(array(bytes))),
            T::Dint => f64::from(i32::from_le_bytes(array(bytes))),
            T::Lword | T::Ulint => u64::from_le_bytes(array(bytes)) as f64,
            T::Lint => i64::from_le_bytes(array(bytes)) as f64,
            T::Real => f64::from(f32::from_le_bytes(array(bytes))),
            T::Lreal => f64::from_le_bytes(array(bytes)),
            T::Time | T::Ltime | T::Date | T::Ldate | T::Tod | T::Ltod | T::Dt | T::Ldt => {
                i64::from_le_bytes(array(bytes)) as f64 / 1e9
            }
            T::String(_) | T::Wstring(_) => return None,
        })
    }

    /// The value as text for recordings. Floats have as many digits as give the same bits back;
    /// durations are whole nanoseconds; bit strings are decimal; BOOL is 0 or 1.
    pub fn to_text(self, bytes: &[u8]) -> String {
        match self {
            T::Bool | T::Byte | T::Usint => bytes[0].to_string(),
            T::Sint => i8::from_le_bytes(array(bytes)).to_string(),
            T::Word | T::Uint => u16::from_le_bytes(array(bytes)).to_string(),
            T::Int => i16::from_le_bytes(array(bytes)).to_string(),
            T::Dword | T::Udint => u32::from_le_bytes(array(bytes)).to_string(),
            T::Dint => i32::from_le_bytes(array(bytes)).to_string(),
            T::Lword | T::Ulint => u64::from_le_bytes(array(bytes)).to_string(),
            T::Real => f32::from_le_bytes(array(bytes)).to_string(),
            T::Lreal => f64::from_le_bytes(array(bytes)).to_string(),
            T::Lint | T::Time | T::Ltime | T::Date | T::Ldate | T::Tod | T::Ltod | T::Dt | T::Ldt => {
                i64::from_le_bytes(array(bytes)).to_string()
            }
            T::Char => char::from(bytes[0]).to_string(),
            T::Wchar => String::from_utf16_lossy(&[u16::from_le_bytes(array(bytes))]),
            T::String(_) => bytes[2..2 + used(bytes, 1)].iter().copied().map(char::from).collect(),
            T::Wstring(_) => {
                let units: Vec<u16> =
                    bytes[2..2 + used(bytes, 2)].chunks_exact(2).map(|unit| u16::from_le_bytes(array(unit))).collect();
                String::from_utf16_lossy(&units)
            }
        }
    }
}

/// The one NaN that an image may hold as REAL.
pub const CANONICAL_NAN_F32: f32 = f32::from_bits(0x7fc0_0000);
/// The one NaN that an image may hold as LREAL.
pub const CANONICAL_NAN_F64: f64 = f64::from_bits(0x7ff8_0000_0000_0000);

/// Bytes that are no value of their type.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Error)]
pub enum BadValue {
    /// A BOOL byte other than 0 and 1.
    #[error("a BOOL must be 0 or 1, not {0}")]
    Bool(u8),
    /// A string that says it is longer than it can be.
    #[error("a string of capacity {capacity} cannot hold {used} characters")]
    StringLength {
        /// Characters it can hold.
        capacity: u16,
        /// Characters it claims.
        used: u16,
    },
}

/// The first `N` bytes; a layout gives each value exactly its size, so the slice is never shorter.
fn array<const N: usize>(bytes: &[u8]) -> [u8; N] {
    let mut out = [0; N];
    out.copy_from_slice(&bytes[..N]);
    out
}

/// Bytes of the characters in use, never beyond the slice.
fn used(bytes: &[u8], width: usize) -> usize {
    (usize::from(u16::from_le_bytes(array(bytes))) * width).min(bytes.len() - 2)
}

fn clear_tail(bytes: &mut [u8], capacity: u16, width: usize) -> Result<(), BadValue> {
    let count = u16::from_le_bytes(array(bytes));
    if count > capacity {
        return Err(BadValue::StringLength { capacity, used: count });
    }
    bytes[2 + usize::from(count) * width..].fill(0);
    Ok(())
}

impl fmt::Display for ElementaryType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            T::String(capacity) => write!(f, "STRING[{capacity}]"),
            T::Wstring(capacity) => write!(f, "WSTRING[{capacity}]"),
            other => {
                let name = NAMES.iter().find(|(_, ty)| ty == other).map_or("?", |(name, _)| name);
                f.write_str(name)
            }
        }
    }
}

/// A text that names no elementary type.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("`{0}` is not an elementary type of IEC 61131-3 (BOOL, INT, REAL, TIME, STRING[80], …)")]
pub struct UnknownType(pub String);

impl FromStr for ElementaryType {
    type Err = UnknownType;

    fn from_str(text: &str) -> Result<Self, UnknownType> {
        let upper = text.trim().to_ascii_uppercase();
        if let Some((_, ty)) = NAMES.iter().find(|(name, _)| *name == upper) {
            return Ok(*ty);
        }
        let capacity = |prefix: &str| -> Option<u16> {
            let rest = upper.strip_prefix(prefix)?;
            if rest.is_empty() {
                return Some(DEFAULT_STRING_CAPACITY);
            }
            rest.strip_prefix('[')?.strip_suffix(']')?.trim().parse().ok().filter(|n| (1..=32_766).contains(n))
        };
        if let Some(n) = capacity("STRING") {
            return Ok(T::String(n));
        }
        capacity("WSTRING").map(T::Wstring).ok_or_else(|| UnknownType(text.to_owned()))
    }
}

/// Characters of a STRING without a length, as most PLCs have it.
const DEFAULT_STRING_CAPACITY: u16 = 80;

impl Serialize for ElementaryType {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for ElementaryType {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer)?.parse().map_err(serde::de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_reads_back_as_itself() {
        for (_, ty) in NAMES {
            assert_eq!(ty.to_string().parse(), Ok(ty));
        }
        assert_eq!("string[12]".parse(), Ok(T::String(12)));
        assert_eq!("WSTRING".parse(), Ok(T::Wstring(80)));
        assert!("STRING[0]".parse::<ElementaryType>().is_err());
        assert!("FLOAT".parse::<ElementaryType>().is_err());
    }

    #[test]
    fn nan_has_one_form() {
        let mut bytes = f64::from_bits(0xfff0_dead_beef_0001).to_le_bytes();
        T::Lreal.canonicalise(&mut bytes).unwrap();
        assert_eq!(u64::from_le_bytes(bytes), 0x7ff8_0000_0000_0000);
        let mut bytes = (-0.0_f32).to_le_bytes();
        T::Real.canonicalise(&mut bytes).unwrap();
        assert_eq!(bytes, (-0.0_f32).to_le_bytes(), "only NaN is touched");
    }

    #[test]
    fn a_string_has_no_hidden_tail() {
        let mut bytes = *b"\x02\x00abcd";
        T::String(4).canonicalise(&mut bytes).unwrap();
        assert_eq!(&bytes, b"\x02\x00ab\0\0");
        assert_eq!(T::String(4).to_text(&bytes), "ab");
        let mut bytes = *b"\x05\x00abcd";
        assert_eq!(T::String(4).canonicalise(&mut bytes), Err(BadValue::StringLength { capacity: 4, used: 5 }));
    }

    #[test]
    fn a_bool_is_zero_or_one() {
        assert_eq!(T::Bool.canonicalise(&mut [2]), Err(BadValue::Bool(2)));
        assert_eq!(T::Bool.canonicalise(&mut [1]), Ok(()));
    }

    #[test]
    fn text_keeps_the_bits_of_a_float() {
        let value = 0.1_f64 + 0.2;
        let text = T::Lreal.to_text(&value.to_le_bytes());
        assert_eq!(text.parse::<f64>().unwrap().to_bits(), value.to_bits());
    }
}
