//! Statements (2nd ed. 3.3.2).

use super::{Call, Expr, Ident, Instruction, Span};

/// A statement and its place, the semicolon not included.
#[derive(Debug, Clone)]
pub struct Statement {
    pub kind: StatementKind,
    pub span: Span,
}

/// The forms of a statement.
#[derive(Debug, Clone)]
pub enum StatementKind {
    Empty,
    Assign(Expr, Expr),
    /// `a := b := c`: the targets in their order, at least two, and the value (vendors).
    Chain(Vec<Expr>, Expr),
    /// `a += b`, `a S= b` (vendors).
    Update(UpdateOp, Expr, Expr),
    /// `a S= b R= c`: the targets in their order, at least two, each set or reset by the value at the end (vendors).
    SetReset(Vec<(UpdateOp, Expr)>, Expr),
    /// `a REF= b` of vendors: `a` refers to `b` from now on
    Refer(Expr, Expr),
    /// `a ?= b` (3rd ed. 6.6.6.7)
    Attempt(Expr, Expr),
    /// `fb(IN := x)`
    Call(Call),
    /// `a.b`: a value that goes nowhere (vendors).
    Value(Expr),
    Try(Box<TryStatement>),
    If(IfStatement),
    Case(CaseStatement),
    For(Box<ForStatement>),
    While(WhileStatement),
    Repeat(RepeatStatement),
    Exit,
    /// `CONTINUE` (3rd ed. 7.3.3.4)
    Continue,
    Return,
    /// `name:`, where jumps lead to (2nd ed. 4.1.4; vendors have it in ST).
    Label(Ident),
    Jump(Ident),
    /// One of a list of instructions.
    Instruction(Box<Instruction>),
    /// Text that is not a statement; a diagnostic has been given.
    Error,
}

/// `__TRY … __CATCH(code) … __FINALLY … __ENDTRY` of vendors.
#[derive(Debug, Clone)]
pub struct TryStatement {
    pub body: Vec<Statement>,
    /// The variable that gets the failure's code.
    pub code: Option<Expr>,
    /// What is done when something fails.
    pub handler: Vec<Statement>,
    /// What is done in any case.
    pub finally: Vec<Statement>,
}

/// Assignments that depend on what is there already.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UpdateOp {
    Add,
    Subtract,
    Multiply,
    Divide,
    /// `S=`: TRUE if the value is, else as it was.
    Set,
    /// `R=`: FALSE if the value is TRUE, else as it was.
    Reset,
}

impl UpdateOp {
    /// Its spelling.
    pub fn text(self) -> &'static str {
        match self {
            Self::Add => "+=",
            Self::Subtract => "-=",
            Self::Multiply => "*=",
            Self::Divide => "/=",
            Self::Set => "S=",
            Self::Reset => "R=",
        }
    }
}

/// `IF a THEN .. ELSIF b THEN .. ELSE .. END_IF`
#[derive(Debug, Clone)]
pub struct IfStatement {
    /// `IF` and every `ELSIF`.
    pub branches: Vec<IfBranch>,
    pub otherwise: Vec<Statement>,
}

/// One condition and what it guards.
#[derive(Debug, Clone)]
pub struct IfBranch {
    pub condition: Expr,
    /// What runs if it holds.
    pub body: Vec<Statement>,
}

/// `CASE x OF 1, 3..5: .. ELSE .. END_CASE`
#[derive(Debug, Clone)]
pub struct CaseStatement {
    pub selector: Expr,
    /// The branches in their order.
    pub branches: Vec<CaseBranch>,
    pub otherwise: Vec<Statement>,
}

/// Labels and what they guard.
#[derive(Debug, Clone)]
pub struct CaseBranch {
    pub labels: Vec<CaseLabel>,
    /// What runs if one of them is selected.
    pub body: Vec<Statement>,
}

#[derive(Debug, Clone)]
pub struct CaseLabel {
    /// The only value or the first of the range.
    pub low: Expr,
    /// The last of the range.
    pub high: Option<Expr>,
}

/// `FOR i := a TO b BY c DO .. END_FOR`
#[derive(Debug, Clone)]
pub struct ForStatement {
    /// The control variable; with vendors also a part of one.
    pub variable: Expr,
    pub from: Expr,
    pub to: Expr,
    /// The step; 1 if absent.
    pub by: Option<Expr>,
    pub body: Vec<Statement>,
}

/// `WHILE a DO .. END_WHILE`
#[derive(Debug, Clone)]
pub struct WhileStatement {
    /// Tested before each turn.
    pub condition: Expr,
    pub body: Vec<Statement>,
}

/// `REPEAT .. UNTIL a END_REPEAT`
#[derive(Debug, Clone)]
pub struct RepeatStatement {
    pub body: Vec<Statement>,
    /// Tested after each turn; ends the loop if it holds.
    pub until: Expr,
}
