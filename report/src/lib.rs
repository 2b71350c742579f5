//! What a person or a machine is handed after a command: pictures and files.
//!
//! | module | subject |
//! |---|---|
//! | [`plot`] | trajectories as SVG |
//! | [`file`] | files that appear whole or not at all |
//!
//! Invariants. Knows no command, no scenario and no session: it owns the data that it draws. What it makes
//! is a pure function of these data, with no clock, no locale and no fonts of the machine.

pub mod file;
pub mod plot;

pub use file::FileError;
