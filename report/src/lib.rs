//! What a person or a machine is handed after a command: pictures, pages, reports, files.
//!
//! Modules in the order in which data flows through them:
//!
//! | module | subject |
//! |---|---|
//! | [`verdict`], [`severity`] | words that several reports share |
//! | [`colour`] | words in colour on a terminal |
//! | [`number`] | numbers for people |
//! | [`lines`] | text in lines that a terminal shows |
//! | [`table`] | tables, for terminals and pages |
//! | [`plot`] | trajectories as SVG |
//! | [`view`] | a scene from one of its sides as SVG |
//! | [`page`] | one HTML page with everything in it |
//! | [`junit`] | tests, as CI servers read them |
//! | [`sarif`] | findings with their places, as code hosts and editors read them |
//! | [`file`] | files that appear whole or not at all |
//! | [`output`] | standard output |
//!
//! Invariants. Knows no command, no scenario and no session: it owns the data that it draws. What it makes
//! is a pure function of these data, with no clock, no locale and no fonts of the machine; whether words are coloured, the
//! program says once, by what [`colour::suits`] finds of a terminal.

pub mod colour;
pub mod file;
pub mod junit;
pub mod lines;
pub mod number;
pub mod output;
pub mod page;
pub mod plot;
pub mod sarif;
pub mod severity;
pub mod table;
pub mod verdict;
pub mod view;

pub use file::FileError;
pub use output::OutputError;
pub use severity::Severity;
pub use table::Table;
pub use verdict::Verdict;
