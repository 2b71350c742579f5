//! Global variables, placed in memory or at their direct addresses.

use super::Written;
use super::start::{OF_CONSTANTS, OF_LOCATED};
use crate::check::declare::{Need, Placement};
use crate::ir::{Storage, Variable};
use crate::syntax::ast::{self, Ident, Qualifier, SectionKind};

impl<'a> Written<'_, 'a> {
    pub(super) fn global_variable(
        &mut self,
        name: &Ident,
        ast: &'a ast::Variable,
        qualifiers: &[Qualifier],
    ) -> Option<Variable> {
        self.reject_bit(&ast.spec);
        let declared = self.declared(ast, Need::Size)?;
        let declared = self.set_from_outside(name, ast, declared)?;
        self.body.reject_open_array(declared.ty, name.span)?;
        if qualifiers.contains(&Qualifier::Constant) {
            self.require_constant(&declared.starts, OF_CONSTANTS);
        }
        let storage = match self.declarations_mut().located(ast, &declared)? {
            Placement::At(storage) => {
                self.require_constant(&declared.starts, OF_LOCATED);
                storage
            }
            Placement::Free => {
                let declarations = self.declarations_mut();
                let (size, align) = (declarations.types().size(declared.ty), declarations.types().align(declared.ty));
                let offset = declarations.allocate(size, align, name.span)?;
                declarations.place(offset, declared.image.clone());
                declarations.begin(Storage::Absolute(offset), &declared, name.span);
                Storage::Absolute(offset)
            }
        };
        let declarations = self.declarations();
        let variable = declarations.variable(name, ast, SectionKind::Global, qualifiers, &declared, storage);
        Some(Variable { name: declarations.home().full_name(name), ..variable })
    }
}
