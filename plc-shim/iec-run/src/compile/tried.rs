//! The host's part in statements that a fault ends: it calls them, and says how they have ended.

use wasm_encoder::ValType;

use super::fault::FaultKind;
use super::{host, text_host};

/// Module name of the import.
pub(crate) const MODULE: &str = "tried";
/// Its name: it runs the statements with a number and gives their outcome.
pub(crate) const RUN: &str = "run";

/// Function index of the import, behind those that every program may call.
pub(crate) fn index() -> u32 {
    (host::IMPORTS.len() + text_host::IMPORTS.len()) as u32
}

/// Parameters and results of the import.
pub(crate) fn signature() -> (Vec<ValType>, Vec<ValType>) {
    (vec![ValType::I32], vec![ValType::I32])
}

/// Name of the export of the statements with this number.
pub(crate) fn export(number: u32) -> String {
    format!("try_{number}")
}

/// The code of a fault that `__CATCH` takes, a value of `__SYSTEM.ExceptionCode`. What a watchdog would end, and what
/// is wrong with the program as a whole, stops the PLC.
pub(crate) fn exception_code(kind: FaultKind) -> Option<i32> {
    match kind {
        FaultKind::DivisionByZero => Some(0x102),
        FaultKind::IndexOutOfRange | FaultKind::SelectorOutOfRange | FaultKind::OutOfSubrange => Some(0x101),
        FaultKind::NullReference | FaultKind::InvalidPointer => Some(0x51),
        FaultKind::ZeroStep
        | FaultKind::EndlessLoop
        | FaultKind::CallTooDeep
        | FaultKind::Internal
        | FaultKind::Reentered => None,
    }
}
