//! The ground floor of onescan: what both the session (`onescan-server`) and the PLC (`onescan-iec`) stand on.
//!
//! | module | subject |
//! |---|---|
//! | [`time`] | virtual time, integer nanoseconds |
//! | [`duration`] | the text forms of durations: `10 ms`, `T#1s500ms`, `PT0.02S` |
//! | [`elementary`] | the elementary types of IEC 61131-3: names, sizes, ranges, conversions |
//! | [`signal_type`] | the types that a signal can have: the elementary types, strings with a length, lines of bytes |
//! | [`field`] | members of structures, `Name: TYPE` |
//! | [`byte_line`] | one direction of a line of bytes as the value of a signal |
//! | [`value`] | values of these types: their bytes, and the text that recordings hold |
//! | [`array`] | names with a range, as in `arm[0..9].hold` |
//! | [`nearest`] | the name that was probably meant |
//! | [`regular`] | files that are read: regular ones, up to a limit |
//! | [`disk`] | files that are written, so that a disk that refuses can be tried |
//! | [`lines`] | files of lines that grow at their end |
//! | [`notice`] | the target of log events that are for the user |
//! | [`repeated`] | events that others cause as often as they like, reported a few times |
//! | [`threads`] | threads, which a system may refuse |
//! | [`foreign`] | text from outside, made fit to be shown |
//!
//! Invariants: plain data and pure functions, except in [`regular`], [`disk`] and [`lines`], which read and write files, and [`threads`]. No clock, no random number,
//! no iteration in hash order, and no dependency except serde, thiserror and strsim, and on
//! Linux rustix, which opens what [`regular`] has found.

pub mod array;
pub mod byte_line;
pub mod disk;
pub mod duration;
pub mod elementary;
pub mod field;
pub mod foreign;
pub mod lines;
pub mod nearest;
pub mod notice;
pub mod regular;
pub mod repeated;
pub mod signal_type;
pub mod threads;
pub mod time;
pub mod value;

pub use elementary::ElementaryType;
pub use nearest::{did_you_mean, nearest};
pub use signal_type::SignalType;
pub use time::{TimeSpan, VirtualTime};
