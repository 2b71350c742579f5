//! Constants that are wanted before their unit is declared: those of a later section as bounds of what comes before
//! them, and those of another unit by its name.

use crate::check::body::{Body, Meant};
use crate::check::declare::Scope;
use crate::check::types::constant::fold;
use crate::check::types::operand::Operand;
use crate::dialect::Feature;
use crate::ir::{ElementaryType, Expr, ExprKind, Storage, Variable, Visibility};
use crate::syntax::ast::{self, Ident, InitialiserKind, PouKind, Qualifier, SectionKind, TypeSpecKind};

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
        let place = (self.pou?, key);
        if self.later.contains(&place) {
            return Some(None);
        }
        self.later.push(place);
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

    /// `Block.constant`: the constant of a function block or class by that one's name, which vendors allow; nothing if
    /// that is not what the expression says.
    pub(super) fn constant_of_unit(&mut self, base: &ast::Expr, name: &Ident) -> Meant<Operand> {
        if !self.declarations.dialect(name.span).has(Feature::ReadableInternals) {
            return None;
        }
        let unit = match &base.kind {
            ast::ExprKind::Name(unit) if !self.scope.declares(&unit.key()) => unit.clone(),
            _ => self.qualified_name(base)?,
        };
        if self.declarations.global_key(&unit.key()).is_some() {
            return None;
        }
        let id = self.declarations.pou_named(&unit.key())?;
        if !matches!(self.declarations.pou(id).ast().kind, PouKind::FunctionBlock | PouKind::Class) {
            return None;
        }
        let later = std::mem::take(&mut self.later);
        let mut inner = Body::new(self.declarations, Scope::default(), Some(id));
        inner.later = later;
        let found = inner.later_constant(name);
        self.later = std::mem::take(&mut inner.later);
        let constant = match found? {
            Some(variable) => variable.constant.map(|value| (value, variable.ty)),
            None => None,
        };
        let span = base.span.to(name.span);
        Some(constant.map(|(value, ty)| Operand::Typed(Expr { kind: ExprKind::Constant(value), ty, span })))
    }
}
