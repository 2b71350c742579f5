//! Instances assigned to one another, as vendors have it: a copy of all their variables.

use crate::check::body::Body;
use crate::check::types::build::{assign, load};
use crate::check::types::operand::{Operand, constant};
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::{Dialect, Feature};
use crate::ir::{
    ElementaryType, Expr, ExprKind, Place, Statement, StatementKind, Storage, Type, TypeId, TypeTable, Value,
};
use crate::syntax::Span;

impl Body<'_, '_> {
    /// `a := b` of instances of one type, or of a derived one on the right.
    pub(in crate::check::body) fn instance_copy(
        &mut self,
        target: Place,
        value: Operand,
        span: Span,
    ) -> Option<Statement> {
        let dialect = self.declarations.dialect(span);
        if !dialect.has(Feature::InstanceCopies) {
            let message = "instances are not assigned to one another";
            let found = Diagnostic::error(Code::NotAssignable, span, message);
            self.report(found.with_help(Feature::InstanceCopies.help()));
            return None;
        }
        let value = match value {
            Operand::Typed(value) if value.ty == target.ty || self.derives(value.ty, target.ty) => value,
            other => {
                let (wanted, found) = (self.type_name(target.ty), self.describe(&other));
                return self.mismatch(&wanted, &found, other.span());
            }
        };
        if dialect == Dialect::Iec3 {
            let message = "this copies all variables of an instance, as SIMATIC AX does; the standard assigns none";
            self.report(Diagnostic::warning(Code::NotAssignable, span, message));
        }
        let value = Expr { ty: target.ty, ..value };
        Some(self.copied_instance(target, value, span))
    }

    /// What runs on an instance is decided by the number that it begins with, which a copy does not change.
    fn copied_instance(&mut self, target: Place, value: Expr, span: Span) -> Statement {
        let (ty, number) = (target.ty, ElementaryType::Udint);
        let address = self.scope.register(number);
        let kept = Place::whole(Storage::Register(self.scope.register(number)), number.into(), span);
        let bound = Place::whole(Storage::Register(address), number.into(), span);
        let whole = Place::whole(Storage::RegisterPointer(address), ty, span);
        let begins = whole.clone().member(0, number.into());
        let is_numbered = self.begins_with_number(ty);
        let mut statements = vec![Statement { kind: StatementKind::Bind(bound, target), span }];
        if is_numbered {
            statements.push(assign(&kept, load(&begins)));
        }
        statements.push(Statement { kind: StatementKind::Copy(whole, value), span });
        if is_numbered {
            statements.push(assign(&begins, load(&kept)));
        }
        let all = Expr { kind: ExprKind::After(statements, None), ty: TypeTable::nothing(), span };
        Statement { kind: StatementKind::Evaluate(all), span }
    }

    /// What a base has of an instance, in memory of its own that begins with the base's number.
    pub(in crate::check::body) fn copied_as_base(&mut self, memory: Place, value: Expr, span: Span) -> Statement {
        let ty = memory.ty;
        let number = match self.declarations.types().get(ty) {
            Type::FunctionBlock { pou, .. } => self.declarations.class(*pou).and_then(|class| class.type_id),
            _ => None,
        };
        let begins = memory.clone().member(0, ElementaryType::Udint.into());
        let mut statements = vec![Statement { kind: StatementKind::Copy(memory, Expr { ty, ..value }), span }];
        statements.extend(
            number.map(|number| assign(&begins, constant(Value::Int(i128::from(number)), ElementaryType::Udint, span))),
        );
        let all = Expr { kind: ExprKind::After(statements, None), ty: TypeTable::nothing(), span };
        Statement { kind: StatementKind::Evaluate(all), span }
    }

    fn begins_with_number(&self, ty: TypeId) -> bool {
        match self.declarations.types().get(ty) {
            Type::FunctionBlock { pou, .. } => {
                self.declarations.class(*pou).is_some_and(|class| class.type_id.is_some())
            }
            _ => false,
        }
    }
}
