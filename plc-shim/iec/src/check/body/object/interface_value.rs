//! Variables whose type is an interface: what they refer to, comparison, assignment attempts
//! (3rd ed. 6.6.6.5 to 6.6.6.7).

use crate::check::body::Body;
use crate::check::types::operand::Operand;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{
    Binary, Cast, ElementaryType, Expr, ExprKind, Place, PouId, Statement, StatementKind, Type, TypeId, TypeTable,
    Value,
};
use crate::syntax::Span;

impl Body<'_, '_> {
    pub(in crate::check::body) fn is_interface(&self, operand: &Operand) -> bool {
        matches!(operand, Operand::Typed(expr) if matches!(self.declarations.types().get(expr.ty), Type::Interface { .. }))
    }

    /// The operand as a reference to what implements `interface`.
    pub(in crate::check::body) fn coerce_interface(
        &mut self,
        operand: Operand,
        interface: PouId,
        target: TypeId,
    ) -> Option<Expr> {
        match operand {
            Operand::Typed(expr) if expr.ty == target => Some(expr),
            Operand::Typed(expr) if expr.ty == TypeTable::null() => Some(Expr { ty: target, ..expr }),
            Operand::Integer { value: 0, span } => {
                Some(Expr { kind: ExprKind::Constant(Value::Int(0)), ty: target, span })
            }
            Operand::Typed(expr) => match *self.declarations.types().get(expr.ty) {
                // The value of an instance is its address.
                Type::FunctionBlock { pou, .. } | Type::Interface { pou, .. }
                    if self.declarations.is_a(pou, interface) =>
                {
                    Some(Expr { ty: target, ..expr })
                }
                Type::FunctionBlock { .. } => {
                    let (found, wanted) = (self.type_name(expr.ty), self.type_name(target));
                    let message = format!("{found} does not implement {wanted}");
                    self.report(Diagnostic::error(Code::TypeMismatch, expr.span, message));
                    None
                }
                Type::Interface { .. } => {
                    let (found, wanted) = (self.type_name(expr.ty), self.type_name(target));
                    let message = format!("{wanted} is wanted, this is {found}");
                    let report = Diagnostic::error(Code::TypeMismatch, expr.span, message);
                    self.report(report.with_help("assign it with `?=`, which gives NULL if it is something else"));
                    None
                }
                _ => {
                    let (found, wanted) = (self.type_name(expr.ty), self.type_name(target));
                    self.mismatch(&wanted, &found, expr.span)
                }
            },
            other => {
                let (found, wanted) = (self.describe(&other), self.type_name(target));
                self.mismatch(&wanted, &found, other.span())
            }
        }
    }

    /// `=` and `<>` decide whether two references refer to the same instance.
    pub(in crate::check::body) fn interface_comparison(
        &mut self,
        operator: Binary,
        left: Operand,
        right: Operand,
        span: Span,
    ) -> Option<Operand> {
        if !matches!(operator, Binary::Equal | Binary::NotEqual) {
            let message = "references are compared with `=` and `<>` only";
            self.report(Diagnostic::error(Code::InvalidOperand, span, message));
            return None;
        }
        let (left, right) = (self.reference_value(left)?, self.reference_value(right)?);
        let kind = ExprKind::Binary(operator, Box::new(left), Box::new(right));
        Some(Operand::Typed(Expr { kind, ty: ElementaryType::Bool.into(), span }))
    }

    /// `target ?= value`: NULL unless what the value refers to implements the target's interface.
    pub(in crate::check::body) fn attempt_interface(
        &mut self,
        target: Place,
        value: Operand,
        span: Span,
    ) -> Option<Statement> {
        let Type::Interface { pou: wanted, .. } = *self.declarations.types().get(target.ty) else {
            let found = self.type_name(target.ty);
            return self.mismatch("an interface", &found, target.span);
        };
        if let Operand::Typed(expr) = &value
            && let Type::FunctionBlock { pou, .. } = self.declarations.types().get(expr.ty)
            && self.declarations.class(*pou).is_none_or(|class| class.type_id.is_none())
            && !self.declarations.may_be_more(*pou)
        {
            // An instance without a number implements nothing.
            let found = self.type_name(expr.ty);
            return self.mismatch("what may implement an interface", &found, expr.span);
        }
        let reference = self.reference_value(value)?;
        let pointer = self.scope.register(ElementaryType::Udint);
        let cast = Cast { reference, pointer, types: self.declarations.type_ranges(wanted) };
        let value = Expr { kind: ExprKind::Cast(Box::new(cast)), ty: target.ty, span };
        Some(Statement { kind: StatementKind::Assign(target, value), span })
    }

    /// The address that an operand stands for.
    pub(super) fn reference_value(&mut self, operand: Operand) -> Option<Expr> {
        let address = ElementaryType::Udint.into();
        match operand {
            Operand::Integer { value: 0, span } => {
                Some(Expr { kind: ExprKind::Constant(Value::Int(0)), ty: address, span })
            }
            Operand::Typed(expr) => match self.declarations.types().get(expr.ty) {
                Type::Interface { .. } | Type::FunctionBlock { .. } | Type::Null => Some(Expr { ty: address, ..expr }),
                _ => {
                    let found = self.type_name(expr.ty);
                    self.mismatch("an instance, an interface or NULL", &found, expr.span)
                }
            },
            other => {
                let found = self.describe(&other);
                self.mismatch("an instance, an interface or NULL", &found, other.span())
            }
        }
    }
}
