//! Values that a place of a subrange takes (2nd ed. Table 12, feature 3).

use crate::check::body::Body;
use crate::check::types::constant;
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::BeyondSubrange;
use crate::ir::{ElementaryType as E, Expr, ExprKind, TypeId};

impl Body<'_, '_> {
    /// A value that a place of the subrange `target` takes: a constant is checked here, all others
    /// when they are assigned, if the dialect wants that.
    pub(super) fn limited(&mut self, expr: Expr, target: TypeId, low: i128, high: i128) -> Option<Expr> {
        let span = expr.span;
        if let Ok(value) = constant::fold(self.declarations.types(), &expr) {
            let value = value.as_int().unwrap_or(low);
            if !(low..=high).contains(&value) {
                let message = format!("{value} is outside of {}", self.type_name(target));
                self.report(Diagnostic::error(Code::OutOfRange, span, message));
                return None;
            }
            return Some(Expr { ty: target, ..expr });
        }
        // What its type has anyway costs nothing to check.
        let (low, high) = match self.declarations.dialect(span).beyond_subrange() {
            BeyondSubrange::Fault => (low, high),
            BeyondSubrange::Assign => self.plain_elementary(&expr).and_then(E::range).unwrap_or((low, high)),
        };
        Some(Expr { kind: ExprKind::Limited(low, high, Box::new(expr)), ty: target, span })
    }
}
