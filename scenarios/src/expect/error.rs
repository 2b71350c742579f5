//! What can be wrong with a formula.

use std::ops::Range;

use thiserror::Error;

/// A formula that cannot be evaluated, and the bytes of its text that are to blame.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{kind}")]
pub struct FormulaError {
    pub kind: FormulaErrorKind,
    /// Where in the formula.
    pub place: Range<usize>,
    pub help: Option<String>,
}

/// The kinds of wrong formula.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum FormulaErrorKind {
    /// A character that begins nothing.
    #[error("`{0}` has no meaning in an expectation")]
    Character(char),
    /// A quoted name without its end.
    #[error("the quoted name has no end")]
    Quote,
    /// A number that is none.
    #[error("`{0}` is not a number")]
    Number(String),
    /// A time that is none.
    #[error("{0}")]
    Time(String),
    /// Something else was expected.
    #[error("expected {expected}, found {found}")]
    Expected {
        /// What would go on from here.
        expected: &'static str,
        found: String,
    },
    /// A name where the language goes on.
    #[error("`{0}` is not a word of expectations")]
    UnknownWord(String),
    /// Formulas within formulas without end.
    #[error("formulas are nested deeper than {0}")]
    TooDeep(usize),
    /// A window that ends before it begins.
    #[error("the window ends before it begins")]
    EmptyWindow,
    #[error("the scenario has no signal `{0}`")]
    UnknownSignal(String),
    /// A BOOL where a number is needed.
    #[error("`{0}` is a BOOL, not a number")]
    NotANumber(String),
    /// A number where a BOOL is needed.
    #[error("`{0}` is a number; compare it to be true or false")]
    NotABool(String),
    #[error("`{0}` is a {1}; expectations are on BOOLs, numbers and times")]
    Text(String, String),
    /// More than comparisons with values is needed to judge it.
    #[error("a condition compares signals with values: no arithmetic with signals, no `rate`")]
    NotNow,
    /// It cannot be judged when it is asked for.
    #[error("a condition is judged as the run goes: it cannot look ahead")]
    LooksAhead,
    /// It looks at more than one time.
    #[error("this is judged on one image at a time: no windows, no edges, no `rate`")]
    NotPresent,
    /// A unit that is unknown.
    #[error("`{0}` is not a unit that is known here")]
    UnknownUnit(String),
    /// Units of different quantities.
    #[error("`{left}` and `{right}` do not measure the same")]
    Incommensurable { left: String, right: String },
}

impl FormulaError {
    pub(super) fn new(kind: FormulaErrorKind, place: Range<usize>) -> Self {
        Self { kind, place, help: None }
    }

    pub(super) fn with_help(mut self, help: impl Into<Option<String>>) -> Self {
        self.help = help.into();
        self
    }
}
