//! Statements report to the host when they begin and end, and decisions which way they go, so that it can
//! say which statement wrote a byte, and why that one. What statements read is reported, too: it leads
//! back to the statement that a value comes from.
//!
//! The end of an assignment says what it has written, as far as that is known; what other
//! statements write the host finds by comparing. Statements of the library are silent: what they
//! write is written by the statement that called them.

use wasm_encoder::ValType;

use super::tried;

/// Module name of the imports.
pub(crate) const MODULE: &str = "trace";
/// A statement, by its point, begins.
pub(crate) const BEGIN: &str = "begin";
/// A statement ends; address and size of what it has written follow, or zeros.
pub(crate) const END: &str = "end";
/// A statement, by its point, goes one of its ways, by the outcome's point.
pub(crate) const CHOOSE: &str = "choose";

/// A place is read; address and size follow.
pub(crate) const READ: &str = "read";

/// The imports, in their order behind all others, with their numbers of parameters.
pub(crate) const IMPORTS: [(&str, usize); 4] = [(BEGIN, 1), (END, 3), (CHOOSE, 2), (READ, 2)];

/// Parameters of an import; there is no result.
pub(crate) fn parameters(count: usize) -> Vec<ValType> {
    vec![ValType::I32; count]
}

/// Function index of the import at this position.
pub(crate) fn index(import: usize) -> u32 {
    debug_assert!(import < IMPORTS.len(), "the host gives no such function");
    tried::index() + 1 + import as u32
}
