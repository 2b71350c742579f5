//! What a type refers to (3rd ed. 6.4.4.10).

use crate::ir::{Type, TypeId, TypeTable};
use crate::syntax::ast::ReferenceKind;

/// What a type refers to, and how; addresses are pointers.
pub(in crate::check) fn target_of(types: &TypeTable, ty: TypeId) -> Option<(ReferenceKind, TypeId)> {
    match types.get(ty) {
        Type::Reference { kind, target } => Some((*kind, *target)),
        Type::Address { target } => Some((ReferenceKind::Pointer, *target)),
        _ => None,
    }
}
