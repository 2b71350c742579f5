//! Expressions (2nd ed. 3.3.1).

use super::{Ident, Span, TypeSpec};
use crate::syntax::calendar::CalendarKind;

/// Greatest height of an expression's tree. The parser keeps to it, so that later passes may
/// recurse into an expression without exhausting the stack.
pub const MAX_HEIGHT: u16 = 250;

/// Levels that a chain counts for, however long it is: the checker makes trees of so many of its operators.
pub const CHAIN_HEIGHT: u16 = 16;

/// An expression and its place.
#[derive(Debug, Clone)]
pub struct Expr {
    pub kind: ExprKind,
    pub span: Span,
    /// Nodes on the longest way down, this one counted; at most [`MAX_HEIGHT`].
    pub height: u16,
}

impl Expr {
    /// `THIS` or `SUPER`: the object itself, which a caret after it does not change.
    pub fn names_the_object(&self) -> bool {
        matches!(&self.kind, ExprKind::Name(name) if matches!(name.key().as_str(), "THIS" | "SUPER"))
    }

    /// `THIS^` or `SUPER^`; of the object without the caret vendors have a pointer.
    pub fn names_the_object_by_caret(&self) -> bool {
        self.names_the_object() && matches!(&self.kind, ExprKind::Name(name) if name.span != self.span)
    }
}

/// The forms of an expression.
#[derive(Debug, Clone)]
pub enum ExprKind {
    Literal(Literal),
    Name(Ident),
    /// `%IX1.0`, as written.
    DirectAddress(String),
    Member(Box<Expr>, Ident),
    /// `a.%X3`, `a.%B1`, `a.3`: the part as written (3rd ed. Table 17)
    Part(Box<Expr>, Ident),
    Dereference(Box<Expr>),
    Index(Box<Expr>, Vec<Expr>),
    /// `f(x, y)`, `f(IN := x, Q => y)`
    Call(Call),
    Unary(UnaryOp, Box<Expr>),
    Binary(BinaryOp, Box<Expr>, Box<Expr>),
    /// `a + b + c - d ..`, from the left to the right: what would be too high a tree of [`Self::Binary`].
    Chain(Box<Expr>, Vec<Link>),
    Paren(Box<Expr>),
    /// `a := b` as a value, in a condition or between parentheses (vendors).
    Assign(Box<Expr>, Box<Expr>),
    /// `POINTER TO T`, a type where vendors want one: in `SIZEOF` and `__NEW`.
    Type(Box<TypeSpec>),
    /// Text that is not an expression; a diagnostic has been given.
    Error,
}

/// An operator of a chain and what stands behind it.
#[derive(Debug, Clone)]
pub struct Link {
    /// What is done with all that is before it.
    pub operator: BinaryOp,
    pub operand: Expr,
}

/// A call of a function or an instance.
#[derive(Debug, Clone)]
pub struct Call {
    pub callee: Box<Expr>,
    /// The arguments in their order.
    pub arguments: Vec<Argument>,
}

/// One argument of a call.
#[derive(Debug, Clone)]
pub enum Argument {
    Positional(Expr),
    Input(Ident, Expr),
    /// `Q => x`, `NOT Q => x`
    Output {
        name: Ident,
        /// True for `NOT Q => x` (2nd ed. 3.2.3).
        negated: bool,
        /// Where it goes; nothing for `Q =>`.
        target: Option<Expr>,
    },
}

/// A constant as written.
#[derive(Debug, Clone, PartialEq)]
pub enum Literal {
    Bool(bool),
    Integer(i128),
    Real(f64),
    /// `INT#5`, `BOOL#TRUE`, `Colour#Red`
    Typed {
        /// What stands before the `#`.
        prefix: String,
        /// What stands behind it.
        value: TypedValue,
    },
    /// `T#1s`, `LTIME#1ns`
    Duration {
        /// True for `LT#` and `LTIME#`.
        long: bool,
        /// Its length in nanoseconds.
        ns: i64,
    },
    /// `LTIME#200000d`: nanoseconds that only a LTIME without sign has.
    LongDuration(u64),
    /// `D#1994-06-15`, `TOD#15:36:55.36`, `DT#1994-06-15-15:36:55.36`
    Calendar {
        /// What it stands for.
        kind: CalendarKind,
        /// True for the L-forms of the 3rd edition.
        long: bool,
        /// Nanoseconds since 1970-01-01 or midnight.
        ns: i64,
        text: String,
    },
    /// `'...'` or `"..."`, quotes and escapes as written.
    String(String),
}

/// What stands behind the `#` of a typed literal.
#[derive(Debug, Clone, PartialEq)]
pub enum TypedValue {
    /// `5`, `16#FF`, `-5`
    Integer(i128),
    Real(f64),
    Name(String),
    /// `'...'` or `"..."`, quotes and escapes as written.
    Text(String),
}

/// Operators with one operand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UnaryOp {
    Negate,
    /// `+`, which 2nd ed. Annex B lacks and every vendor allows
    Plus,
    Not,
}

/// Operators with two operands (2nd ed. Table 52).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BinaryOp {
    Power,
    Multiply,
    Divide,
    Modulo,
    Add,
    Subtract,
    Less,
    Greater,
    LessEqual,
    GreaterEqual,
    Equal,
    NotEqual,
    And,
    Xor,
    Or,
    /// `AND_THEN`: the right operand is evaluated only if the left one is TRUE (vendors).
    AndThen,
    /// `OR_ELSE`: the right operand is evaluated only if the left one is FALSE (vendors).
    OrElse,
}

impl BinaryOp {
    /// How tightly it binds; a greater number binds tighter (2nd ed. Table 52).
    pub fn precedence(self) -> u8 {
        match self {
            Self::Or | Self::OrElse => 1,
            Self::Xor => 2,
            Self::And | Self::AndThen => 3,
            Self::Equal | Self::NotEqual => 4,
            Self::Less | Self::Greater | Self::LessEqual | Self::GreaterEqual => 5,
            Self::Add | Self::Subtract => 6,
            Self::Multiply | Self::Divide | Self::Modulo => 7,
            Self::Power => 9,
        }
    }

    /// True for what gives BOOL whatever it compares.
    pub fn is_comparison(self) -> bool {
        matches!(self.precedence(), 4 | 5)
    }

    /// Its spelling.
    pub fn text(self) -> &'static str {
        match self {
            Self::Power => "**",
            Self::Multiply => "*",
            Self::Divide => "/",
            Self::Modulo => "MOD",
            Self::Add => "+",
            Self::Subtract => "-",
            Self::Less => "<",
            Self::Greater => ">",
            Self::LessEqual => "<=",
            Self::GreaterEqual => ">=",
            Self::Equal => "=",
            Self::NotEqual => "<>",
            Self::And => "AND",
            Self::Xor => "XOR",
            Self::Or => "OR",
            Self::AndThen => "AND_THEN",
            Self::OrElse => "OR_ELSE",
        }
    }
}
