//! Constants that a later section of the unit declares, as bounds of what comes before them.

use crate::check::body::{Body, Meant};
use crate::check::types::constant::fold;
use crate::ir::{ElementaryType, Storage, Variable, Visibility};
use crate::syntax::ast::{Ident, InitialiserKind, Qualifier, SectionKind, TypeSpecKind};

impl Body<'_, '_> {
    /// The constant of this name while the unit is still being declared; nothing if it has none, nothing inside if
    /// its value is wrong or needs itself.
    pub(super) fn later_constant(&mut self, name: &Ident) -> Meant<Variable> {
        let key = name.key();
        let ast = self.declarations.pou(self.pou?).ast();
        let constants = ast.sections.iter().filter(|section| section.qualifiers.contains(&Qualifier::Constant));
        let mut declared = constants.flat_map(|section| &section.variables);
        let found = declared.find(|variable| variable.names.iter().any(|each| each.key() == key))?;
        let (TypeSpecKind::Name(ty), Some(initial)) = (&found.spec.kind, &found.initial) else { return None };
        let (ty, InitialiserKind::Value(value)) = (ElementaryType::find(&ty.text)?, &initial.kind) else { return None };
        if self.later.contains(&key) {
            return Some(None);
        }
        self.later.push(key);
        let typed = self.expression_of(value, ty);
        self.later.pop();
        let constant = typed.and_then(|typed| fold(self.declarations.types(), &typed).ok());
        Some(constant.map(|constant| Variable {
            name: name.text.clone(),
            section: SectionKind::Local,
            ty: ty.into(),
            // Its value is all that is asked for.
            storage: Storage::Absolute(0),
            constant: Some(constant),
            is_constant: true,
            retention: None,
            address: None,
            span: found.spec.span,
            image: constant.bytes().as_slice().into(),
            edge: None,
            of_chart: false,
            visibility: Visibility::Private,
            owner: self.pou,
        }))
    }
}
