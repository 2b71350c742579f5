//! Expressions that must be constant.

use crate::check::body::Body;
use crate::check::types::constant::{NoValue, fold};
use crate::check::types::operand::Operand;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{ElementaryType, Expr, TypeId, Value};
use crate::syntax::ast;

impl Body<'_, '_> {
    /// The value of a constant expression of any integer type.
    pub(in crate::check) fn constant_integer(&mut self, expr: &ast::Expr) -> Option<i128> {
        match self.expression(expr)? {
            Operand::Integer { value, .. } => Some(value),
            Operand::Real { span, .. } => self.mismatch("an integer", "a real number", span),
            Operand::Text { span, .. } => self.mismatch("an integer", "a string", span),
            Operand::Typed(typed) => {
                let typed = self.as_index(typed);
                let integer = self.elementary(typed.ty).is_some_and(ElementaryType::is_integer);
                if !integer {
                    let found = self.type_name(typed.ty);
                    return self.mismatch("an integer", &found, typed.span);
                }
                self.value_of(&typed)?.as_int()
            }
        }
    }

    /// True for the name of a variable with one value, be it a constant or, as an error, not.
    pub(in crate::check) fn is_value_named(&mut self, expr: &ast::Expr) -> bool {
        let qualified = self.qualified_name(expr);
        let ((ast::ExprKind::Name(name), _) | (_, Some(name))) = (&expr.kind, &qualified) else { return false };
        matches!(self.variable_named(name), Some(Ok(variable)) if self.elementary(variable.ty).is_some())
    }

    /// The value of a constant expression as one of type `ty`.
    pub(in crate::check) fn constant_of_type(&mut self, expr: &ast::Expr, ty: TypeId) -> Option<Value> {
        let typed = self.expression_for(expr, ty)?;
        self.value_of(&typed)
    }

    /// The value of an expression that must be constant.
    pub(in crate::check) fn value_of(&mut self, expr: &Expr) -> Option<Value> {
        match fold(self.declarations.types(), expr) {
            Ok(value) => Some(value),
            Err(NoValue::NotConstant(span)) => {
                let message = "a constant is wanted here";
                self.report(Diagnostic::error(Code::NotConstant, span, message));
                None
            }
            Err(NoValue::DivisionByZero(span)) => {
                let message = "a constant is divided by zero";
                self.report(Diagnostic::error(Code::ConstantDivisionByZero, span, message));
                None
            }
        }
    }
}
