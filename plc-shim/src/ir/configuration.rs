//! Configurations: resources, tasks and what they run (2nd ed. 2.7).

use onescan_base::TimeSpan;

use super::expr::Storage;
use super::pou::{Pou, PouId, Retention, Variable};
use super::types::TypeId;
use crate::syntax::direct_address::Area;

/// An instance of a program.
#[derive(Debug, Clone)]
pub(crate) struct Program {
    /// The instance's name; the program's own without a configuration.
    pub(crate) name: String,
    pub(crate) pou: PouId,
    pub(crate) offset: u32,
    /// The resource it belongs to.
    pub(crate) resource: Option<usize>,
    pub(crate) retention: Option<Retention>,
    /// True if a unit calls it, as some vendors allow: then no task runs it unless one names it.
    pub(crate) is_called: bool,
}

/// What a task can run: an instance of a program with its connections, or an instance of a function
/// block that has a task of its own. Those of the programs come first, in the programs' order.
#[derive(Debug, Clone)]
pub(crate) struct Entry {
    /// The name by which a task runs it: the shortest that no other entry has.
    pub(crate) name: String,
    /// Called one after the other, without parameters; forced values are set in between.
    pub(crate) units: Vec<Pou>,
}

/// The one configuration of an application.
#[derive(Debug, Clone)]
pub(crate) struct Configuration {
    pub(crate) name: String,
    pub(crate) resources: Vec<Resource>,
    pub(crate) access: Vec<Access>,
}

/// A resource with its tasks.
#[derive(Debug, Clone)]
pub(crate) struct Resource {
    /// Nothing if it is the configuration's only one.
    pub(crate) name: Option<String>,
    pub(crate) tasks: Vec<Task>,
    /// Entries without a task.
    pub(crate) background: Vec<usize>,
    /// The global variables that it does not share with others.
    pub(crate) globals: Vec<Variable>,
}

/// A task (2nd ed. 2.7.2, Table 50).
#[derive(Debug, Clone)]
pub(crate) struct Task {
    pub(crate) name: String,
    /// Path of the BOOL whose rising edges trigger it.
    pub(crate) single: Option<String>,
    /// Nothing if it is not periodic.
    pub(crate) interval: Option<TimeSpan>,
    pub(crate) priority: u32,
    pub(crate) entries: Vec<usize>,
}

/// A name that `VAR_ACCESS` gives to a variable.
#[derive(Debug, Clone)]
pub(crate) struct Access {
    pub(crate) name: String,
    pub(crate) target: Target,
    pub(crate) writable: bool,
}

/// A variable, or a part of one, at a fixed place.
#[derive(Debug, Clone)]
pub(crate) struct Target {
    /// Its path from the outside.
    pub(crate) path: String,
    /// `Absolute(0)` or a direct address.
    pub(crate) storage: Storage,
    /// Bytes from there.
    pub(crate) inside: u32,
    pub(crate) ty: TypeId,
    /// The declaration that the last name on the way leads to; nothing for a program.
    pub(crate) variable: Option<Variable>,
    /// The area of the open address, as in `AT %I*`, of the last name on the way that has one.
    pub(crate) open: Option<Area>,
}

impl Target {
    /// The bit of its byte, if it is one.
    pub(crate) fn bit(&self) -> Option<u8> {
        match self.storage {
            Storage::Located(location) => location.bit,
            _ => None,
        }
    }
}
