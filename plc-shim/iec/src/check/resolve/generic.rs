//! Inputs of generic types (CODESYS, TwinCAT): what their unit sees of them.

use super::Written;
use crate::check::body::Meant;
use crate::check::declare::TypedImage;
use crate::check::types::generic::Generic;
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::Feature;
use crate::ir::{Type, TypeId};
use crate::syntax::ast::{self, Ident, PouKind, SectionKind, TypeSpecKind};

impl<'a> Written<'_, 'a> {
    /// The type of a generic input; nothing if it is declared with another.
    pub(super) fn generic_input(
        &mut self,
        unit: PouKind,
        section: SectionKind,
        spec: &'a ast::TypeSpec,
    ) -> Meant<TypedImage<'a>> {
        let TypeSpecKind::Name(name) = &spec.kind else { return None };
        let generic = self.generic_named(name).filter(|_| self.declarations().type_key(&name.key()).is_none())?;
        let suitable = matches!(unit, PouKind::Function | PouKind::Method | PouKind::FunctionBlock);
        if section != SectionKind::Input || !suitable {
            self.reject_generic(name);
            return Some(None);
        }
        let ty = self.generic_type(generic);
        Some(ty.map(|ty| self.whole(ty)))
    }

    /// The generic type of a name; VARIANT is Siemens'.
    pub(super) fn generic_named(&self, name: &Ident) -> Option<Generic> {
        let has_variants = self.declarations().dialect(name.span).has(Feature::Variants);
        Generic::find(&name.key()).filter(|generic| *generic != Generic::Variant || has_variants)
    }

    /// Reports a generic type where no argument could say which type is meant.
    pub(super) fn reject_generic(&mut self, name: &Ident) {
        let sections = if name.key() == "VARIANT" { "VAR_INPUT and VAR_IN_OUT" } else { "VAR_INPUT" };
        let message = format!("{} is for {sections} of functions, methods and function blocks", name.key());
        self.report(Diagnostic::error(Code::WrongSection, name.span, message));
    }

    /// What the unit sees: `__SYSTEM.AnyType` or that of a VARIANT under the name of the generic type.
    fn generic_type(&mut self, generic: Generic) -> Option<TypeId> {
        if let Some(found) = self.declarations().seen_of_generic(generic) {
            return Some(found);
        }
        let seen = if generic == Generic::Variant { "ONESCAN_VARIANT" } else { "__SYSTEM.ANYTYPE" };
        let seen = self.declarations_mut().named_type(seen, None)?.ty;
        let Type::Struct { fields, .. } = self.declarations().types().get(seen).clone() else { return None };
        let image = self.declarations().types().image(seen).clone();
        let ty = self.declarations_mut().types_mut().structure(generic.name().to_owned());
        let align = self.declarations().types().structure_align(&fields, None);
        self.declarations_mut().types_mut().complete_structure(ty, fields, align, image);
        self.declarations_mut().add_generic(ty, generic);
        Some(ty)
    }
}
