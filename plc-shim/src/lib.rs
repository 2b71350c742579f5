//! IEC 61131-3 program text, read, checked, compiled and run.
//!
//! | module | in | out |
//! |---|---|---|
//! | [`dialect`] | | what vendors do their own way, as a table |
//! | [`input`] | files as they are found | program text, and the way back into the file |
//! | [`source`] | names and texts | files, places in them |
//! | [`syntax`] | text | tokens and a tree, without loss |
//! | [`diagnostic`] | findings | messages with code, place and hint |
//! | [`explain`] | codes | the page behind each |
//! | `ir` | | the checked program's form |
//! | `check` | trees | the checked program, findings |
//! | `lint` | trees | warnings of what is legal and seldom meant |
//! | `compile` | the checked program | one WebAssembly module, and the source behind each trap |
//! | [`application`] | files | all of the above in one value |
//! | `output` | program text | the files that other tools import |
//! | [`stubs`] | a project | declarations of what it names and nobody declares |
//! | [`instrument`] | a project | the same, made to run in lockstep |
//! | [`mutate`] | a file | the small mistakes that could be in it |
//! | [`run`] | an application and a task plan | a soft PLC that scans |
//! | [`coverage`] | what has been executed | reports of it |
//!
//! Invariants:
//! - knows no network, no server and no clock: virtual time is given to each scan;
//! - parsing never fails, it returns a tree and a list of diagnostics;
//! - no program text and no running program can make it panic or exhaust the stack: depth is
//!   bounded by the parser, and every error of a running program is a [`PlcFault`];
//! - equal text, plan and inputs give equal bytes in memory, on every machine;
//! - names are resolved once, before the program runs; a scan looks up nothing and allocates
//!   nothing.

pub mod application;
mod check;
mod compile;
pub mod coverage;
pub mod diagnostic;
pub mod dialect;
pub mod explain;
pub mod input;
pub mod instrument;
mod ir;
mod lint;
pub mod mutate;
mod output;
pub mod run;
pub mod source;
pub mod stubs;
pub mod syntax;

pub use application::{
    Application, BuildError, Builder, CodeDifference, ConstantError, Declaration, Program, Radix, UnknownVariable,
    Variable, VariableAccess, VariableDifference, WriteError, ZeroTerminated, without_home,
};
pub use compile::fault::FaultKind;
pub use coverage::Coverage;
pub use diagnostic::{Code, Diagnostic, Diagnostics, Finding, Severity};
pub use dialect::Dialect;
pub use input::Input;
pub use ir::{MemoryLimit, MemoryLimitError};
pub use lint::{inspect, inspect_within};
pub use onescan_base::{ElementaryType, SignalType, TimeSpan, VirtualTime};
pub use run::{
    Act, CodePolicy, FaultSite, LateError, PlanDifference, PlcFault, RestoreError, RunError, SoftPlc, Statement,
    StatementId, Task, TaskPlan, Way, WayId, WriteSite, Wrote,
};
