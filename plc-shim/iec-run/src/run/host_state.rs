//! What functions of the host work on.

use wasmtime::{Global, Memory};

use super::trace::Trace;
use crate::application::Application;

/// The module's memory and budget, and what statements are held against.
#[derive(Debug, Default)]
pub(in crate::run) struct HostState {
    /// Set as soon as the module has one.
    pub(in crate::run) memory: Option<Memory>,
    /// What is left of the task's budget of instructions.
    pub(in crate::run) budget: Option<Global>,
    /// What the module was compiled from, by which a trap is known.
    pub(in crate::run) application: Option<Application>,
    /// What statements are held against, if the program is traced.
    pub(in crate::run) trace: Option<Box<Trace>>,
}
