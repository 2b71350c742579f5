//! Parameters that take arrays of variable length (3rd ed. 6.5.3).

use crate::syntax::ast::{PouKind, SectionKind};

/// True for parameters that take arrays of any bounds: all of functions and methods, and in-outs of
/// blocks, which could not keep what they are given.
pub(in crate::check) fn takes_open_arrays(unit: PouKind, section: SectionKind) -> bool {
    match section {
        SectionKind::InOut => true,
        SectionKind::Input | SectionKind::Output => matches!(unit, PouKind::Function | PouKind::Method),
        _ => false,
    }
}
