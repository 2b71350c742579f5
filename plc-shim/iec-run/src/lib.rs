//! Checked IEC 61131-3 programs, compiled and run.
//!
//! | module | in | out |
//! |---|---|---|
//! | `compile` | the checked program | one WebAssembly module, and the source behind each trap |
//! | [`application`] | files | front end and compiler in one value |
//! | [`run`] | an application and a task plan | a soft PLC that scans |
//! | [`coverage`] | what has been executed | reports of it |
//!
//! Invariants:
//! - knows no network, no server and no clock: virtual time is given to each scan;
//! - no running program can make it panic or exhaust the stack: every error is a [`PlcFault`];
//! - equal text, plan and inputs give equal bytes in memory, on every machine;
//! - a scan looks up nothing and allocates nothing.

pub mod application;
mod compile;
pub mod coverage;
pub mod run;

pub use application::{
    Application, BuildError, Builder, CodeDifference, Declaration, MemorySet, OpenInput, Program, Radix,
    UnknownVariable, Variable, VariableAccess, VariableDifference, WriteError, ZeroTerminated, literal, without_home,
};
pub use compile::fault::FaultKind;
pub use coverage::Coverage;
pub use run::{
    Act, CodePolicy, FaultSite, LateError, PlanDifference, PlcFault, RestoreError, RunError, SoftPlc, Statement,
    StatementId, Way, WayId, WriteSite, Wrote,
};

/// The code of the README is compiled and run as a test of documents.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;
