//! Program organisation units and their variables.

use super::elementary::ElementaryType;
use super::expr::{Place, Storage};
use super::statement::Statement;
use super::types::TypeId;
use super::value::Value;
use std::sync::Arc;

use crate::syntax::Span;
use crate::syntax::ast::{PouKind, SectionKind};

/// Identifies a unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct PouId(pub(crate) u32);

/// A declared variable.
#[derive(Debug, Clone)]
pub(crate) struct Variable {
    pub(crate) name: String,
    pub(crate) section: SectionKind,
    pub(crate) ty: TypeId,
    pub(crate) storage: Storage,
    /// The value of a `CONSTANT` of elementary type.
    pub(crate) constant: Option<Value>,
    pub(crate) is_constant: bool,
    pub(crate) retain: bool,
    /// The direct address it is located at, as written.
    pub(crate) address: Option<String>,
    pub(crate) span: Span,
    /// Initial bytes.
    pub(crate) image: Arc<[u8]>,
}

/// A unit ready for code generation.
#[derive(Debug, Clone)]
pub(crate) struct Pou {
    pub(crate) name: String,
    pub(crate) kind: PouKind,
    pub(crate) span: Span,
    pub(crate) variables: Vec<Variable>,
    /// Elementary types of the registers; parameters first.
    pub(crate) registers: Vec<ElementaryType>,
    /// How many of the registers are parameters.
    pub(crate) parameters: u32,
    /// A function's result.
    pub(crate) result: Option<Place>,
    pub(crate) body: Vec<Statement>,
}

/// The one instance of a program.
#[derive(Debug, Clone)]
pub(crate) struct Program {
    pub(crate) pou: PouId,
    pub(crate) offset: u32,
}
