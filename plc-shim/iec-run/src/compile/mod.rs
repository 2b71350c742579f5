//! The checked program to one WebAssembly module.
//!
//! | module | subject |
//! |---|---|
//! | [`analyse`] | what is known of the program before code is made of it |
//! | [`emit`] | units and tasks to functions |
//! | [`module`] | sections, functions, exports |
//! | [`host`], [`text_host`], [`trace`] | functions that the host gives |
//! | [`tried`] | statements that a fault ends, as the host runs them |
//! | [`points`] | places whose execution is noted |
//! | [`fault`] | what stops the PLC, and the place in the source that an instruction stands for |
//!
//! Arrows: `module` uses `emit`, `emit` uses `analyse`, which uses the program alone and knows no WebAssembly. The
//! others are lists that each may read. A file of `emit` or `analyse` uses the other room only by what its `mod.rs` gives.

mod analyse;
mod emit;
pub(crate) mod fault;
pub(crate) mod host;
mod module;
pub(crate) mod points;
pub(crate) mod text_host;
pub(crate) mod trace;
pub(crate) mod tried;

pub(crate) use module::{
    BUDGET_EXPORT, Compiled, END_EXPORT, MEMORY_EXPORT, NOTES_EXPORT, Noted, START_EXPORT, compile, entry_export,
};
