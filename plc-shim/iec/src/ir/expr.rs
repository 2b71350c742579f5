//! Typed expressions and the places that hold values.

use onescan_base::ElementaryType;

use super::area::Location;
use super::pou::PouId;
use super::statement::Statement;
use super::text::TextCall;
use super::types::TypeId;
use super::value::Value;
use crate::dialect::Ties;
use crate::source::Span;

/// A register of a unit's function: a parameter or a local of WebAssembly.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct LocalId(pub u32);

/// An expression. Of elementary type it yields a value, of any other the address of one.
#[derive(Debug, Clone)]
pub struct Expr {
    pub kind: ExprKind,
    pub ty: TypeId,
    pub span: Span,
}

/// The forms of an expression.
#[derive(Debug, Clone)]
pub enum ExprKind {
    Constant(Value),
    Load(Place),
    /// The address of what has one.
    Address(Place),
    Unary(Unary, Box<Expr>),
    /// Both operands are held alike; the left one's type says how.
    Binary(Binary, Box<Expr>, Box<Expr>),
    /// From the operand's type to the expression's, the number itself kept as far as it fits.
    Convert(Rounding, Box<Expr>),
    /// The result of an operation that the target computes in a register, cut to the expression's narrower type. What
    /// takes a wider value takes that of the register.
    FromRegister(Box<Expr>),
    /// The second or, if the first is FALSE, the third; the other is not evaluated.
    Conditional(Box<[Expr; 3]>),
    Intrinsic(Intrinsic, Vec<Expr>),
    /// The operand, which must lie between the two numbers.
    Limited(i128, i128, Box<Expr>),
    Text(Box<TextCall>),
    Call(Box<FunctionCall>),
    /// Runs the statements, then yields the value; none for what has no result.
    After(Vec<Statement>, Option<Box<Expr>>),
    /// The reference, if what it refers to is of one of the types, else 0.
    Cast(Box<Cast>),
}

/// An assignment attempt (3rd ed. 6.6.6.7).
#[derive(Debug, Clone)]
pub struct Cast {
    pub reference: Expr,
    pub pointer: LocalId,
    /// First and last number of each range of types.
    pub types: Vec<(u32, u32)>,
}

/// What becomes of a fraction when a real becomes an integer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rounding {
    /// To nearest, ties to even (2nd ed. 2.5.1.5.1 by way of IEC 60559).
    NearestEven,
    /// To nearest, ties away from zero: a vendor's choice.
    NearestAway,
    /// Towards zero (`TRUNC`).
    Truncate,
    /// To the next greater one (`CEIL` of vendors).
    Up,
    /// To the next smaller one (`FLOOR` of vendors).
    Down,
}

impl From<Ties> for Rounding {
    fn from(ties: Ties) -> Self {
        match ties {
            Ties::Even => Self::NearestEven,
            Ties::Away => Self::NearestAway,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unary {
    Negate,
    Not,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Binary {
    Add,
    Subtract,
    Multiply,
    /// A division by zero stops the PLC.
    Divide,
    /// A division by zero gives 0 for integers, an infinity or NaN for reals.
    DivideAnyway,
    Modulo,
    And,
    Or,
    Xor,
    Equal,
    NotEqual,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
}

impl Binary {
    /// True for the operators whose result is a BOOL, whatever their operands are.
    pub fn is_comparison(self) -> bool {
        use Binary as B;
        matches!(self, B::Equal | B::NotEqual | B::Less | B::LessEqual | B::Greater | B::GreaterEqual)
    }
}

/// Standard functions that are not made of other expressions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Intrinsic {
    Abs,
    Sqrt,
    Ln,
    Log,
    Exp,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    /// Of Y and X (3rd ed. Table 28).
    Atan2,
    /// What lies behind the point (`FRAC` of vendors).
    Fraction,
    /// The same bytes in reverse order.
    SwapBytes,
    /// Base and exponent, both of the result's type.
    Power,
    Max,
    Min,
    /// `BOOL` selector, value if FALSE, value if TRUE.
    Select,
    /// `LINT` selector, then the values.
    Multiplex,
    /// Value and `LINT` count.
    ShiftLeft,
    ShiftRight,
    RotateLeft,
    RotateRight,
    /// The same bits as another type of the same size.
    Reinterpret,
    /// On addresses and a number of bytes, all UDINT.
    Memory(MemoryFunction),
    /// The remainder of a 64 bit number by a positive one, never negative.
    FloorRemainder,
    /// The greatest multiple of the second that is not greater than the first.
    FloorMultiple,
}

/// What vendors' functions do with bytes at addresses; each gives a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MemoryFunction {
    /// Target, source, count to the count; they may overlap.
    Copy,
    /// Target, value of a byte, count to the count.
    Fill,
    /// Two places and a count to -1, 0 or 1 as DINT.
    Compare,
}

/// A call of a user's function.
#[derive(Debug, Clone)]
pub struct FunctionCall {
    pub pou: PouId,
    /// Puts registers that are passed by reference into memory.
    pub before: Vec<Statement>,
    pub arguments: Vec<Argument>,
    /// The instance that a method works on.
    pub receiver: Option<Receiver>,
    /// Copies the function's outputs to where the caller wants them.
    pub outputs: Vec<Statement>,
    /// Where the caller keeps an aggregate result, so that the next call does not change it.
    pub result: Option<Place>,
}

/// The instance that a method is called on.
#[derive(Debug, Clone)]
pub struct Receiver {
    pub instance: Expr,
    /// Holds the address while arguments are evaluated.
    pub pointer: LocalId,
    /// True for what an interface refers to.
    pub may_be_null: bool,
    pub dispatch: Dispatch,
}

/// How the code of a call is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dispatch {
    Direct,
    /// By the number that the instance begins with, in this row of the table.
    Row(usize),
}

/// What an instance of each type runs, by the type's number from `first` on.
#[derive(Debug, Clone)]
pub struct Row {
    pub parameters: Vec<ElementaryType>,
    /// What the result is held as.
    pub result: Option<ElementaryType>,
    pub first: u32,
    pub targets: Vec<Option<PouId>>,
}

/// One argument of a function's WebAssembly signature.
#[derive(Debug, Clone)]
pub enum Argument {
    /// A value, or an aggregate's address, which the callee copies.
    Value(Expr),
    /// `VAR_IN_OUT`: the variable's address.
    Reference(Place),
}

/// Where a variable begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Storage {
    /// At a fixed offset in memory.
    Absolute(u32),
    /// At a direct address.
    Located(Location),
    /// The address stands at a fixed offset (a global of the running resource).
    AbsolutePointer(u32),
    /// At an offset in the running instance.
    Instance(u32),
    /// The address stands at an offset in the running instance (`VAR_IN_OUT`).
    InstancePointer(u32),
    Register(LocalId),
    /// The address stands in a register.
    RegisterPointer(LocalId),
    /// Where the first step, a [`Step::Pointer`], leads.
    Referred,
}

/// A variable or a part of one.
#[derive(Debug, Clone)]
pub struct Place {
    pub storage: Storage,
    pub steps: Vec<Step>,
    /// Set if the value shares its bytes, or its register, with others.
    pub part: Option<Part>,
    pub ty: TypeId,
    pub span: Span,
}

/// Which bits of a whole a value takes: as many as its type has, one for BOOL.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Part {
    /// What is loaded and stored: BYTE in memory, a register's type in a register.
    pub whole: ElementaryType,
    /// The lowest of the bits.
    pub shift: u32,
}

impl Part {
    /// One bit of a byte in memory.
    pub fn bit(bit: u8) -> Self {
        Self { whole: ElementaryType::Byte, shift: u32::from(bit) }
    }
}

impl Place {
    /// The place of a whole variable; of a variable located at a bit, that bit.
    pub fn whole(storage: Storage, ty: TypeId, span: Span) -> Self {
        let part = match storage {
            Storage::Located(Location { bit, .. }) => bit.map(Part::bit),
            _ => None,
        };
        Self { storage, steps: Vec::new(), part, ty, span }
    }

    /// Its address, if that is known before the program runs.
    pub fn fixed_address(&self) -> Option<u32> {
        match (self.storage, &self.steps[..], self.part) {
            (Storage::Absolute(base), [], None) => Some(base),
            (Storage::Absolute(base), [Step::Offset(offset)], None) => base.checked_add(*offset),
            _ => None,
        }
    }

    /// True if both are one variable, member or bit, seen as one type; of what is indexed or referred to nobody knows.
    pub fn is_surely(&self, other: &Self) -> bool {
        let offset = |step: &Step| if let Step::Offset(offset) = step { Some(*offset) } else { None };
        let inside = |place: &Self| place.steps.iter().map(offset).sum::<Option<u32>>();
        let is_fixed = inside(self).is_some_and(|offset| inside(other) == Some(offset));
        is_fixed && self.storage == other.storage && self.part == other.part && self.ty == other.ty
    }

    /// True if it has an address of its own: it is in no register and no bit of a byte.
    pub fn has_address(&self) -> bool {
        self.part.is_none() && !matches!(self.storage, Storage::Register(_))
    }

    /// The part of type `ty` that lies `offset` bytes inside.
    pub fn member(mut self, offset: u32, ty: TypeId) -> Self {
        match self.steps.last_mut() {
            Some(Step::Offset(last)) => *last += offset,
            _ => self.steps.push(Step::Offset(offset)),
        }
        self.ty = ty;
        self
    }
}

/// The way from a variable to its part.
#[derive(Debug, Clone)]
pub enum Step {
    /// To the address that a reference to `target` has; a fault if it is NULL or `target` would not
    /// end in memory. The first step only.
    Pointer { address: Box<Expr>, target: TypeId },
    /// So many bytes further.
    Offset(u32),
    /// To an element of an array that `description` describes; a fault if an index is out of bounds.
    Open { description: Box<Place>, indices: Vec<Expr>, stride: u32 },
    /// `(index - low) * stride` bytes further; a fault unless `index - low < count`.
    Index { index: Box<Expr>, low: i64, count: u32, stride: u32 },
}
