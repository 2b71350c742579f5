//! A `VAR_IN_OUT` of an instance, read from outside, as `MatIEC` has it: its instances hold what they were given last.

use crate::check::body::call::instance_call::member_place;
use crate::check::body::{Body, Meant};
use crate::check::types::constant::decode;
use crate::check::types::operand::{Operand, constant};
use crate::dialect::Feature;
use crate::ir::{
    Binary, ElementaryType, Expr, ExprKind, IfBranch, Place, Statement, StatementKind, Type, TypeId, Value, Variable,
};
use crate::syntax::Span;
use crate::syntax::ast::{self, Ident, SectionKind};

impl Body<'_, '_> {
    /// The value of the variable that the instance was given last; the initial one before its first call.
    pub(super) fn in_out_of_instance(&mut self, base: &ast::Expr, name: &Ident, span: Span) -> Meant<Operand> {
        let variable = self.in_out_named(base, name, span)?;
        Some(self.given_last(base, &variable, span))
    }

    fn in_out_named(&mut self, base: &ast::Expr, name: &Ident, span: Span) -> Option<Variable> {
        let ast::ExprKind::Name(instance) = &base.kind else { return None };
        if !self.declarations.dialect(span).has(Feature::ReadableInOuts) {
            return None;
        }
        let ty = self.scope.find(&instance.key())?.ty;
        let Type::FunctionBlock { pou, .. } = *self.declarations.types().get(ty) else { return None };
        let scope = self.declarations.interface(pou, span)?;
        let found = scope.find(&name.key()).filter(|variable| variable.section == SectionKind::InOut)?;
        self.elementary(found.ty).is_some().then(|| found.clone())
    }

    fn given_last(&mut self, base: &ast::Expr, variable: &Variable, span: Span) -> Option<Operand> {
        let base = self.base_place(base)?.place;
        let address: TypeId = ElementaryType::Udint.into();
        let pointer = Expr { kind: ExprKind::Load(member_place(&base, variable, span)), ty: address, span };
        let null = constant(Value::Int(0), ElementaryType::Udint, span);
        let kind = ExprKind::Binary(Binary::NotEqual, Box::new(pointer.clone()), Box::new(null));
        let condition = Expr { kind, ty: ElementaryType::Bool.into(), span };
        let kept = self.kept(variable.ty, span)?;
        let elementary = self.elementary(variable.ty)?;
        let image = self.declarations.types().image(variable.ty).clone();
        let initial = Expr { ty: variable.ty, ..constant(decode(elementary, &image), elementary, span) };
        let given = loaded(Self::led_to(pointer, variable.ty, span).place);
        let body = vec![self.assignment(kept.clone(), given, span)];
        let otherwise = vec![self.assignment(kept.clone(), initial, span)];
        let choice = StatementKind::If(vec![IfBranch { condition, body }], otherwise);
        let ty = self.declarations.types().of_value(variable.ty);
        let kind = ExprKind::After(vec![Statement { kind: choice, span }], Some(Box::new(loaded(kept))));
        Some(Operand::Typed(Expr { kind, ty, span }))
    }
}

fn loaded(place: Place) -> Expr {
    let (ty, span) = (place.ty, place.span);
    Expr { kind: ExprKind::Load(place), ty, span }
}
