//! Values of elementary type.

/// A value; which variants occur follows from the type beside it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Value {
    Bool(bool),
    /// Integers, bit strings, durations in nanoseconds, numbers of enumeration values.
    Int(i128),
    Real(f32),
    Lreal(f64),
}

impl Value {
    /// As an integer, if it is none of the reals.
    pub fn as_int(self) -> Option<i128> {
        match self {
            Self::Bool(value) => Some(i128::from(value)),
            Self::Int(value) => Some(value),
            Self::Real(_) | Self::Lreal(_) => None,
        }
    }

    /// As a real number; integers are rounded to nearest even.
    pub fn as_f64(self) -> f64 {
        match self {
            Self::Bool(value) => f64::from(u8::from(value)),
            Self::Int(value) => value as f64,
            Self::Real(value) => f64::from(value),
            Self::Lreal(value) => value,
        }
    }

    /// Little-endian bytes as they stand in memory, `size` of them at the front.
    pub fn bytes(self) -> [u8; 8] {
        match self {
            Self::Bool(value) => u64::from(value).to_le_bytes(),
            Self::Int(value) => (value as u64).to_le_bytes(),
            Self::Real(value) => u64::from(value.to_bits()).to_le_bytes(),
            Self::Lreal(value) => value.to_bits().to_le_bytes(),
        }
    }
}
