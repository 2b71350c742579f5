//! Configurations: resources, tasks and what they run (2nd ed. 2.7).

use onescan_base::TimeSpan;

use super::expr::Storage;
use super::pou::{Pou, PouId, Retention, Variable};
use super::types::TypeId;
use crate::syntax::direct_address::Area;

/// An instance of a program.
#[derive(Debug, Clone)]
pub struct Program {
    /// The instance's name; the program's own without a configuration.
    pub name: String,
    pub pou: PouId,
    pub offset: u32,
    /// The resource it belongs to.
    pub resource: Option<usize>,
    pub retention: Option<Retention>,
    /// True if a unit calls it, as some vendors allow: then no task runs it unless one names it.
    pub is_called: bool,
    /// True for an organization block that the start calls, once: no task may run it.
    pub runs_at_start: bool,
}

/// What a task can run: an instance of a program with its connections, or an instance of a function
/// block that has a task of its own. Those of the programs come first, in the programs' order.
#[derive(Debug, Clone)]
pub struct Entry {
    /// The name by which a task runs it: the shortest that no other entry has.
    pub name: String,
    /// Called one after the other, without parameters; forced values are set in between.
    pub units: Vec<Pou>,
}

/// The one configuration of an application.
#[derive(Debug, Clone)]
pub struct Configuration {
    pub name: String,
    pub resources: Vec<Resource>,
    pub access: Vec<Access>,
}

/// A resource with its tasks.
#[derive(Debug, Clone)]
pub struct Resource {
    /// Nothing if it is the configuration's only one.
    pub name: Option<String>,
    pub tasks: Vec<Task>,
    /// Entries without a task.
    pub background: Vec<usize>,
    /// The global variables that it does not share with others.
    pub globals: Vec<Variable>,
}

/// A task (2nd ed. 2.7.2, Table 50).
#[derive(Debug, Clone)]
pub struct Task {
    pub name: String,
    /// Path of the BOOL whose rising edges trigger it.
    pub single: Option<String>,
    /// Nothing if it is not periodic.
    pub interval: Option<TimeSpan>,
    pub priority: u32,
    pub entries: Vec<usize>,
}

/// A name that `VAR_ACCESS` gives to a variable.
#[derive(Debug, Clone)]
pub struct Access {
    pub name: String,
    pub target: Target,
    pub writable: bool,
}

/// A variable, or a part of one, at a fixed place.
#[derive(Debug, Clone)]
pub struct Target {
    /// Its path from the outside.
    pub path: String,
    /// `Absolute(0)` or a direct address.
    pub storage: Storage,
    pub inside: u32,
    pub ty: TypeId,
    /// The declaration that the last name on the way leads to; nothing for a program.
    pub variable: Option<Variable>,
    /// The area of the open address, as in `AT %I*`, of the last name on the way that has one.
    pub open: Option<Area>,
}

impl Target {
    /// The bit of its byte, if it is one.
    pub fn bit(&self) -> Option<u8> {
        match self.storage {
            Storage::Located(location) => location.bit,
            _ => None,
        }
    }
}
