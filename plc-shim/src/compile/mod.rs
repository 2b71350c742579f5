//! The checked program to one WebAssembly module.
//!
//! | module | subject |
//! |---|---|
//! | [`module`] | sections, functions, exports |
//! | [`function`] | one unit to one function |
//! | [`entry`] | what a task runs |
//! | [`emitter`] | instructions, registers, labels, marks |
//! | [`place`], [`part`], [`pointer`], [`open_array`] | addresses, loads and stores |
//! | [`statement`], [`repetition`] | statements |
//! | [`expression`], [`arithmetic`], [`conversion`], [`intrinsic`], [`bytes`] | expressions |
//! | [`dispatch`] | methods: which one runs |
//! | [`host`] | functions that WebAssembly lacks |
//! | [`text`], [`text_host`] | character strings |
//! | [`fault`] | what stops the PLC, and the place in the source that an instruction stands for |
//!
//! Integers of up to 32 bits are held in an `i32`, sign- or zero-extended from their width;
//! whatever makes one keeps to that.

mod arithmetic;
mod bytes;
mod conversion;
mod dispatch;
mod emitter;
mod entry;
mod expression;
pub(crate) mod fault;
mod function;
pub(crate) mod host;
mod intrinsic;
mod module;
mod open_array;
mod part;
mod place;
mod pointer;
mod repetition;
mod statement;
mod text;
pub(crate) mod text_host;

pub(crate) use module::{Compiled, MEMORY_EXPORT, compile, entry_export};
