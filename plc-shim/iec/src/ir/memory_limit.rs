//! How much memory all variables of a PLC may take together.

use std::fmt;
use std::str::FromStr;

/// A limit in MiB, 64 if nobody says otherwise.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct MemoryLimit {
    mib: u32,
}

/// Why a number is not a limit.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum MemoryLimitError {
    /// It is 0, or more than the addresses of a PLC reach.
    #[error("{0} MiB is not a limit: from 1 to {greatest} MiB can be addressed", greatest = MemoryLimit::GREATEST_MIB)]
    OutOfRange(u32),
    /// It is not a number.
    #[error("`{0}` is not a whole number of MiB")]
    NotANumber(String),
}

impl MemoryLimit {
    /// The memory of a PLC has 32-bit addresses; half of them, so that no sum of two offsets overflows.
    pub const GREATEST_MIB: u32 = 2047;

    /// A limit of so many MiB, from 1 to [`Self::GREATEST_MIB`].
    ///
    /// # Errors
    /// None, or more than can be addressed.
    pub fn of_mib(mib: u32) -> Result<Self, MemoryLimitError> {
        if (1..=Self::GREATEST_MIB).contains(&mib) { Ok(Self { mib }) } else { Err(MemoryLimitError::OutOfRange(mib)) }
    }

    /// The limit in MiB.
    pub fn mib(self) -> u32 {
        self.mib
    }

    /// The limit in bytes.
    pub fn bytes(self) -> u32 {
        self.mib << 20
    }
}

impl Default for MemoryLimit {
    fn default() -> Self {
        Self { mib: 64 }
    }
}

impl fmt::Display for MemoryLimit {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{} MiB", self.mib)
    }
}

impl FromStr for MemoryLimit {
    type Err = MemoryLimitError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text.parse::<u32>() {
            Ok(mib) => Self::of_mib(mib),
            Err(_) => Err(MemoryLimitError::NotANumber(text.to_owned())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_addressed_is_no_limit() {
        assert_eq!(MemoryLimit::default().bytes(), 64 << 20);
        assert_eq!("2047".parse().map(MemoryLimit::bytes), Ok(2047 << 20));
        for text in ["0", "2048", "4294967295"] {
            assert!(matches!(text.parse::<MemoryLimit>(), Err(MemoryLimitError::OutOfRange(_))), "{text}");
        }
        for text in ["", "-1", "64 MiB", "1.5", "4294967296"] {
            assert!(matches!(text.parse::<MemoryLimit>(), Err(MemoryLimitError::NotANumber(_))), "{text}");
        }
    }
}
