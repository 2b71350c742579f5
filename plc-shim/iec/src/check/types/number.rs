//! Numbers as dialects have them: bit strings that calculate, TIME in 32 bits.

use crate::dialect::TimeRange;
use crate::ir::{ElementaryType as E, Value};

/// Nanoseconds of the unit in which 32 bit dialects count TIME.
pub(in crate::check) const MS: i128 = 1_000_000;

/// The type that counts TIME in milliseconds; nothing where TIME counts nanoseconds.
pub(in crate::check) fn counter(range: TimeRange) -> Option<E> {
    match range {
        TimeRange::Nanoseconds64 => None,
        TimeRange::Unsigned32 => Some(E::Udint),
        TimeRange::Signed32 => Some(E::Dint),
    }
}

/// The bit string of an integer's size; others as they are.
pub(in crate::check) fn as_bits(ty: E) -> E {
    match ty {
        E::Usint | E::Sint => E::Byte,
        E::Uint | E::Int => E::Word,
        E::Udint | E::Dint => E::Dword,
        E::Ulint | E::Lint => E::Lword,
        other => other,
    }
}

/// The integer type that calculates as a bit string does; others as they are.
pub fn as_number(ty: E) -> E {
    match ty {
        E::Byte => E::Usint,
        E::Word => E::Uint,
        E::Dword => E::Udint,
        E::Lword => E::Ulint,
        other => other,
    }
}

/// True if a constant is the same as one of `ty`.
pub(in crate::check) fn keeps(value: Value, ty: E) -> bool {
    match (value, ty) {
        (Value::Int(value), E::Real) => value as f32 as i128 == value,
        (Value::Int(value), E::Lreal) => value as f64 as i128 == value,
        (Value::Int(value), _) => ty.wrap(value) == value,
        // Whoever writes 0.1 means the nearest.
        _ => true,
    }
}
