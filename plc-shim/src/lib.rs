//! IEC 61131-3 program text, read, checked, compiled and run.
#![allow(dead_code)]

mod check;
pub mod diagnostic;
mod ir;
pub mod syntax;
