//! The type that `STRING[n]` names (2nd ed. 2.4.3.1).

use crate::check::body::Body;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::TypeId;
use crate::ir::text::TextShape;
use crate::syntax::{Span, ast};

impl Body<'_, '_> {
    /// The type that `STRING[n]` names.
    pub(in crate::check) fn text_type(&mut self, wide: bool, length: Option<&ast::Expr>, span: Span) -> Option<TypeId> {
        let capacity = match length {
            None => self.declarations.dialect(span).string_length().into(),
            Some(expr) => {
                let length = self.constant_integer(expr)?;
                let most = TextShape::most(self.declarations.dialect(span).strings());
                let fits = u32::try_from(length).ok().filter(|length| (1..=most).contains(length));
                let Some(capacity) = fits else {
                    let message = format!("a string's length is 1 to {most}, not {length}");
                    self.report(Diagnostic::error(Code::InvalidRange, expr.span, message));
                    return None;
                };
                capacity
            }
        };
        let memory = self.declarations.dialect(span).strings();
        let shape = TextShape { wide, capacity, memory };
        if u64::from(shape.size()) > self.declarations.memory_limit() {
            self.declarations.report_too_large(span, Some(shape.size().into()));
            return None;
        }
        Some(self.declarations.types_mut().string(shape))
    }
}
