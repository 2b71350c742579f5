//! `CONST a := 5; END_CONST` of S7-SCL: constants without a type. A use of one stands for its value.

use super::cursor::Cursor;
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::Feature;
use crate::source::Span;
use crate::syntax::ast::{Expr, ExprKind, Section};
use crate::syntax::token::{Punctuation, TokenKind};

impl Cursor<'_> {
    /// True where the section begins, which may be empty.
    pub(super) fn at_constants(&self) -> bool {
        let is_value = self.peek_ahead(2) == Some(TokenKind::Punctuation(Punctuation::Assign));
        let is_empty = self.text_ahead(1).eq_ignore_ascii_case("END_CONST");
        self.at_word("CONST") && self.peek_ahead(1) == Some(TokenKind::Identifier) && (is_value || is_empty)
    }

    pub(super) fn constants(&mut self) {
        self.require(Feature::UntypedConstants, self.span());
        self.advance();
        while self.peek() == Some(TokenKind::Identifier) && !self.at_word("END_CONST") {
            let known = self.reported();
            let Some(name) = self.take_identifier() else { break };
            self.expect_mark(Punctuation::Assign);
            let value = self.expression();
            let value = Expr { kind: ExprKind::Paren(Box::new(value.clone())), ..value };
            if self.constants_mut().insert(name.key(), value).is_some() {
                self.report_second(&name.text, name.span);
            }
            self.end_of_declaration(known);
        }
        if !self.take_word("END_CONST") {
            self.unexpected("a constant's name or `END_CONST`");
        }
        self.take_semicolons();
    }

    /// The value that the name stands for, at the place of the name.
    pub(super) fn constant_named(&mut self, text: &str, span: Span) -> Option<Expr> {
        if text.starts_with('"') || self.constants_mut().is_empty() {
            return None;
        }
        let key = text.trim_start_matches('#').trim_matches('"').to_ascii_uppercase();
        let value = self.constants_mut().get(&key)?.clone();
        Some(Expr { span, ..value })
    }

    /// Reports variables with the name of a constant.
    pub(super) fn report_hidden_constants(&mut self, sections: &[Section]) {
        let names = sections.iter().flat_map(|section| &section.variables).flat_map(|variable| &variable.names);
        for name in names {
            if self.constants_mut().contains_key(&name.key()) {
                self.report_second(&name.text, name.span);
            }
        }
    }

    fn report_second(&mut self, name: &str, span: Span) {
        self.report(Diagnostic::error(Code::DuplicateName, span, format!("`{name}` is declared twice")));
    }
}
