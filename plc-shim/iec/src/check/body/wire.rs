//! Wires: what an element of a network hands on to others, and what one instruction leaves to the next.
//!
//! A wire is written `` `name` `` and is not declared: it has the type of the first value that it is
//! given. Only text that was made of networks and lists of instructions has wires.

use super::Body;
use crate::ir::{Place, Statement, TypeId, TypeTable};
use crate::syntax::Span;
use crate::syntax::ast::{self, Ident};

pub(super) fn is_wire(name: &Ident) -> bool {
    name.text.starts_with('`')
}

impl Body<'_, '_> {
    /// The name of a wire that has no value yet.
    pub(super) fn new_wire<'e>(&self, target: &'e ast::Expr) -> Option<&'e Ident> {
        match &target.kind {
            ast::ExprKind::Name(name) if is_wire(name) && !self.wires.contains_key(&name.text) => Some(name),
            _ => None,
        }
    }

    /// The wire from now on, for values of `ty`.
    pub(super) fn wire(&mut self, name: &Ident, ty: TypeId, span: Span) -> Option<Place> {
        let place = self.kept(ty, span)?;
        self.wires.insert(name.text.clone(), place.clone());
        Some(place)
    }

    /// Gives a wire its first value.
    pub(super) fn first_value(&mut self, name: &Ident, value: &ast::Expr, span: Span) -> Option<Statement> {
        let value = self.within(None, |body| body.expression(value));
        let value = value.and_then(|value| self.settle(value))?;
        let ty = self.declarations.types().of_value(value.ty);
        if ty == TypeTable::nothing() {
            return self.mismatch("a value", "a call without result", span);
        }
        let place = self.wire(name, ty, name.span)?;
        Some(self.assignment(place, value, span))
    }
}
