//! Resolved statements.

use super::expr::{Expr, LocalId, Place};
use super::pou::PouId;
use crate::source::Span;
use std::sync::Arc;

#[derive(Debug, Clone)]
pub struct Statement {
    pub kind: StatementKind,
    pub span: Span,
}

#[derive(Debug, Clone)]
pub enum StatementKind {
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
    /// Runs statements that a fault ends.
    Try(Box<Try>),
    /// Goes on at a label of a [`Labelled`] around.
    Jump(LabelId),
    /// Does nothing; a place that execution comes to.
    Pass,
}

/// Statements that a fault ends without stopping the PLC. They are a function of their own: every variable that they
/// change lies in memory, so that it is as it was at the fault.
#[derive(Debug, Clone)]
pub struct Try {
    pub body: Vec<Statement>,
    /// Holds as a DINT how they ended: one of the numbers below, or the code of the fault, which is greater than 0. All
    /// registers of the unit that `body` reads have lower numbers.
    pub outcome: LocalId,
}

impl Try {
    /// The last of the statements has run.
    pub const ENDED: i32 = 0;
    /// RETURN has left them.
    pub const RETURNED: i32 = -1;
    /// EXIT has left them, out of a loop around.
    pub const EXITED: i32 = -2;
    /// CONTINUE has left them, for the next turn of a loop around.
    pub const CONTINUED: i32 = -3;
}

/// Identifies a label of a unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LabelId(pub u32);

/// Statements that jumps lead into. Execution begins with the first of them and goes on from each
/// part to the next.
#[derive(Debug, Clone)]
pub struct Labelled {
    pub first: Vec<Statement>,
    pub parts: Vec<(LabelId, Vec<Statement>)>,
    /// Holds the part that a jump backwards leads to; nothing if there is none.
    pub register: Option<LocalId>,
}

#[derive(Debug, Clone)]
pub struct IfBranch {
    pub condition: Expr,
    pub body: Vec<Statement>,
}

/// A call of a function block's instance.
#[derive(Debug, Clone)]
pub struct InstanceCall {
    pub instance: Place,
    pub pou: PouId,
    pub dispatch: super::expr::Dispatch,
    /// Holds the instance's address from before the inputs until after the outputs.
    pub pointer: LocalId,
    pub inputs: Vec<Statement>,
    pub outputs: Vec<Statement>,
}

impl InstanceCall {
    /// The call of an instance's body alone: its inputs stay as they are, and nothing takes its outputs.
    pub(crate) fn bare(instance: Place, pou: PouId, pointer: LocalId) -> Self {
        let dispatch = super::expr::Dispatch::Direct;
        Self { instance, pou, dispatch, pointer, inputs: Vec::new(), outputs: Vec::new() }
    }
}

#[derive(Debug, Clone)]
pub struct CaseStatement {
    pub selector: Expr,
    pub register: LocalId,
    pub arms: Vec<CaseArm>,
    pub otherwise: Vec<Statement>,
}

#[derive(Debug, Clone)]
pub struct CaseArm {
    /// Ranges, both ends included.
    pub labels: Vec<(i128, i128)>,
    pub body: Vec<Statement>,
}

/// All expressions are of the variable's type; the step of an unsigned one may be signed. The registers hold the last value and the step
/// as 64 bit numbers.
#[derive(Debug, Clone)]
pub struct ForStatement {
    pub variable: Place,
    pub from: Expr,
    pub to: Expr,
    pub by: Expr,
    pub last: LocalId,
    pub step: LocalId,
    pub body: Vec<Statement>,
}
