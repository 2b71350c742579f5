//! Where asserts stand: an input that the compiler gives to the asserts of the library.

use crate::ir::{Argument, ElementaryType, Expr, ExprKind, Value, Variable};
use crate::syntax::{FileId, Span};

const SITE: &str = "SITE";

/// True for the input of an assert that says where its call stands.
pub(in crate::check) fn is_site(parameter: &Variable) -> bool {
    parameter.name == SITE
}

/// The place of a call as a ULINT: its file above, its first byte below.
pub(in crate::check) fn site(span: Span) -> Argument {
    let ty = ElementaryType::Ulint;
    let value = u64::from(span.file.0) << 32 | u64::from(span.start);
    Argument::Value(Expr { kind: ExprKind::Constant(Value::Int(i128::from(value))), ty: ty.into(), span })
}

/// The place that [`site`] stands for.
pub fn place(site: u64) -> Span {
    let (file, start) = (FileId((site >> 32) as u32), site as u32);
    Span::new(file, start, start)
}
