//! The vendors' functions of strings take and give 255 characters (CODESYS: library Standard, TwinCAT: `Tc2_Standard`).
//!
//! What is cut is the end, so that nothing is lost where no more than the beginning is wanted: in a `CONCAT` or `LEFT`,
//! and in a variable of 255 characters or fewer. Everywhere else it is reported.

use crate::check::body::Body;
use crate::check::types::constant::fold;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::text::{Edit, TextCall, TextFunction, TextShape};
use crate::ir::{Expr, ExprKind};
use crate::syntax::Span;

impl Body<'_, '_> {
    /// Most characters that a function takes and gives; nothing where it takes all.
    pub(super) fn most_characters(&self, span: Span) -> Option<u32> {
        // What is built in here does what the vendor's does by itself.
        let is_ours = self.declarations.is_in_library(span);
        self.declarations.dialect(span).text_functions().filter(|_| !is_ours)
    }

    /// What a function takes of a string.
    pub(super) fn taken_by_function(&mut self, expr: Expr) -> Option<Expr> {
        let (Some(most), Some(shape)) = (self.most_characters(expr.span), self.shape(expr.ty)) else {
            return Some(expr);
        };
        self.fitted(expr, TextShape { capacity: shape.capacity.min(most), ..shape })
    }

    /// Warns of a string that a function has cut, where all of it is wanted.
    pub(super) fn warn_of_cut_text(&mut self, expr: &Expr) {
        let Some(most) = self.most_characters(expr.span).filter(|most| self.is_cut_text(expr, *most)) else { return };
        let message = format!("only the first {most} characters count, and this may have more");
        let found = Diagnostic::warning(Code::CutText, expr.span, message);
        self.report(found.with_help("functions of strings take and give no more on the target: work on shorter parts"));
    }

    fn is_cut_text(&self, expr: &Expr, most: u32) -> bool {
        let capacity = |expr: &Expr| self.shape(expr.ty).map_or(0, |shape| shape.capacity);
        let ExprKind::Text(call) = &expr.kind else { return false };
        let TextCall { function: TextFunction::Edit(edit), operands, .. } = &**call else { return false };
        let strings = || operands.iter().take(edit.strings());
        match edit {
            Edit::Fit => strings().any(|each| capacity(each) > most && capacity(expr) == most),
            Edit::Concat | Edit::Insert | Edit::Replace => {
                strings().map(capacity).fold(0, u32::saturating_add) > most
                    || strings().any(|each| self.is_cut_text(each, most))
            }
            Edit::Left => {
                let length = operands.get(1).and_then(|length| fold(self.declarations.types(), length).ok()?.as_int());
                length.is_none_or(|length| length > most.into()) && strings().any(|each| self.is_cut_text(each, most))
            }
            Edit::Right | Edit::Middle | Edit::Delete => false,
        }
    }
}
