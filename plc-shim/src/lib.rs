//! IEC 61131-3 program text, read, checked, compiled and run.

pub mod diagnostic;
pub mod syntax;
