//! Program organisation units and their variables.

use onescan_base::ElementaryType;

use super::expr::{LocalId, Place, Storage};
use super::statement::Statement;
use super::types::TypeId;
use super::value::Value;
use std::sync::Arc;

use crate::source::Span;
use crate::syntax::ast::{Edge, Qualifier, SectionKind};

/// Identifies a unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct PouId(pub(crate) u32);

/// What becomes of a variable when the PLC starts again (2nd ed. 2.4.2, 3rd ed. 6.5.6).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Retention {
    /// `NON_RETAIN`: it begins anew.
    NonRetain,
    /// `RETAIN`: it survives a warm start.
    Retain,
    /// `PERSISTENT`, of vendors: it survives a cold start, too.
    Persistent,
}

impl Retention {
    /// What qualifiers say; the longest lived of them.
    pub(crate) fn of(qualifiers: &[Qualifier]) -> Option<Self> {
        let each = qualifiers.iter().filter_map(|qualifier| match qualifier {
            Qualifier::NonRetain => Some(Self::NonRetain),
            Qualifier::Retain => Some(Self::Retain),
            Qualifier::Persistent => Some(Self::Persistent),
            Qualifier::Constant | Qualifier::Access(_) | Qualifier::Generic => None,
        });
        each.max()
    }
}

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
    /// What its own section says of restarts.
    pub(crate) retention: Option<Retention>,
    /// The direct address it is located at, as written.
    pub(crate) address: Option<String>,
    pub(crate) span: Span,
    /// Initial bytes.
    pub(crate) image: Arc<[u8]>,
    /// Who sees it from outside of its unit.
    pub(crate) visibility: Visibility,
    /// The unit that declares it, which a derived one is not.
    pub(crate) owner: Option<PouId>,
    /// What the unit itself sees of an input with `R_EDGE` or `F_EDGE`.
    pub(crate) edge: Option<EdgeDetection>,
    /// True for the state of the unit's chart, which nothing else writes.
    pub(crate) of_chart: bool,
}

/// Who sees a variable or method (3rd ed. 6.6.5.10).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Visibility {
    Public,
    /// The unit and what is derived from it.
    Protected,
    /// The unit alone.
    Private,
    /// The namespace.
    Internal,
}

/// What keeps a unit's fixed memory whole if it is called while it runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Guard {
    /// It cannot be.
    None,
    /// It has no fixed memory: only the depth of calls is limited.
    Depth,
    /// It is a fault; the flag of running lies at this offset.
    Once(u32),
}

/// Where an input's edge is kept (2nd ed. Table 33): the unit has its own trigger.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EdgeDetection {
    pub(crate) edge: Edge,
    /// The trigger's memory, a BOOL of the instance.
    pub(crate) memory: Storage,
    /// Whether there is an edge in this call.
    pub(crate) seen: LocalId,
}

/// A unit ready for code generation.
#[derive(Debug, Clone)]
pub(crate) struct Pou {
    pub(crate) name: String,
    pub(crate) span: Span,
    pub(crate) variables: Vec<Variable>,
    /// Elementary types of the registers; parameters first.
    pub(crate) registers: Vec<ElementaryType>,
    /// How many of the registers are parameters.
    pub(crate) parameters: u32,
    /// A function's result.
    pub(crate) result: Option<Place>,
    pub(crate) guard: Guard,
    pub(crate) body: Vec<Statement>,
}
