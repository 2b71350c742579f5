//! IEC 61131-3 projects as a whole: instrumented, written in other forms, completed, mutated.
//!
//! | module | in | out |
//! |---|---|---|
//! | [`output`] | program text | the files that other tools import |
//! | [`stubs`] | a project | declarations of what it names and nobody declares |
//! | [`instrument`] | a project | the same, made to run in lockstep |
//! | [`mutate`] | a file | the small mistakes that could be in it |
//!
//! Invariants:
//! - source text is the user's property: it is written back byte for byte except where a change was asked for;
//! - an instrumented project with `Simulated := FALSE` behaves exactly as the original;
//! - knows no network, no server and no clock.

pub mod instrument;
pub mod mutate;
pub mod output;
pub mod stubs;
