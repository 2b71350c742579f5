//! Everything that joins a onescan session: a plant, a soft PLC.
//!
//! | module | subject |
//! |---|---|
//! | [`plant`] | the simulated machine: a scene of rigid bodies, driven axes and sensors |
//! | [`soft_plc`] | the embedded soft PLC, which runs IEC 61131-3 source text |
//! | [`array`] | names with a range, as in `arm[0..9].hold` |
//! | [`replay`] | a client that repeats what another once did |
//! | [`operator`] | switches and set points that nobody else writes |
//! | [`forced`] | a client some of whose outputs are held for a time |
//!
//! # Invariants
//! - A client is a function of its state, its inputs and `t_v`. Nothing here reads a clock, a random
//!   source, a thread's identity or the order of a hash map.
//! - Transcendental functions come from `libm`, at set-up as well as in a turn.
//! - Files are read before a session; nothing here opens a socket or starts a thread.
//! - Bad input is an error with a place, never a panic.

pub mod array;
pub mod forced;
pub mod operator;
pub mod plant;
pub mod replay;
pub mod soft_plc;
