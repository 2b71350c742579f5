//! Ends and operators of other languages: what mends each.

use super::cursor::Cursor;
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::token::{Keyword, Punctuation, TokenKind};
use onescan_base::ElementaryType;

/// The ends of compound statements, as others write them in one word.
const ENDS: [(&str, Keyword); 5] = [
    ("ENDIF", Keyword::EndIf),
    ("ENDFOR", Keyword::EndFor),
    ("ENDWHILE", Keyword::EndWhile),
    ("ENDCASE", Keyword::EndCase),
    ("ENDREPEAT", Keyword::EndRepeat),
];

impl Cursor<'_> {
    /// The end that is meant by `ENDIF`, `END IF` or `NEXT i` here, with the number of its words.
    fn foreign_end(&self) -> Option<(Keyword, usize)> {
        if self.peek() != Some(TokenKind::Identifier) {
            return None;
        }
        let ends = |words| self.peek_ahead(words) == Some(TokenKind::Punctuation(Punctuation::Semicolon));
        let one = ENDS.into_iter().find(|(word, _)| self.at_word(word)).filter(|_| ends(1));
        let next = self.at_word("NEXT").then(|| (1..=2).find(|words| ends(*words))).flatten();
        let two = self.at_word("END").then(|| self.peek_ahead(1)).flatten().filter(|_| ends(2));
        match (one, next, two) {
            (Some((_, end)), ..) => Some((end, 1)),
            (_, Some(words), _) => Some((Keyword::EndFor, words)),
            (.., Some(TokenKind::Keyword(opened))) => Some((end_of(opened)?, 2)),
            _ => None,
        }
    }

    /// True before such an end.
    pub(super) fn at_foreign_end(&self) -> bool {
        self.foreign_end().is_some()
    }

    /// Reports such an end where `wanted` should stand, and passes it.
    pub(super) fn pass_foreign_end(&mut self, wanted: Keyword) -> bool {
        let Some((_, words)) = self.foreign_end().filter(|(end, _)| *end == wanted) else { return false };
        let start = self.span();
        (0..words).for_each(|_| self.advance());
        let (span, message) = (self.span_from(start), "this ends no statement");
        let help = format!("write `{}`", wanted.text());
        self.report(Diagnostic::error(Code::UnexpectedToken, span, message).with_help(help));
        true
    }

    /// What is meant where an expression is wanted and another mark stands.
    pub(super) fn meant_operand(&self) -> Option<&'static str> {
        use Punctuation as P;
        let (Some(TokenKind::Punctuation(before)), Some(TokenKind::Punctuation(here))) = (self.previous(), self.peek())
        else {
            return None;
        };
        Some(match (before, here) {
            (P::Equal, P::Equal) => "compare with `=`",
            (P::Ampersand, P::Ampersand) => "write `AND`",
            (P::Equal, P::Colon) => "assign with `:=`",
            (P::Equal, P::Less) => "write `<=`",
            (P::Equal, P::Greater) => "write `>=`",
            (P::Less, P::Less) => "write `SHL(a, n)` to shift to the left",
            (P::Greater, P::Greater) => "write `SHR(a, n)` to shift to the right",
            _ => return None,
        })
    }

    /// What is meant where a statement should have ended.
    pub(super) fn meant_behind(&self) -> Option<String> {
        use Punctuation as P;
        let is_number = |kind| matches!(kind, Some(TokenKind::Integer | TokenKind::Real));
        Some(match self.peek()? {
            TokenKind::DirectAddress if self.next_text() == "%" => {
                "the remainder of a division is `a MOD b`".to_owned()
            }
            TokenKind::Punctuation(P::Output) => "write `>=` for greater or equal".to_owned(),
            TokenKind::Punctuation(P::Comma) if is_number(self.previous()) && is_number(self.peek_ahead(1)) => {
                let whole = self.previous_span();
                let whole = self.text(whole.start, whole.end);
                format!("a real number has a point: `{whole}.{}`", self.text_ahead(1))
            }
            kind if is_number(Some(kind)) && self.previous() == Some(TokenKind::Punctuation(P::Caret)) => {
                "a power is `EXPT(a, n)`, or `a ** n`".to_owned()
            }
            _ => return None,
        })
    }

    /// What is meant by `INT n;` among statements, whose first name is given.
    pub(super) fn meant_declaration(&self, first: &str) -> Option<String> {
        let ty = ElementaryType::find(first)?;
        let is_name = self.peek() == Some(TokenKind::Identifier);
        is_name.then(|| format!("declare it between VAR and END_VAR: `{} : {ty};`", self.next_text()))
    }
}

fn end_of(opened: Keyword) -> Option<Keyword> {
    Some(match opened {
        Keyword::If => Keyword::EndIf,
        Keyword::For => Keyword::EndFor,
        Keyword::While => Keyword::EndWhile,
        Keyword::Case => Keyword::EndCase,
        Keyword::Repeat => Keyword::EndRepeat,
        _ => return None,
    })
}
