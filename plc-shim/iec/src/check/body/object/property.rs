//! Properties, which vendors have: a value that a method gives, a target that a method takes.

use super::method_call::Object;
use crate::check::body::call::argument::Passing;
use crate::check::body::{Body, Meant};
use crate::check::declare::Role;
use crate::check::types::operand::Operand;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{Argument, Expr, ExprKind, PouId, Statement, StatementKind, TypeId};
use crate::syntax::Span;
use crate::syntax::ast::{self, Ident};

impl Body<'_, '_> {
    /// The value of a property of the running instance; nothing if the name is none.
    pub(in crate::check::body) fn own_property(&mut self, name: &Ident) -> Meant<Operand> {
        let object = self.own_property_object(name)?;
        Some(self.value(object, name))
    }

    /// The value of a property of another instance.
    pub(in crate::check::body) fn property_of(&mut self, base: &ast::Expr, name: &Ident) -> Meant<Operand> {
        match self.property_object(base, name)? {
            Some(object) => Some(self.value(object, name)),
            None => Some(None),
        }
    }

    fn own_property_object(&mut self, name: &Ident) -> Option<Object> {
        let key = name.key();
        if !self.declarations.has_property_named(&key) || self.scope.declares(&key) || name.is_global() {
            return None;
        }
        let class = self.own_class()?;
        self.property_of_class(class, name)?;
        Some(self.this_object(class, name.span))
    }

    fn property_object(&mut self, base: &ast::Expr, name: &Ident) -> Meant<Object> {
        if !self.declarations.has_property_named(&name.key()) {
            return None;
        }
        let Some(object) = self.object(base)? else { return Some(None) };
        self.property_of_class(object.class, name)?;
        Some(Some(object))
    }

    /// Something if the unit has a property of the name.
    fn property_of_class(&self, class: PouId, name: &Ident) -> Option<()> {
        let has = |role| self.declarations.find_member(class, role, &name.text).is_some();
        (has(Role::Getter) || has(Role::Setter)).then_some(())
    }

    fn value(&mut self, object: Object, name: &Ident) -> Option<Operand> {
        let Some(getter) = self.declarations.find_member(object.class, Role::Getter, &name.text) else {
            return self.lacks(name, "GET");
        };
        let read = self
            .check_method_access(getter, name.span)
            .and_then(|()| self.on_object(object, Role::Getter, getter, Vec::new(), Passing::default(), name.span));
        read.map(|value| self.referred_result(Operand::Typed(value)))
    }

    fn lacks<T>(&mut self, name: &Ident, accessor: &str) -> Option<T> {
        let message = format!("the property `{}` has no {accessor}", name.text);
        self.report(Diagnostic::error(Code::WrongProperty, name.span, message));
        None
    }

    /// An assignment whose target is a property.
    pub(in crate::check::body) fn property_assignment(
        &mut self,
        target: &ast::Expr,
        value: &ast::Expr,
        span: Span,
    ) -> Meant<Statement> {
        let (object, name) = self.property_target(target)?;
        Some(object.and_then(|object| self.set(object, name, value, span)))
    }

    /// `property REF= value`: SET gets the reference.
    pub(in crate::check::body) fn property_referral(
        &mut self,
        target: &ast::Expr,
        value: &ast::Expr,
        span: Span,
    ) -> Meant<Statement> {
        let (object, name) = self.property_target(target)?;
        let object = object?;
        let setter = self.declarations.find_member(object.class, Role::Setter, &name.text)?;
        Some(self.set_reference(object, setter, (name, value), span))
    }

    /// The object and the name of a property that is a target; nothing inside if the object is wrong.
    fn property_target<'e>(&mut self, target: &'e ast::Expr) -> Option<(Option<Object>, &'e Ident)> {
        match &target.kind {
            ast::ExprKind::Name(name) => Some((Some(self.own_property_object(name)?), name)),
            ast::ExprKind::Member(base, name) => Some((self.property_object(base, name)?, name)),
            _ => None,
        }
    }

    fn set_reference(
        &mut self,
        object: Object,
        setter: PouId,
        (name, value): (&Ident, &ast::Expr),
        span: Span,
    ) -> Option<Statement> {
        let ty = self.set_type(setter, name, span)?;
        self.require_reference_target(ty, name.span)?;
        let mut passing = Passing::default();
        let argument = self.referring_argument(ty, value, &mut passing)?;
        self.set_called(object, setter, argument, passing, span)
    }

    /// The type of what SET takes, where it may be called.
    fn set_type(&mut self, setter: PouId, name: &Ident, span: Span) -> Option<TypeId> {
        self.check_method_access(setter, name.span)?;
        let scope = self.declarations.interface(setter, span)?;
        Some(scope.inputs().next()?.ty)
    }

    fn set_called(
        &mut self,
        object: Object,
        setter: PouId,
        value: Expr,
        passing: Passing,
        span: Span,
    ) -> Option<Statement> {
        let call = self.on_object(object, Role::Setter, setter, vec![Argument::Value(value)], passing, span)?;
        Some(Statement { kind: StatementKind::Evaluate(call), span })
    }

    /// `property := value` where the property gives a reference: the value goes to what that refers to.
    fn written_through(&mut self, object: &Object, name: &Ident, value: &ast::Expr, span: Span) -> Meant<Statement> {
        let getter = self.declarations.find_member(object.class, Role::Getter, &name.text)?;
        let scope = self.declarations.interface(getter, span)?;
        let ty = scope.result()?.ty;
        if !self.is_reference_to(ty) {
            return None;
        }
        let Operand::Typed(Expr { kind: ExprKind::Load(place), .. }) = self.value(object.clone(), name)? else {
            return Some(None);
        };
        let value = self.expression_for(value, place.ty);
        Some(value.map(|value| self.assignment(place, value, span)))
    }

    pub(in crate::check::body) fn set(
        &mut self,
        object: Object,
        name: &Ident,
        value: &ast::Expr,
        span: Span,
    ) -> Option<Statement> {
        if let Some(found) = self.written_through(&object, name, value, span) {
            return found;
        }
        let Some(setter) = self.declarations.find_member(object.class, Role::Setter, &name.text) else {
            return self.lacks(name, "SET");
        };
        let ty = self.set_type(setter, name, span)?;
        let value = self.expression_for(value, ty)?;
        self.set_called(object, setter, value, Passing::default(), span)
    }
}
