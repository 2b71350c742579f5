//! Who sees what of a unit (3rd ed. 6.6.5.5 to 6.6.5.10).

use super::Declarations;
use crate::ir::{PouId, Visibility};
use crate::syntax::ast::{Modifier, Qualifier, SectionKind};

/// Who sees a variable of a section: what the section says, else as the standard has it.
pub(in crate::check) fn visibility(section: SectionKind, qualifiers: &[Qualifier]) -> Visibility {
    let said = qualifiers.iter().find_map(|qualifier| match qualifier {
        Qualifier::Access(Modifier::Public) => Some(Visibility::Public),
        Qualifier::Access(Modifier::Private) => Some(Visibility::Private),
        Qualifier::Access(Modifier::Internal) => Some(Visibility::Internal),
        Qualifier::Access(_) => Some(Visibility::Protected),
        _ => None,
    });
    said.unwrap_or(match section {
        SectionKind::Input | SectionKind::Output => Visibility::Public,
        _ => Visibility::Protected,
    })
}

/// Who sees a method. The standard's default is PROTECTED, that of vendors PUBLIC.
pub(in crate::check) fn method_visibility(modifiers: &[Modifier]) -> Visibility {
    let said = modifiers.iter().find_map(|modifier| match modifier {
        Modifier::Public => Some(Visibility::Public),
        Modifier::Protected => Some(Visibility::Protected),
        Modifier::Private => Some(Visibility::Private),
        Modifier::Internal => Some(Visibility::Internal),
        _ => None,
    });
    said.unwrap_or(Visibility::Public)
}

impl Declarations<'_> {
    /// The name of a unit, that of a method with its class.
    pub(in crate::check) fn display_name(&self, id: PouId) -> String {
        let name = &self.pou(id).ast.name.text;
        let shown = match self.pou(id).membership {
            Some(membership) => format!("{}.{name}", self.pou(membership.owner).ast.name.text),
            None => name.clone(),
        };
        shown + &self.shown_parameters(id)
    }

    /// True for a method that only its own unit sees: what is derived from that cannot override it.
    pub(in crate::check) fn is_private(&self, method: PouId) -> bool {
        method_visibility(&self.pou(method).ast.object.modifiers) == Visibility::Private
    }

    pub(in crate::check) fn sees(&self, from: Option<PouId>, visibility: Visibility, owner: PouId) -> bool {
        let class = from.map(|id| self.owner_of(id));
        match visibility {
            Visibility::Public => true,
            Visibility::Protected => class.is_some_and(|class| self.is_a(class, owner)),
            Visibility::Private => class == Some(owner),
            Visibility::Internal => self.is_inside(&self.pou(owner).home),
        }
    }
}
