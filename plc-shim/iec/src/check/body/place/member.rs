//! Variables of an instance, seen from outside.

use crate::ir::{ElementaryType, Place, Storage, Variable};
use crate::syntax::Span;

/// A variable inside an instance, seen from outside.
pub(in crate::check::body) fn member_place(base: &Place, variable: &Variable, span: Span) -> Place {
    let (offset, ty) = match variable.storage {
        Storage::Instance(offset) => (offset, variable.ty),
        Storage::InstancePointer(offset) => (offset, ElementaryType::Udint.into()),
        _ => (0, variable.ty),
    };
    Place { span, ..base.clone().member(offset, ty) }
}
