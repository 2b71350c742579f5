//! Program organisation units and their variables.

use onescan_base::ElementaryType;

use super::expr::{LocalId, Place, Storage};
use super::statement::Statement;
use super::types::TypeId;
use super::value::Value;
use std::sync::Arc;

use crate::source::Span;
use crate::syntax::ast::{Edge, Qualifier, SectionKind};

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PouId(pub u32);

/// What becomes of a variable when the PLC starts again (2nd ed. 2.4.2, 3rd ed. 6.5.6).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Retention {
    /// `NON_RETAIN`: it gets its initial value at each start.
    NonRetain,
    /// `RETAIN`: it survives a warm start.
    Retain,
    /// `PERSISTENT`, of vendors: it survives a cold start, too.
    Persistent,
}

impl Retention {
    /// What qualifiers say; the longest lived of them.
    pub fn of(qualifiers: &[Qualifier]) -> Option<Self> {
        let each = qualifiers.iter().filter_map(|qualifier| match qualifier {
            Qualifier::NonRetain => Some(Self::NonRetain),
            Qualifier::Retain => Some(Self::Retain),
            Qualifier::Persistent => Some(Self::Persistent),
            Qualifier::Constant | Qualifier::Access(_) | Qualifier::Generic => None,
        });
        each.max()
    }
}

#[derive(Debug, Clone)]
pub struct Variable {
    pub name: String,
    pub section: SectionKind,
    pub ty: TypeId,
    pub storage: Storage,
    /// The value of a `CONSTANT` of elementary type.
    pub constant: Option<Value>,
    pub is_constant: bool,
    /// What its own section says of restarts.
    pub retention: Option<Retention>,
    /// The direct address it is located at, as written.
    pub address: Option<String>,
    pub span: Span,
    pub image: Arc<[u8]>,
    /// Who sees it from outside of its unit.
    pub visibility: Visibility,
    /// The unit that declares it, which a derived one is not.
    pub owner: Option<PouId>,
    /// What the unit itself sees of an input with `R_EDGE` or `F_EDGE`.
    pub edge: Option<EdgeDetection>,
    /// True for the state of the unit's chart, which nothing else writes.
    pub of_chart: bool,
}

/// Who sees a variable or method (3rd ed. 6.6.5.10).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Visibility {
    Public,
    /// The unit and what is derived from it.
    Protected,
    Private,
    Internal,
}

/// What keeps a unit's fixed memory whole if it is called while it runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Guard {
    None,
    /// It has no fixed memory: only the depth of calls is limited.
    Depth,
    /// It is a fault; the flag of running lies at this offset.
    Once(u32),
}

/// Where an input's edge is kept (2nd ed. Table 33): the unit has its own trigger.
#[derive(Debug, Clone, Copy)]
pub struct EdgeDetection {
    pub edge: Edge,
    /// The trigger's memory, a BOOL of the instance.
    pub memory: Storage,
    /// Whether there is an edge in this call.
    pub seen: LocalId,
}

/// A unit ready for code generation.
#[derive(Debug, Clone)]
pub struct Pou {
    pub name: String,
    pub span: Span,
    pub variables: Vec<Variable>,
    /// Elementary types of the registers; parameters first.
    pub registers: Vec<ElementaryType>,
    /// How many of the registers are parameters.
    pub parameters: u32,
    pub result: Option<Place>,
    pub guard: Guard,
    pub body: Vec<Statement>,
}
