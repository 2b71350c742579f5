//! The vendors' type BIT, which takes less than a byte: single members of structures and function blocks have it.

use super::Written;
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::ast::{TypeSpec, TypeSpecKind};

impl Written<'_, '_> {
    /// True for the type `BIT`, unless the user declares one of that name.
    pub(super) fn is_bit_type(&self, spec: &TypeSpec) -> bool {
        let is_free = || self.declarations().type_key("BIT").is_none();
        matches!(&spec.kind, TypeSpecKind::Name(name) if name.key() == "BIT" && is_free())
    }

    /// Reports `BIT` where only what has an address of its own may stand (CODESYS and TwinCAT: C0203).
    pub(super) fn reject_bit(&mut self, spec: &TypeSpec) {
        if self.is_bit_type(spec) {
            let message = "BIT is for single members of structures and single variables of function blocks";
            let found = Diagnostic::error(Code::WrongSection, spec.span, message);
            self.report(found.with_help("declare it as BOOL"));
        }
    }
}
