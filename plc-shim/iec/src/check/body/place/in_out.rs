//! A `VAR_IN_OUT` of an instance, read and written from outside, as `MatIEC` has it: its instances hold what they were
//! given last, by a call or by an assignment.

use super::member::member_place;
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
        if self.elementary(variable.ty).is_none() {
            return Some(self.led_to_last(base, &variable, span));
        }
        Some(self.given_last(base, &variable, span))
    }

    /// `instance.name := value`: a variable of its own, which the instance keeps until it is given another.
    pub(in crate::check::body) fn in_out_given(
        &mut self,
        target: &ast::Expr,
        value: &ast::Expr,
        span: Span,
    ) -> Meant<Statement> {
        let ast::ExprKind::Member(base, name) = &target.kind else { return None };
        let variable = self.in_out_named(base, name, target.span)?;
        Some(self.given_copy(base, &variable, value, span))
    }

    fn given_copy(
        &mut self,
        base: &ast::Expr,
        variable: &Variable,
        value: &ast::Expr,
        span: Span,
    ) -> Option<Statement> {
        let base = self.base_place(base)?.place;
        let context = self.elementary(variable.ty);
        let value = self.within(context, |body| body.expression(value))?;
        let value = self.coerce(value, variable.ty)?;
        let copy = self.temporary(variable.ty, span)?;
        let body = vec![
            self.assignment(copy.clone(), value, span),
            Statement { kind: StatementKind::Bind(member_place(&base, variable, span), copy), span },
        ];
        let condition = constant(Value::Bool(true), ElementaryType::Bool, span);
        Some(Statement { kind: StatementKind::If(vec![IfBranch { condition, body }], Vec::new()), span })
    }

    /// What an instance was given last, of a type that no register holds.
    fn led_to_last(&mut self, base: &ast::Expr, variable: &Variable, span: Span) -> Option<Operand> {
        let base = self.base_place(base)?.place;
        let address: TypeId = ElementaryType::Udint.into();
        let pointer = Expr { kind: ExprKind::Load(member_place(&base, variable, span)), ty: address, span };
        Some(Operand::Typed(loaded(Self::led_to(pointer, variable.ty, span).place)))
    }

    fn in_out_named(&mut self, base: &ast::Expr, name: &Ident, span: Span) -> Option<Variable> {
        let ast::ExprKind::Name(instance) = &base.kind else { return None };
        if !self.declarations.dialect(span).has(Feature::ReadableInOuts) {
            return None;
        }
        let ty = self.scope.find(&instance.key())?.ty;
        let Type::FunctionBlock { pou, .. } = *self.declarations.types().get(ty) else { return None };
        let scope = self.declarations.interface(pou, span)?;
        scope.find(&name.key()).filter(|variable| variable.section == SectionKind::InOut).cloned()
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
