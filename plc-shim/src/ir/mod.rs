//! The checked program: every name resolved, every expression typed, every variable placed.
//!
//! Code generation and the runtime read it and look nothing up by name.

pub(crate) mod area;
pub(crate) mod configuration;
pub(crate) mod expr;
mod memory_limit;
pub(crate) mod pou;
pub(crate) mod statement;
pub(crate) mod text;
pub(crate) mod types;
pub(crate) mod value;

/// The types of the ground floor, which are the program's own elementary types.
pub(crate) use onescan_base::elementary::{self, ElementaryType};

pub(crate) use area::{Areas, Location};
pub(crate) use configuration::{Access, Configuration, Entry, Program, Resource, Target, Task};
pub(crate) use expr::{
    Argument, Binary, Cast, Dispatch, Expr, ExprKind, FunctionCall, Intrinsic, LocalId, MemoryFunction, Part, Place,
    Receiver, Rounding, Row, Step, Storage, Unary,
};
pub use memory_limit::{MemoryLimit, MemoryLimitError};
pub(crate) use pou::{EdgeDetection, Guard, Pou, PouId, Retention, Variable, Visibility};
pub(crate) use statement::{
    CaseArm, CaseStatement, ForStatement, IfBranch, InstanceCall, LabelId, Labelled, Statement, StatementKind,
};
pub(crate) use types::{Dimension, Field, Type, TypeId, TypeTable};
pub(crate) use value::Value;
