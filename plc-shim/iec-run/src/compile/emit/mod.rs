//! Units and tasks to functions of WebAssembly, by what [`analyse`](super::analyse) has found.
//!
//! | module | subject |
//! |---|---|
//! | [`function`], [`entry`] | one unit to one function; what a task runs |
//! | [`emitter`] | the function that is being made |
//! | [`statement`], [`selection`], [`choice`], [`repetition`], [`counting`], [`jump`] | statements |
//! | [`tried`] | statements that a fault ends, as functions of their own |
//! | [`inline`], [`dispatch`] | calls, units put in their place; methods: which one runs |
//! | [`expression`], [`arithmetic`], [`conversion`], [`intrinsic`], [`bytes`] | expressions |
//! | [`place`], [`part`], [`pointer`], [`open_array`], [`memory`] | addresses and what lies there |
//! | [`text`] | character strings |
//! | [`cover`], [`trace`] | what is noted for coverage; statements as they run |
//!
//! Every statement is emitted once. Integers of up to 32 bits are held in an `i32`, sign- or zero-extended from
//! their width; whatever makes one keeps to that.

mod arithmetic;
mod bytes;
mod choice;
mod conversion;
mod counting;
mod cover;
mod dispatch;
mod emitter;
mod entry;
mod expression;
mod function;
mod inline;
mod intrinsic;
mod jump;
mod memory;
mod open_array;
mod part;
mod place;
mod pointer;
mod repetition;
mod selection;
mod statement;
mod text;
mod trace;
mod tried;

pub(super) use dispatch::{place_rows, table};
pub(super) use emitter::{Made, Shared, globals, value_type};
pub(super) use entry::{function as entry_function, only_instances};
pub(super) use function::unit;
