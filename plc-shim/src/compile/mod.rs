//! The checked program to one WebAssembly module.
//!
//! | module | subject |
//! |---|---|
//! | [`module`] | sections, functions, exports |
//! | [`function`] | one unit to one function |
//! | [`entry`] | what a task runs |
//! | [`emitter`], [`registers`] | instructions, labels, marks; locals |
//! | [`frame`], [`inline`] | a unit's own terms; calls, and units put in their place |
//! | [`cost`], [`calls`], [`reach`], [`budget`] | what units cost and may change, and how endless loops end |
//! | [`address`], [`place`], [`part`], [`pointer`], [`open_array`], [`memory`] | addresses, loads and stores |
//! | [`known`], [`effect`], [`survey`] | values that registers hold already, also through loops |
//! | [`interval`], [`range`], [`refine`], [`drift`] | between what integers lie: expressions, variables, behind conditions, in loops |
//! | [`statement`], [`selection`], [`choice`], [`repetition`], [`counting`], [`jump`] | statements |
//! | [`expression`], [`arithmetic`], [`conversion`], [`intrinsic`], [`bytes`] | expressions |
//! | [`dispatch`] | methods: which one runs |
//! | [`host`] | functions that WebAssembly lacks |
//! | [`text`], [`text_host`] | character strings |
//! | [`points`], [`trace`] | what is noted for coverage; statements as they run |
//! | [`fault`] | what stops the PLC, and the place in the source that an instruction stands for |
//!
//! Integers of up to 32 bits are held in an `i32`, sign- or zero-extended from their width;
//! whatever makes one keeps to that.

mod address;
mod arithmetic;
mod budget;
mod bytes;
mod calls;
mod choice;
mod conversion;
mod cost;
mod counting;
mod dispatch;
mod drift;
mod effect;
mod emitter;
mod entry;
mod expression;
pub(crate) mod fault;
mod frame;
mod function;
pub(crate) mod host;
mod inline;
mod interval;
mod intrinsic;
mod jump;
mod known;
mod memory;
mod module;
mod open_array;
mod part;
mod place;
mod pointer;
pub(crate) mod points;
mod range;
mod reach;
mod refine;
mod registers;
mod repetition;
mod selection;
mod statement;
mod survey;
mod text;
pub(crate) mod text_host;
pub(crate) mod trace;

pub(crate) use budget::BUDGET_EXPORT;
pub(crate) use module::{
    Compiled, END_EXPORT, MEMORY_EXPORT, NOTES_EXPORT, Noted, START_EXPORT, compile, entry_export,
};
