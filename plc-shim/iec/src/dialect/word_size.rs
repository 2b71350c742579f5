//! Of how many bits the registers of the target are.

use std::fmt;
use std::str::FromStr;

use onescan_base::ElementaryType;

/// Bits of the target's registers. What it computes is a matter of the dialect: see
/// [`IntegerWidth`](super::IntegerWidth).
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum WordSize {
    /// An operation on integers of 64 bits takes two registers.
    Bits32,
    #[default]
    Bits64,
}

/// Why something is not a word size.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not a word size: 32 or 64 bits")]
pub struct UnknownWordSize(String);

impl WordSize {
    /// The word size of so many bits.
    ///
    /// # Errors
    /// No target has it.
    pub fn of_bits(bits: u32) -> Result<Self, UnknownWordSize> {
        match bits {
            32 => Ok(Self::Bits32),
            64 => Ok(Self::Bits64),
            other => Err(UnknownWordSize(other.to_string())),
        }
    }

    /// Bits of a register: 32 or 64.
    pub fn bits(self) -> u32 {
        match self {
            Self::Bits32 => 32,
            Self::Bits64 => 64,
        }
    }

    /// The type that fills a register, with a sign or without.
    pub fn register(self, is_signed: bool) -> ElementaryType {
        match (self, is_signed) {
            (Self::Bits32, true) => ElementaryType::Dint,
            (Self::Bits32, false) => ElementaryType::Udint,
            (Self::Bits64, true) => ElementaryType::Lint,
            (Self::Bits64, false) => ElementaryType::Ulint,
        }
    }
}

impl fmt::Display for WordSize {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}", self.bits())
    }
}

impl FromStr for WordSize {
    type Err = UnknownWordSize;

    fn from_str(text: &str) -> Result<Self, UnknownWordSize> {
        text.parse().map_err(|_| UnknownWordSize(text.to_owned())).and_then(Self::of_bits)
    }
}
