//! The structure around an initial value: vendors let its members name one another, and `THIS^` mean the structure.

use crate::check::body::place::{Access, Located};
use crate::check::body::{Body, Meant};
use crate::check::declare::Within;
use crate::ir::{Field, Place, Type};
use crate::syntax::ast::Ident;

/// The structure in one of whose initial values an expression stands.
#[derive(Debug, Clone)]
pub(in crate::check) struct Surrounding {
    pub(in crate::check) place: Place,
    /// The members that there are so far while it is being declared; its type has them when something is done at a start.
    pub(in crate::check) declared: Vec<Field>,
}

impl Surrounding {
    /// The structure that a start belongs to which is done at `offset` of `base`.
    pub(super) fn of(base: &Place, offset: u32, within: Within) -> Option<Self> {
        let begin = offset.checked_sub(within.offset)?;
        let place = super::part(base, begin, within.structure, base.span);
        Some(Self { place, declared: Vec::new() })
    }
}

impl Body<'_, '_> {
    /// Goes to the initial values of a structure, or back, and gives the one that was around before.
    pub(in crate::check) fn surround(&mut self, by: Option<Surrounding>) -> Option<Surrounding> {
        std::mem::replace(&mut self.surrounding, by)
    }

    /// The member that a name alone means in the initial value of another.
    pub(in crate::check::body) fn sibling(&self, name: &Ident) -> Option<Located> {
        let around = self.surrounding.as_ref()?;
        let complete = match self.declarations.types().get(around.place.ty) {
            Type::Struct { fields, .. } => fields.as_slice(),
            _ => &[],
        };
        let mut fields = around.declared.iter().chain(complete);
        let field = fields.find(|field| field.name.eq_ignore_ascii_case(&name.text))?;
        let place = super::part(&around.place, field.offset, field.ty, name.span);
        let access = if field.bit.is_some() { Access::Constant } else { Access::ReadWrite };
        Some(Located { place, access })
    }

    /// The structure as `THIS^`; nothing where no structure is around.
    pub(in crate::check::body) fn this_structure(&self, name: &Ident) -> Meant<Located> {
        let place = self.surrounding.as_ref()?.place.clone();
        Some(Some(Located { place: Place { span: name.span, ..place }, access: Access::ReadWrite }))
    }
}
