//! Resolved statements.

use super::expr::{Expr, LocalId, Place};
use super::pou::PouId;
use crate::source::Span;
use std::sync::Arc;

#[derive(Debug, Clone)]
pub(crate) struct Statement {
    pub(crate) kind: StatementKind,
    pub(crate) span: Span,
}

#[derive(Debug, Clone)]
pub(crate) enum StatementKind {
    /// Elementary types.
    Assign(Place, Expr),
    /// Aggregates: the expression yields the source's address.
    Copy(Place, Expr),
    /// Stores the second place's address in the first.
    Bind(Place, Place),
    /// Gives a temporary aggregate its initial bytes.
    Initialise(Place, Arc<[u8]>),
    /// A function called for its effects.
    Evaluate(Expr),
    CallInstance(Box<InstanceCall>),
    If(Vec<IfBranch>, Vec<Statement>),
    Case(Box<CaseStatement>),
    For(Box<ForStatement>),
    While(Expr, Vec<Statement>),
    Repeat(Vec<Statement>, Expr),
    Exit,
    Continue,
    Return,
    Labelled(Box<Labelled>),
    /// Goes on at a label of a [`Labelled`] around.
    Jump(LabelId),
    /// Does nothing; a place that execution comes to.
    Pass,
}

/// Identifies a label of a unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct LabelId(pub(crate) u32);

/// Statements that jumps lead into. Execution begins with the first of them and goes on from each
/// part to the next.
#[derive(Debug, Clone)]
pub(crate) struct Labelled {
    pub(crate) first: Vec<Statement>,
    pub(crate) parts: Vec<(LabelId, Vec<Statement>)>,
    /// Holds the part that a jump backwards leads to; nothing if there is none.
    pub(crate) register: Option<LocalId>,
}

#[derive(Debug, Clone)]
pub(crate) struct IfBranch {
    pub(crate) condition: Expr,
    pub(crate) body: Vec<Statement>,
}

/// A call of a function block's instance.
#[derive(Debug, Clone)]
pub(crate) struct InstanceCall {
    pub(crate) instance: Place,
    pub(crate) pou: PouId,
    pub(crate) dispatch: super::expr::Dispatch,
    /// Holds the instance's address from before the inputs until after the outputs.
    pub(crate) pointer: LocalId,
    pub(crate) inputs: Vec<Statement>,
    pub(crate) outputs: Vec<Statement>,
}

#[derive(Debug, Clone)]
pub(crate) struct CaseStatement {
    pub(crate) selector: Expr,
    pub(crate) register: LocalId,
    pub(crate) arms: Vec<CaseArm>,
    pub(crate) otherwise: Vec<Statement>,
}

#[derive(Debug, Clone)]
pub(crate) struct CaseArm {
    /// Ranges, both ends included.
    pub(crate) labels: Vec<(i128, i128)>,
    pub(crate) body: Vec<Statement>,
}

/// All expressions are of the variable's type; the step of an unsigned one may be signed. The registers hold the last value and the step
/// as 64 bit numbers.
#[derive(Debug, Clone)]
pub(crate) struct ForStatement {
    pub(crate) variable: Place,
    pub(crate) from: Expr,
    pub(crate) to: Expr,
    pub(crate) by: Expr,
    pub(crate) last: LocalId,
    pub(crate) step: LocalId,
    pub(crate) body: Vec<Statement>,
}
