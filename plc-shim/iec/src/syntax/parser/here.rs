//! Where the text stands, as `__POUNAME()` and `__POSITION()` give it (CODESYS, TwinCAT): they are literals.

use super::cursor::Cursor;
use super::text_unit::TextUnit;
use crate::dialect::Feature;
use crate::source::Span;
use crate::syntax::ast::{ExprKind, Literal};
use crate::syntax::token::{Punctuation, TokenKind};

impl Cursor<'_> {
    /// Goes into a unit or a part of it; gives what was around.
    pub(super) fn enter(&mut self, name: &str, start: Span) -> TextUnit {
        let around = self.here();
        let name = if around.in_unit { format!("{}.{name}", around.name) } else { name.to_owned() };
        self.replace_here(TextUnit { name, in_unit: true, from: start.start, in_body: false })
    }

    /// Goes into a list of global variables, or another namespace.
    pub(super) fn enter_namespace(&mut self, name: &str, start: Span) -> TextUnit {
        self.replace_here(TextUnit { name: name.to_owned(), in_unit: false, from: start.start, in_body: false })
    }

    /// Goes on to the statements of the unit, which the last token stands before.
    pub(super) fn enter_body(&mut self) -> TextUnit {
        let from = self.previous_span().end;
        let here = TextUnit { from, in_body: true, ..self.here().clone() };
        self.replace_here(here)
    }

    /// `__POUNAME()` or `__POSITION()`, if that stands here.
    pub(super) fn place_of_text(&mut self, span: Span) -> Option<ExprKind> {
        let is_name = self.at_word("__POUNAME");
        let mark = |mark| Some(TokenKind::Punctuation(mark));
        if !is_name && !self.at_word("__POSITION")
            || self.peek_ahead(1) != mark(Punctuation::LeftParen)
            || self.peek_ahead(2) != mark(Punctuation::RightParen)
        {
            return None;
        }
        self.require(Feature::PlacesOfText, span);
        self.advance();
        self.advance();
        let text = if is_name { self.here().name.clone() } else { self.position_text(span) };
        Some(ExprKind::Literal(Literal::String(format!("'{text}'"))))
    }

    /// Lines are those of the declaration or of the statements, as the tools' editors number them.
    fn position_text(&self, span: Span) -> String {
        let before = self.text(self.here().from, span.start);
        let lines = before.matches('\n').count();
        if !self.here().in_body {
            return format!("Line {} (Decl)", lines + 1);
        }
        let column = self.text(0, span.start).chars().rev().take_while(|character| *character != '\n').count() + 1;
        format!("Line {}, Column {column} (Impl)", lines.max(1))
    }
}
