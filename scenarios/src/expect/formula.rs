//! Formulas and terms, with signals as `S`: their names as written, or their columns in a trace.

use std::ops::Range;

/// A formula of signal temporal logic with past.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Formula<S> {
    Constant(bool),
    Signal(S),
    Compare(Comparison, Box<Term<S>>, Box<Term<S>>),
    Not(Box<Self>),
    And(Box<Self>, Box<Self>),
    Or(Box<Self>, Box<Self>),
    Implies(Box<Self>, Box<Self>),
    Iff(Box<Self>, Box<Self>),
    /// At every time in the window from now.
    Always(Window, Box<Self>),
    /// At some time in the window from now.
    Eventually(Window, Box<Self>),
    /// The right one at some time in the window from now, the left one at all times before that.
    Until(Window, Box<Self>, Box<Self>),
    /// At every time in the window back from now.
    Historically(Window, Box<Self>),
    /// At some time in the window back from now.
    Once(Window, Box<Self>),
    /// The right one at some time in the window back from now, the left one at all times since.
    Since(Window, Box<Self>, Box<Self>),
    /// Different from the sample before, in this way.
    Edge(Edge, Box<Self>),
}

impl<S> Formula<S> {
    /// True if every sample of a run may matter until its end: an operator on the future without an end stands within
    /// another operator on time. Where such operators stand outermost, what they have seen is one number.
    pub(super) fn keeps_every_sample(&self) -> bool {
        self.keeps(true)
    }

    fn keeps(&self, is_outermost: bool) -> bool {
        let endless = |window: &Window| window.to_ns.is_none() && !is_outermost;
        match self {
            Self::Constant(_) | Self::Signal(_) | Self::Compare(..) => false,
            Self::Not(inner) => inner.keeps(is_outermost),
            Self::And(one, other) | Self::Or(one, other) | Self::Implies(one, other) | Self::Iff(one, other) => {
                one.keeps(is_outermost) || other.keeps(is_outermost)
            }
            Self::Always(window, inner) | Self::Eventually(window, inner) => endless(window) || inner.keeps(false),
            Self::Until(window, one, other) => endless(window) || one.keeps(false) || other.keeps(false),
            Self::Historically(_, inner) | Self::Once(_, inner) | Self::Edge(_, inner) => inner.keeps(false),
            Self::Since(_, one, other) => one.keeps(false) || other.keeps(false),
        }
    }
}

/// How a formula differs from the sample before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Edge {
    Rose,
    Fell,
    Changed,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Comparison {
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    Equal,
    NotEqual,
}

/// A span of time relative to now, in nanoseconds; without an end it reaches as far as the run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Window {
    pub(super) from_ns: u64,
    pub(super) to_ns: Option<u64>,
}

impl Window {
    /// From now to the end of the run, or back to its start.
    pub(super) const WHOLE: Self = Self { from_ns: 0, to_ns: None };

    /// From now for so long.
    pub(super) fn first(to_ns: u64) -> Self {
        Self { from_ns: 0, to_ns: Some(to_ns) }
    }
}

/// A number at every sample.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Term<S> {
    pub(super) kind: TermKind<S>,
    pub(super) place: Range<usize>,
}

/// The forms of a term.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum TermKind<S> {
    /// A number and the unit it is written with.
    Number(f64, Option<String>),
    Signal(S),
    Negate(Box<Term<S>>),
    Abs(Box<Term<S>>),
    /// Change per second since the sample before; 0 at the first.
    Rate(Box<Term<S>>),
    Binary(Arithmetic, Box<Term<S>>, Box<Term<S>>),
    /// Carried to another unit: times the first, by the second.
    Scaled(Box<Term<S>>, f64, f64),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Arithmetic {
    Add,
    Subtract,
    Multiply,
    Divide,
    Min,
    Max,
}

impl Arithmetic {
    /// What it does with two numbers.
    pub(super) fn operation(self) -> fn(f64, f64) -> f64 {
        match self {
            Self::Add => |a, b| a + b,
            Self::Subtract => |a, b| a - b,
            Self::Multiply => |a, b| a * b,
            Self::Divide => |a, b| a / b,
            Self::Min => f64::min,
            Self::Max => f64::max,
        }
    }
}
