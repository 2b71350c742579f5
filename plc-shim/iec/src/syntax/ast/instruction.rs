//! Instruction List (2nd ed. 3.2, 3rd ed. 7.2).
//!
//! Every instruction is a statement; a label is one of its own.

use super::{BinaryOp, Call, Expr, Ident, Statement};

/// When an instruction with the modifier `C` is carried out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum When {
    Always,
    /// `C`: the current result is TRUE.
    True,
    /// `CN`: it is FALSE.
    False,
}

impl When {
    /// The modifier as written behind an operator.
    pub fn text(self) -> &'static str {
        match self {
            Self::Always => "",
            Self::True => "C",
            Self::False => "CN",
        }
    }
}

#[derive(Debug, Clone)]
pub enum Instruction {
    /// `LD x`, `LDN x`
    Load {
        negated: bool,
        /// What becomes the current result.
        value: Expr,
    },
    /// `ST x`, `STN x`
    Store {
        negated: bool,
        /// Where the current result goes.
        target: Expr,
    },
    /// `S x`, or the input S of the instance x.
    Set(Expr),
    /// `R x`, or the input R of the instance x.
    Reset(Expr),
    /// `ADD x`, `ANDN x`, `GT x`; vendors have several operands.
    Operate {
        operator: BinaryOp,
        negated: bool,
        /// The right operands in their order.
        operands: Vec<Expr>,
    },
    /// `AND( .. )`: the operator waits for the result of the instructions between.
    Deferred {
        operator: BinaryOp,
        negated: bool,
        /// The instructions; an operand behind the parenthesis is the first `LD`.
        list: Vec<Statement>,
    },
    Not,
    Jump(When, Ident),
    Return(When),
    /// `CAL instance`, with arguments or without
    Call(When, ListCall),
    /// `LIMIT 0, 10` or `LIMIT(MN := 0, IN := x, MX := 10)`
    Function(ListCall),
    /// `PV counter`: the input of an instance takes the current result, and the instance is called
    /// (2nd ed. Table 54).
    Input(Ident, Expr),
}

/// A call in a list of instructions.
#[derive(Debug, Clone)]
pub struct ListCall {
    /// What is called and its arguments; those of `lists` are missing.
    pub call: Call,
    /// True if the current result is the first argument.
    pub takes_result: bool,
    /// Inputs that instructions give: `IN := ( LD a AND b )`.
    pub lists: Vec<(Ident, Vec<Statement>)>,
}

/// The operators that join the current result and an operand.
pub const OPERATORS: [(&str, BinaryOp); 15] = [
    ("AND", BinaryOp::And),
    ("&", BinaryOp::And),
    ("OR", BinaryOp::Or),
    ("XOR", BinaryOp::Xor),
    ("ADD", BinaryOp::Add),
    ("SUB", BinaryOp::Subtract),
    ("MUL", BinaryOp::Multiply),
    ("DIV", BinaryOp::Divide),
    ("MOD", BinaryOp::Modulo),
    ("GT", BinaryOp::Greater),
    ("GE", BinaryOp::GreaterEqual),
    ("EQ", BinaryOp::Equal),
    ("LE", BinaryOp::LessEqual),
    ("LT", BinaryOp::Less),
    ("NE", BinaryOp::NotEqual),
];

/// Inputs of the standard's function blocks that are operators (2nd ed. Table 54); S, R and LD are others, too.
pub const INPUTS: [&str; 8] = ["S1", "R1", "CLK", "CU", "CD", "PV", "IN", "PT"];
