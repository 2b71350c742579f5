//! Subrange types (2nd ed. 2.3.3.1 Table 12, feature 3).

use super::Written;
use crate::check::declare::TypedImage;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::ElementaryType;
use crate::syntax::ast::{Ident, Subrange};

impl<'a> Written<'_, 'a> {
    /// The type that `INT (0..100)` names.
    pub(super) fn subrange(&mut self, name: &Ident, ast: &'a Subrange) -> Option<TypedImage<'a>> {
        let base = self.integer_base(name)?;
        let (low, high) = (self.body.constant_integer(&ast.low)?, self.body.constant_integer(&ast.high)?);
        let fits = |value| base.wrap(value) == value;
        if low > high || !fits(low) || !fits(high) {
            let message = format!("bounds {low}..{high} are reversed or do not fit {base}");
            let span = ast.low.span.to(ast.high.span);
            self.report(Diagnostic::error(Code::InvalidRange, span, message));
            return None;
        }
        let ty = self.declarations_mut().types_mut().subrange(base, low, high);
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
