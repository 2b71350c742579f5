//! `__TRY` and what belongs to it (CODESYS and TwinCAT).

use super::cursor::Cursor;
use crate::dialect::Feature;
use crate::syntax::ast::{StatementKind, TryStatement};
use crate::syntax::token::Punctuation;

pub(super) const TRY: &str = "__TRY";
const CATCH: &str = "__CATCH";
const FINALLY: &str = "__FINALLY";
const END: &str = "__ENDTRY";

impl Cursor<'_> {
    /// `__TRY … __CATCH(code) … __FINALLY … __ENDTRY`
    pub(super) fn try_statement(&mut self) -> StatementKind {
        self.require(Feature::Exceptions, self.span());
        self.advance();
        let mut parts = TryStatement { body: self.guarded(), code: None, handler: Vec::new(), finally: Vec::new() };
        if self.take_word(CATCH) {
            if self.take_mark(Punctuation::LeftParen) {
                parts.code = Some(self.expression());
                self.expect_mark(Punctuation::RightParen);
            }
            parts.handler = self.guarded();
        }
        if self.take_word(FINALLY) {
            parts.finally = self.guarded();
        }
        if !self.take_word(END) {
            self.unexpected("`__ENDTRY`");
        }
        StatementKind::Try(Box::new(parts))
    }

    fn guarded(&mut self) -> Vec<crate::syntax::ast::Statement> {
        self.statements_until(|cursor| [CATCH, FINALLY, END].iter().any(|word| cursor.at_word(word)))
    }
}
