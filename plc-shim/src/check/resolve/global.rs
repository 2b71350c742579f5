//! Global variables, placed in memory or at their direct addresses.

use crate::check::body::Body;
use crate::check::declare::declarations::Checker;
use crate::check::declare::demand::Need;
use crate::check::declare::entry::TypedImage;
use crate::check::declare::located::Placement;
use crate::check::declare::start::Started;
use crate::check::declare::visibility::visibility;
use crate::check::types::constant::decode;
use crate::ir::{Place, Retention, Storage, Variable};
use crate::syntax::Span;
use crate::syntax::ast::{self, Ident, Qualifier, SectionKind};

impl<'a> Checker<'a> {
    /// Keeps what a start does to a variable at a fixed place.
    pub(in crate::check) fn begin(&mut self, storage: Storage, declared: &TypedImage<'a>, span: Span) {
        if !declared.starts.is_empty() {
            let place = Place::whole(storage, declared.ty, span);
            self.started.push(Started { place, starts: declared.starts.clone() });
        }
    }

    pub(in crate::check) fn place_global(
        &mut self,
        name: &Ident,
        ast: &'a ast::Variable,
        qualifiers: &[Qualifier],
    ) -> Option<Variable> {
        let mut body = Body::outside(self);
        let declared = body.declared(ast, Need::Size)?;
        body.reject_open_array(declared.ty, name.span)?;
        if qualifiers.contains(&Qualifier::Constant) {
            body.require_constant(&declared.starts, OF_CONSTANTS);
        }
        let storage = match self.located(ast, &declared)? {
            Placement::At(storage) => {
                Body::outside(self).require_constant(&declared.starts, OF_LOCATED);
                storage
            }
            Placement::Free => {
                let (size, align) = (self.types.size(declared.ty), self.types.align(declared.ty));
                let offset = self.allocate(size, align, name.span)?;
                self.placed.push((offset, declared.image.clone()));
                self.begin(Storage::Absolute(offset), &declared, name.span);
                Storage::Absolute(offset)
            }
        };
        let variable = self.variable(name, ast, SectionKind::Global, qualifiers, &declared, storage);
        Some(Variable { name: self.home.full_name(name), ..variable })
    }

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
            address: ast.address.as_ref().map(|address| address.text.clone()),
            span: name.span,
            image: declared.image.clone(),
            edge: None,
            of_chart: false,
            visibility: visibility(section, qualifiers),
            owner: None,
        }
    }
}

pub(in crate::check) const OF_CONSTANTS: &str = "a CONSTANT is one before the program runs";

pub(in crate::check) const OF_LOCATED: &str = "a variable with a direct address begins with its bytes";
