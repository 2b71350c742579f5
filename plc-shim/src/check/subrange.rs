//! Subrange types (2nd ed. 2.3.3.1 Table 12, feature 3).

use super::constant;
use super::names::TypedImage;
use super::scope::Body;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{ElementaryType, Expr, ExprKind, TypeId};
use crate::syntax::ast::{Ident, Subrange};

impl<'a> Body<'_, 'a> {
    /// The type that `INT (0..100)` names.
    pub(super) fn subrange(&mut self, name: &Ident, ast: &'a Subrange) -> Option<TypedImage<'a>> {
        let base = self.integer_base(name)?;
        let (low, high) = (self.constant_integer(&ast.low)?, self.constant_integer(&ast.high)?);
        let fits = |value| base.wrap(value) == value;
        if low > high || !fits(low) || !fits(high) {
            let message = format!("bounds {low}..{high} are reversed or do not fit {base}");
            let span = ast.low.span.to(ast.high.span);
            self.report(Diagnostic::error(Code::InvalidRange, span, message));
            return None;
        }
        let ty = self.checker.types.subrange(base, low, high);
        Some(self.whole(ty))
    }

    /// An integer type that a subrange or enumeration is made of.
    pub(super) fn integer_base(&mut self, name: &Ident) -> Option<ElementaryType> {
        let found = ElementaryType::find(&name.text);
        let suitable = found.filter(|ty| ty.is_integer() || ty.is_bits() && *ty != ElementaryType::Bool);
        if suitable.is_none() {
            let message = format!("an integer type is wanted, this is `{}`", name.text);
            self.report(Diagnostic::error(Code::TypeMismatch, name.span, message));
        }
        suitable
    }
}

impl Body<'_, '_> {
    /// A value that a place of the subrange `target` takes: a constant is checked here, all others
    /// when they are assigned.
    pub(super) fn limited(&mut self, expr: Expr, target: TypeId, low: i128, high: i128) -> Option<Expr> {
        let span = expr.span;
        if let Ok(value) = constant::fold(&self.checker.types, &expr) {
            let value = value.as_int().unwrap_or(low);
            if !(low..=high).contains(&value) {
                let message = format!("{value} is outside of {}", self.type_name(target));
                self.report(Diagnostic::error(Code::OutOfRange, span, message));
                return None;
            }
            return Some(Expr { ty: target, ..expr });
        }
        Some(Expr { kind: ExprKind::Limited(low, high, Box::new(expr)), ty: target, span })
    }
}
