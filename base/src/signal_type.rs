//! The types that a signal can have: the elementary types, strings with a length, and lines of bytes.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use thiserror::Error;

use crate::elementary::ElementaryType;

/// Characters of a STRING without a length, as most PLCs have it.
pub const DEFAULT_STRING_CAPACITY: u16 = 80;

/// The longest string: 32,766 two-byte characters and their count are just below 64 KiB.
pub const STRING_CAPACITY_MAX: u16 = 32_766;

/// Bytes of a line's window whose length is not written.
pub const DEFAULT_WINDOW: u16 = 64;

/// The longest window of a line: a step of it and what comes with it are below 64 KiB.
pub const WINDOW_MAX: u16 = 32_766;

/// Bytes of a line's value before its window: [`crate::byte_line`].
pub(crate) const LINE_HEADER: usize = 28;

/// Bytes of the value of a line with a window of so many bytes.
#[inline] // of the size of a type, which is asked for in every step
#[must_use]
pub const fn line_size(window: u16) -> usize {
    LINE_HEADER + window as usize + (window as usize).div_ceil(8)
}

/// The type of a signal, as the session and its clients agree on it. In files and on the wire it is its name.
///
/// ```
/// use onescan_base::{ElementaryType, SignalType};
///
/// assert_eq!("LTIME_OF_DAY".parse(), Ok(SignalType::LTOD));
/// assert_eq!("STRING[12]".parse(), Ok(SignalType::String(12)));
/// assert_eq!(SignalType::from(ElementaryType::Int), SignalType::INT);
/// assert_eq!(SignalType::String(12).size(), 14);
/// assert_eq!(SignalType::String(12).to_string(), "STRING[12]");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum SignalType {
    /// An elementary type of a fixed size.
    Elementary(ElementaryType),
    /// Up to so many 8-bit characters.
    String(u16),
    /// Up to so many 16-bit characters.
    Wstring(u16),
    /// One direction of a line of bytes, with a window of so many: [`crate::byte_line`].
    Bytes(u16),
}

macro_rules! constants {
    ($($constant:ident $variant:ident),* $(,)?) => {
        impl SignalType {
            $(
                #[doc = concat!("[`ElementaryType::", stringify!($variant), "`]")]
                pub const $constant: Self = Self::Elementary(ElementaryType::$variant);
            )*
        }
    };
}

constants! {
    BOOL Bool, BYTE Byte, WORD Word, DWORD Dword, LWORD Lword, SINT Sint, INT Int, DINT Dint, LINT Lint, USINT Usint,
    UINT Uint, UDINT Udint, ULINT Ulint, REAL Real, LREAL Lreal, TIME Time, LTIME Ltime, DATE Date, LDATE Ldate,
    TOD Tod, LTOD Ltod, DT Dt, LDT Ldt, CHAR Char, WCHAR Wchar,
}

impl SignalType {
    /// Bytes of one value in an image.
    #[inline] // asked for every signal in every step, from another crate
    pub const fn size(self) -> usize {
        match self {
            Self::Elementary(ty) => ty.size() as usize,
            Self::String(capacity) => 2 + capacity as usize,
            Self::Wstring(capacity) => 2 + 2 * capacity as usize,
            Self::Bytes(window) => line_size(window),
        }
    }

    /// The type of strings of up to `capacity` characters; nothing if a signal cannot have so few or so many.
    ///
    /// ```
    /// # use onescan_base::SignalType;
    /// assert_eq!(SignalType::string(12), Some(SignalType::String(12)));
    /// assert_eq!(SignalType::string(0), None);
    /// ```
    #[must_use]
    pub fn string(capacity: u16) -> Option<Self> {
        (1..=STRING_CAPACITY_MAX).contains(&capacity).then_some(Self::String(capacity))
    }

    /// As [`SignalType::string`], of 16-bit characters.
    #[must_use]
    pub fn wstring(capacity: u16) -> Option<Self> {
        (1..=STRING_CAPACITY_MAX).contains(&capacity).then_some(Self::Wstring(capacity))
    }

    /// The type of a line of bytes with a window of `window`; nothing if a signal cannot have so few or so many.
    #[must_use]
    pub fn bytes(window: u16) -> Option<Self> {
        (1..=WINDOW_MAX).contains(&window).then_some(Self::Bytes(window))
    }

    /// Natural alignment in bytes.
    pub const fn alignment(self) -> usize {
        match self {
            Self::Elementary(ty) => ty.size() as usize,
            Self::String(_) | Self::Wstring(_) => 2,
            Self::Bytes(_) => 1,
        }
    }

    /// True for strings, which have no value as a number.
    pub const fn is_text(self) -> bool {
        matches!(self, Self::String(_) | Self::Wstring(_))
    }
}

impl From<ElementaryType> for SignalType {
    fn from(ty: ElementaryType) -> Self {
        Self::Elementary(ty)
    }
}

impl fmt::Display for SignalType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Elementary(ty) => ty.fmt(f),
            Self::String(capacity) => write!(f, "STRING[{capacity}]"),
            Self::Wstring(capacity) => write!(f, "WSTRING[{capacity}]"),
            Self::Bytes(window) => write!(f, "BYTES[{window}]"),
        }
    }
}

/// A text that names no type of a signal.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("`{0}` is not an elementary type of IEC 61131-3 (BOOL, INT, REAL, TIME, STRING[80], …), nor BYTES[64]")]
pub struct UnknownType(pub String);

impl FromStr for SignalType {
    type Err = UnknownType;

    fn from_str(text: &str) -> Result<Self, UnknownType> {
        let upper = text.trim().to_ascii_uppercase();
        if let Some(ty) = ElementaryType::find(&upper) {
            return Ok(Self::Elementary(ty));
        }
        let capacity = |keyword: &str, default: u16| -> Option<u16> {
            let rest = upper.strip_prefix(keyword)?;
            if rest.is_empty() {
                return Some(default);
            }
            rest.strip_prefix('[')?.strip_suffix(']')?.trim().parse().ok()
        };
        let string = || capacity("STRING", DEFAULT_STRING_CAPACITY).and_then(Self::string);
        let wstring = || capacity("WSTRING", DEFAULT_STRING_CAPACITY).and_then(Self::wstring);
        let bytes = || capacity("BYTES", DEFAULT_WINDOW).and_then(Self::bytes);
        string().or_else(wstring).or_else(bytes).ok_or_else(|| UnknownType(text.to_owned()))
    }
}

impl Serialize for SignalType {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for SignalType {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer)?.parse().map_err(serde::de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_reads_back_as_itself() {
        for ty in ElementaryType::ALL.iter().copied().map(SignalType::from) {
            assert_eq!(ty.to_string().parse(), Ok(ty));
            assert_eq!(ty.size(), ty.alignment());
        }
        assert_eq!(" string[12]".parse(), Ok(SignalType::String(12)));
        assert_eq!("WSTRING".parse(), Ok(SignalType::Wstring(80)));
        assert_eq!("Bytes".parse(), Ok(SignalType::Bytes(64)));
        assert_eq!("BYTES[1026]".parse(), Ok(SignalType::Bytes(1026)));
        assert_eq!("ldate_and_time".parse(), Ok(SignalType::LDT));
        for wrong in ["STRING[0]", "STRING[32767]", "STRING[x]", "BYTES[0]", "BYTES[32767]", "STRING[", "FLOAT", ""] {
            assert!(wrong.parse::<SignalType>().is_err(), "{wrong}");
        }
    }
}
