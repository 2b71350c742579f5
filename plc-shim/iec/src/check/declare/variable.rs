//! A declared variable with its type, its place and what it begins with.

use super::Declarations;
use super::entry::TypedImage;
use super::start::Started;
use super::visibility::visibility;
use crate::check::types::constant::decode;
use crate::ir::{Place, Retention, Storage, Variable};
use crate::syntax::Span;
use crate::syntax::ast::{self, Ident, Qualifier, SectionKind};

impl<'a> Declarations<'a> {
    /// Keeps what a start does to a variable at a fixed place.
    pub(in crate::check) fn begin(&mut self, storage: Storage, declared: &TypedImage<'a>, span: Span) {
        if !declared.starts.is_empty() {
            let place = Place::whole(storage, declared.ty, span);
            self.started.push(Started { place, starts: declared.starts.clone() });
        }
    }

    /// The variable that a declaration makes, in the place that has been found for it.
    pub(in crate::check) fn variable(
        &self,
        name: &Ident,
        ast: &ast::Variable,
        section: SectionKind,
        qualifiers: &[Qualifier],
        declared: &TypedImage<'_>,
        storage: Storage,
    ) -> Variable {
        let is_constant = qualifiers.contains(&Qualifier::Constant);
        let elementary = self.types.elementary(declared.ty);
        Variable {
            name: name.text.clone(),
            section,
            ty: declared.ty,
            storage,
            constant: elementary.filter(|_| is_constant).map(|ty| decode(ty, &declared.image)),
            is_constant,
            retention: Retention::of(qualifiers),
            address: ast.address.as_ref().filter(|_| ast.viewed().is_none()).map(|address| address.text.clone()),
            span: name.span,
            image: declared.image.clone(),
            edge: None,
            of_chart: false,
            visibility: visibility(section, qualifiers),
            owner: None,
        }
    }
}
