//! The type that `STRING[n]` names (2nd ed. 2.4.3.1).

use crate::check::body::Body;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::TypeId;
use crate::ir::text::{MAX_CAPACITY, TextShape};
use crate::syntax::{Span, ast};

impl Body<'_, '_> {
    /// The type that `STRING[n]` names.
    pub(in crate::check) fn text_type(&mut self, wide: bool, length: Option<&ast::Expr>, span: Span) -> Option<TypeId> {
        let capacity = match length {
            None => self.declarations.dialect(span).string_length(),
            Some(expr) => {
                let length = self.constant_integer(expr)?;
                let fits = u16::try_from(length).ok().filter(|length| (1..=MAX_CAPACITY).contains(length));
                let Some(capacity) = fits else {
                    let message = format!("a string's length is 1 to {MAX_CAPACITY}, not {length}");
                    self.report(Diagnostic::error(Code::InvalidRange, expr.span, message));
                    return None;
                };
                capacity
            }
        };
        let memory = self.declarations.dialect(span).strings();
        Some(self.declarations.types_mut().string(TextShape { wide, capacity, memory }))
    }
}
