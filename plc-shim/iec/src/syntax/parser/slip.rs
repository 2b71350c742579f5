//! What other languages write, and what is a slip of the hand: each is reported once, with what mends it.

use super::cursor::Cursor;
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::Feature;
use crate::source::Span;
use crate::syntax::ast::{
    Dimension, Expr, ExprKind, Ident, IfBranch, IfStatement, Literal, Statement, StatementKind, TypeSpec, TypeSpecKind,
};
use crate::syntax::lexer::is_typographic_quote;
use crate::syntax::token::{Keyword, Punctuation, TokenKind};

impl Cursor<'_> {
    fn report_slip(&mut self, span: Span, message: impl Into<String>, help: impl Into<String>) {
        self.report(Diagnostic::error(Code::UnexpectedToken, span, message).with_help(help));
    }

    /// What begins no statement here, and does in other languages.
    pub(super) fn slip(&mut self) -> Option<StatementKind> {
        let span = self.span();
        let next = self.peek_ahead(1);
        let ends = next == Some(TokenKind::Punctuation(Punctuation::Semicolon));
        if self.at_word("CONTINUE") && ends {
            self.require(Feature::Continue, span);
            self.advance();
            return Some(StatementKind::Continue);
        }
        let (message, help) = if self.at_word("ELSEIF") || self.at_word("ELIF") {
            ("this begins no branch", "write `ELSIF`".to_owned())
        } else if self.at_word("BREAK") && ends {
            ("this is not a statement", "write `EXIT` to leave a loop; a branch of CASE ends by itself".to_owned())
        } else if self.at_mark(Punctuation::Star) && next == Some(TokenKind::Punctuation(Punctuation::RightParen)) {
            self.advance();
            ("there is no `(*` before this", "a comment in a comment has an end of its own".to_owned())
        } else if self.peek() == Some(TokenKind::Identifier)
            && next == Some(TokenKind::Punctuation(Punctuation::Colon))
            && self.peek_ahead(2) == Some(TokenKind::Punctuation(Punctuation::Equal))
        {
            ("there is a blank in `:=`", "write `:=`".to_owned())
        } else if let Some(sign) = self.doubled_sign(0) {
            let name = self.text_ahead(2);
            self.advance();
            ("there is no operator `++` or `--`", format!("write `{name} := {name} {sign} 1`"))
        } else {
            return None;
        };
        self.report_slip(span, message, help);
        self.advance();
        Some(StatementKind::Error)
    }

    /// The sign of `++` or `--` that begins so many tokens ahead.
    fn doubled_sign(&self, ahead: usize) -> Option<&'static str> {
        let sign = match self.peek_ahead(ahead)? {
            TokenKind::Punctuation(Punctuation::Plus) => Punctuation::Plus,
            TokenKind::Punctuation(Punctuation::Minus) => Punctuation::Minus,
            _ => return None,
        };
        let doubled = self.peek_ahead(ahead + 1) == Some(TokenKind::Punctuation(sign)) && self.touches_next(ahead);
        doubled.then(|| sign.text())
    }

    /// True if the statement that begins here ends in `++;` or `--;`.
    pub(super) fn is_increment(&self) -> bool {
        // Longer ones are not looked for: a file without semicolons would be gone through for each word.
        let end = (0..32).find(|ahead| {
            matches!(
                self.peek_ahead(*ahead),
                None | Some(TokenKind::Keyword(_) | TokenKind::Punctuation(Punctuation::Semicolon))
            )
        });
        let Some(end @ 3..) = end else { return false };
        self.peek_ahead(end) == Some(TokenKind::Punctuation(Punctuation::Semicolon))
            && self.doubled_sign(end - 2).is_some()
    }

    /// Reports `++` behind what it is to count, and passes it.
    pub(super) fn pass_increment(&mut self, target: &Expr) -> bool {
        let Some(sign) = self.doubled_sign(0).filter(|_| self.is_increment_end()) else { return false };
        let start = self.span();
        self.advance();
        self.advance();
        let name = self.text(target.span.start, target.span.end);
        let help = format!("write `{name} := {name} {sign} 1`");
        self.report_slip(self.span_from(start), format!("there is no operator `{sign}{sign}`"), help);
        true
    }

    fn is_increment_end(&self) -> bool {
        self.peek_ahead(2) == Some(TokenKind::Punctuation(Punctuation::Semicolon))
    }

    /// Reports the doubled quote of `'it''s'` behind the first of its parts, and passes the others.
    pub(super) fn pass_doubled_quote(&mut self) {
        let is_part = |kind| matches!(kind, Some(TokenKind::String | TokenKind::WideString));
        if !is_part(self.peek()) || !self.touches_before() {
            return;
        }
        let help = "write `$'` for a quote within a string, `$\"` within a WSTRING";
        self.report_slip(self.span(), "a doubled quote ends the string", help);
        while is_part(self.peek()) && self.touches_before() {
            self.advance();
        }
    }

    /// Reports the `STEP` of other languages where `DO` is wanted; true if it stands here.
    pub(super) fn foreign_step(&mut self, wanted: Keyword) -> bool {
        let is_step = wanted == Keyword::Do && self.at_word("STEP");
        if is_step {
            self.report_slip(self.span(), "a step of FOR begins with another word", "write `BY`");
        }
        is_step
    }

    /// Reports `FOR i = 0`.
    pub(super) fn report_equal_for_assign(&mut self) {
        self.report_slip(self.span(), "`:=` expected, found `=`", "assign with `:=`");
    }

    /// Reports an IF that `ELSE IF` began and nothing ended.
    pub(super) fn report_else_if(&mut self, place: Span) {
        self.report_slip(
            place,
            "the IF that begins here has no `END_IF`",
            "write `ELSIF` for another branch of the same IF",
        );
    }

    /// What `RETURN` is; `RETURN (b)` returns if `b` holds, where the dialect has that. Otherwise a value behind it on its line is reported, and goes to the result.
    pub(super) fn returned(&mut self) -> StatementKind {
        self.advance();
        let begins_value = match self.peek() {
            Some(TokenKind::Punctuation(Punctuation::LeftParen | Punctuation::Minus)) => true,
            Some(TokenKind::Keyword(word)) => matches!(word, Keyword::Not | Keyword::True | Keyword::False),
            Some(TokenKind::Punctuation(_)) | None => false,
            Some(_) => true,
        };
        // On the next line another statement begins, and a semicolon is missing.
        if !begins_value || self.is_line_break(0) {
            return StatementKind::Return;
        }
        let conditional = self.at_mark(Punctuation::LeftParen) && self.dialect().has(Feature::ConditionalReturns);
        let known = self.reported();
        let (start, value) = (self.span(), self.expression());
        if conditional {
            let body = vec![Statement { kind: StatementKind::Return, span: self.span_from(start) }];
            let branches = vec![IfBranch { condition: value, body }];
            return StatementKind::If(IfStatement { branches, otherwise: Vec::new() });
        }
        if self.reported() > known {
            return StatementKind::Return;
        }
        let text = self.text(value.span.start, value.span.end);
        let result = self.result_name().map(|name| Ident { text: name.to_owned(), span: value.span });
        let help = match &result {
            Some(name) => format!("write `{} := {text}; RETURN;`", name.text),
            None => "write `RETURN;`, there is no result here".to_owned(),
        };
        self.report_slip(value.span, "`RETURN` takes no value", help);
        let Some(name) = result else { return StatementKind::Return };
        let target = Expr { kind: ExprKind::Name(name), span: value.span, height: 1 };
        StatementKind::Assign(target, value)
    }

    /// True at `case 1:`, a label as other languages have it.
    pub(super) fn at_foreign_label(&self) -> bool {
        self.at_keyword(Keyword::Case)
            && matches!(self.peek_ahead(1), Some(TokenKind::Integer | TokenKind::Identifier | TokenKind::Typed))
            && self.peek_ahead(2) == Some(TokenKind::Punctuation(Punctuation::Colon))
    }

    /// Reports the `case` of `case 1:`, and passes it.
    pub(super) fn pass_foreign_label(&mut self) {
        if self.at_foreign_label() {
            let help = format!("write `{}:`", self.text_ahead(1));
            self.report_slip(self.span(), "a label is its value alone", help);
            self.advance();
        }
    }

    /// Reports `[10]`, a number of elements where bounds are wanted.
    pub(super) fn dimension_of(&mut self, count: Expr) -> Dimension {
        let help = format!("write `{}`", bounds_for(self.text(count.span.start, count.span.end), &count));
        self.report_slip(count.span, "an array has two bounds", help);
        Dimension { low: zero(count.span), high: count }
    }

    /// `INT[5]`: reports it and gives the array that is meant; the name of the type has been taken.
    pub(super) fn counted_array(&mut self, element: Ident) -> TypeSpecKind {
        let (start, known) = (element.span, self.reported());
        self.advance();
        let count = self.expression();
        self.expect_mark(Punctuation::RightBracket);
        if self.reported() == known {
            let bounds = bounds_for(self.text(count.span.start, count.span.end), &count);
            let help = format!("write `ARRAY [{bounds}] OF {}`", element.text);
            self.report_slip(self.span_from(start), "this is not a type", help);
        }
        let spec = TypeSpec { span: element.span, kind: TypeSpecKind::Name(element) };
        TypeSpecKind::Array(vec![Dimension { low: zero(count.span), high: count }], Box::new(spec))
    }

    /// True at `a[5] :`, a variable as C declares it.
    pub(super) fn at_counted_name(&self) -> bool {
        use Punctuation as P;
        self.peek() == Some(TokenKind::Identifier)
            && self.peek_ahead(1) == Some(TokenKind::Punctuation(P::LeftBracket))
            && self.peek_ahead(2) == Some(TokenKind::Integer)
            && self.peek_ahead(3) == Some(TokenKind::Punctuation(P::RightBracket))
            && self.peek_ahead(4) == Some(TokenKind::Punctuation(P::Colon))
    }

    /// Reports the brackets behind the name of a variable, and passes them.
    pub(super) fn pass_count(&mut self) {
        let start = self.span();
        self.advance();
        let count = self.expression();
        self.expect_mark(Punctuation::RightBracket);
        let bounds = bounds_for(self.text(count.span.start, count.span.end), &count);
        let help = format!("write `: ARRAY [{bounds}] OF` and the type");
        self.report_slip(self.span_from(start), "bounds are part of the type", help);
    }
}

/// What mends text that begins no token.
pub(super) fn meant_by(text: &str) -> Option<String> {
    Some(match text {
        "|" | "||" => "write `OR`".to_owned(),
        "!" => "write `NOT`, or `<>` for `!=`".to_owned(),
        "?" => "write an IF, or `SEL(condition, b, a)`".to_owned(),
        "~" => "write `NOT`".to_owned(),
        _ if text.starts_with(is_typographic_quote) => {
            let inside = text.trim_matches(is_typographic_quote);
            format!("these are quotes of a word processor: write `'{inside}'`")
        }
        _ => {
            let digits = text.strip_prefix('$').filter(|digits| !digits.is_empty())?;
            format!("a hexadecimal number is written `16#{digits}`")
        }
    })
}

/// The bounds of so many elements.
fn bounds_for(text: &str, count: &Expr) -> String {
    match count.kind {
        ExprKind::Literal(Literal::Integer(count @ 1..)) => format!("0..{}", count - 1),
        _ => format!("0..{text} - 1"),
    }
}

fn zero(span: Span) -> Expr {
    Expr { kind: ExprKind::Literal(Literal::Integer(0)), span, height: 1 }
}

/// Keywords that stand between operands or behind a name, so that their place shows whether one is meant as a name.
fn is_known_by_place(keyword: Keyword) -> bool {
    use Keyword as K;
    matches!(keyword, K::Of | K::At | K::To | K::By | K::Do | K::Then | K::Mod | K::And | K::Or | K::Xor)
}

impl Cursor<'_> {
    /// Reports a keyword that is declared as a name. From there on it is one wherever its place says so: its uses
    /// are not reported as well.
    pub(super) fn name_keyword(&mut self) {
        use Punctuation as P;
        let Some(TokenKind::Keyword(keyword)) = self.peek() else { return };
        let declared = match self.peek_ahead(1) {
            Some(TokenKind::Punctuation(mark)) => {
                matches!(mark, P::Colon | P::Comma | P::Assign | P::Semicolon | P::RightParen)
            }
            Some(TokenKind::Keyword(next)) => next == Keyword::At || is_section(next),
            _ => false,
        };
        if declared && is_known_by_place(keyword) {
            self.report_keyword_as_name();
            self.take_for_names(keyword);
        }
    }

    /// Reports `if : INT;`.
    pub(super) fn report_keyword_as_name(&mut self) {
        let name = self.next_text();
        let help = format!("choose another name, such as `{name}_value`");
        self.report_slip(self.span(), format!("`{name}` is a keyword, not a name"), help);
    }
}

fn is_section(keyword: Keyword) -> bool {
    use Keyword as K;
    matches!(
        keyword,
        K::Var | K::VarInput | K::VarOutput | K::VarInOut | K::VarTemp | K::VarExternal | K::VarStat | K::VarInst
    )
}
