//! Program text to the files that other tools import: the way back of [`onescan_iec::input`].
//!
//! | module | in | out |
//! |---|---|---|
//! | [`page`] | text | the comments that belong to a declaration |
//! | [`matiec`] | a project in text | one text that MatIEC compiles |
//! | [`plcopen`] | a project in text | one file of PLCopen XML, as CODESYS imports it |
//! | [`scl`] | a project in text | an external source in SCL, as TIA Portal imports it |
//! | [`width`] | a checked project | the conversions that it needs where integers are computed in other bits |
//!
//! Invariants: statements are taken over as they are written; what a form cannot say is refused with its place, never
//! left out.

pub(crate) mod matiec;
pub(crate) mod page;
pub(crate) mod plcopen;
pub(crate) mod scl;
pub(crate) mod width;

use onescan_iec::syntax::Span;

/// What has no form in the file to be written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Refused {
    pub(crate) span: Span,
    /// What it is, and what it has no form in.
    pub(crate) message: String,
}

impl Refused {
    /// `what`, which has no form in PLCopen XML.
    pub(crate) fn plcopen(span: Span, what: &str) -> Self {
        Self { span, message: format!("{what} has no form in PLCopen XML as CODESYS reads it") }
    }
}

/// Text of a part of a file, unless there is no form for it.
pub(crate) type Written<T = String> = Result<T, Refused>;
