//! `__QUERYINTERFACE` and `__QUERYPOINTER` (CODESYS, TwinCAT): the interface or the address of an instance, and
//! whether there is one.

use crate::check::body::Body;
use crate::check::standard::query::Query;
use crate::check::types::operand::Operand;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{Binary, ElementaryType, Expr, ExprKind, Place, Statement, StatementKind, Type, Value};
use crate::syntax::Span;
use crate::syntax::ast::{self, Argument, Call, Ident, ReferenceKind};

impl Body<'_, '_> {
    pub(in crate::check) fn query(&mut self, query: Query, name: &Ident, call: &Call, span: Span) -> Option<Operand> {
        let [Argument::Positional(from), Argument::Positional(to)] = &call.arguments[..] else {
            let code = if call.arguments.len() < 2 { Code::MissingArgument } else { Code::TooManyArguments };
            let what = match query {
                Query::Interface => "an interface",
                Query::Pointer => "a pointer",
            };
            let message = format!("{} takes an instance or interface, and {what} that it sets", name.key());
            self.report(Diagnostic::error(code, span, message));
            return None;
        };
        let target = self.target(to)?;
        let assigned = match query {
            Query::Interface => {
                let value = self.within(None, |body| body.expression(from))?;
                self.attempt_interface(target.clone(), value, span)?
            }
            Query::Pointer => self.pointed_at(target.clone(), from, span)?,
        };
        Some(Operand::Typed(assigned_and_found(assigned, target, span)))
    }

    /// The pointer becomes the address of what the interface refers to.
    fn pointed_at(&mut self, target: Place, from: &ast::Expr, span: Span) -> Option<Statement> {
        if !matches!(self.declarations.types().get(target.ty), Type::Reference { kind: ReferenceKind::Pointer, .. }) {
            let found = self.type_name(target.ty);
            return self.mismatch("a pointer", &found, target.span);
        }
        let value = self.within(None, |body| body.expression(from))?;
        let address = self.reference_value(value)?;
        let value = Expr { ty: target.ty, ..address };
        Some(Statement { kind: StatementKind::Assign(target, value), span })
    }
}

/// Assigns, then reports whether there is anything now.
fn assigned_and_found(assigned: Statement, target: Place, span: Span) -> Expr {
    let address = ElementaryType::Udint.into();
    let found = Expr { kind: ExprKind::Load(Place { ty: address, ..target }), ty: address, span };
    let nothing = Expr { kind: ExprKind::Constant(Value::Int(0)), ty: address, span };
    let bool_type = ElementaryType::Bool.into();
    let kind = ExprKind::Binary(Binary::NotEqual, Box::new(found), Box::new(nothing));
    let found = Expr { kind, ty: bool_type, span };
    Expr { kind: ExprKind::After(vec![assigned], Some(Box::new(found))), ty: bool_type, span }
}
