//! Parameters with a meaning of their own: EN and ENO (2nd ed. 2.5.1.2), arrays of variable length (3rd ed. 6.5.3).

use crate::ir::Variable;
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

/// The input that decides whether a call is carried out.
pub(in crate::check) const EN: &str = "EN";

/// The output that says whether it was.
pub(in crate::check) const ENO: &str = "ENO";

/// True for what its unit declares as EN or ENO.
pub(in crate::check) fn is_control(variable: &Variable) -> bool {
    match variable.section {
        SectionKind::Input => variable.name.eq_ignore_ascii_case(EN),
        SectionKind::Output => variable.name.eq_ignore_ascii_case(ENO),
        _ => false,
    }
}
