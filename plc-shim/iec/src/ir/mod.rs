//! The checked program: every name resolved, every expression typed, every variable placed.
//!
//! Code generation and the runtime read it and look nothing up by name.

pub mod area;
pub mod configuration;
pub mod expr;
mod memory_limit;
pub mod place_use;
pub mod pou;
pub mod statement;
pub mod text;
pub mod types;
pub mod value;
pub mod walk;

/// The types of the ground floor, which are the program's own elementary types.
pub use onescan_base::elementary::{self, ElementaryType};

pub use area::{Areas, Location};
pub use configuration::{Access, Configuration, Entry, Program, Resource, Target, Task};
pub use expr::{
    Argument, Binary, Cast, Dispatch, Expr, ExprKind, FunctionCall, Intrinsic, LocalId, MemoryFunction, Part, Place,
    Receiver, Rounding, Row, Step, Storage, Unary,
};
pub use memory_limit::{MemoryLimit, MemoryLimitError};
pub use place_use::{PlaceUse, place_uses};
pub use pou::{EdgeDetection, Guard, Pou, PouId, Retention, Variable, Visibility};
pub use statement::{
    CaseArm, CaseStatement, ForStatement, IfBranch, InstanceCall, LabelId, Labelled, Statement, StatementKind, Try,
};
pub use types::{Dimension, Field, Type, TypeId, TypeTable};
pub use value::Value;
