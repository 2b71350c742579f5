//! IEC 61131-3 program text: read without loss, checked, explained.
//!
//! | module | in | out |
//! |---|---|---|
//! | [`dialect`] | | what vendors do their own way, as a table |
//! | [`source`] | names and texts | files, places in them |
//! | [`diagnostic`] | findings | messages with code, place and help |
//! | [`syntax`] | text | tokens and a tree, without loss |
//! | [`input`] | files as they are found | program text, and the way back into the file |
//! | [`task_plan`] | | which tasks run which programs |
//! | [`ir`] | | the checked program's form |
//! | [`check`] | trees | the checked program, findings |
//! | [`front`] | files | trees and the checked program, library included |
//! | [`lint`] | trees | warnings of what is legal and seldom meant |
//! | [`explain`] | codes | the page behind each |
//!
//! Invariants:
//! - runs nothing, and knows no network, no server and no clock;
//! - parsing never fails: it returns a tree and a list of findings, because people check half-written programs;
//! - no program text can make it panic or exhaust the stack: the parser bounds the depth;
//! - every place in program text leads back into the file it was taken from;
//! - names are resolved once, here; whoever compiles or runs the result looks up nothing.

pub mod check;
pub mod diagnostic;
pub mod dialect;
pub mod explain;
pub mod front;
pub mod input;
pub mod ir;
pub mod lint;
pub mod source;
pub mod syntax;
pub mod task_plan;

pub use diagnostic::{Code, Diagnostic, Diagnostics, Finding, Severity};
pub use dialect::{Dialect, WordSize};
pub use front::ConstantError;
pub use input::Input;
pub use ir::{MemoryLimit, MemoryLimitError};
pub use lint::{inspect, inspect_within};
pub use onescan_base::{ElementaryType, SignalType, TimeSpan, VirtualTime};
pub use task_plan::{Task, TaskPlan};
