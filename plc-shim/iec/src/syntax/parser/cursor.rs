//! The parser's place in the tokens, what it has reported and how deep it is.

use std::collections::BTreeMap;

use super::MAX_NESTING;
use super::text_unit::TextUnit;
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::{Dialect, Feature};
use crate::source::origin::Origin;
use crate::source::{FileId, Span};
use crate::syntax::ast::{Expr, Ident, TemplateUse};
use crate::syntax::pragma::{attribute, behind_pragma, is_start_title, packing};
use crate::syntax::token::{Keyword, Punctuation, Token, TokenKind};

/// Reads the tokens that matter to the grammar; trivia and broken tokens are left out.
pub(super) struct Cursor<'a> {
    file: FileId,
    text: &'a str,
    tokens: Vec<Token>,
    at: usize,
    nesting: u16,
    diagnostics: Vec<Diagnostic>,
    /// Starts of broken tokens, in order: what is missing there has been reported by the lexer.
    broken: Vec<u32>,
    /// Findings not shown because another one explains them.
    suppressed: usize,
    abandoned: bool,
    dialect: Dialect,
    /// What the dialect lacks, at its first use in the file.
    foreign: BTreeMap<Feature, Diagnostic>,
    /// The way back into the file that the text was taken out of.
    origin: Option<&'a Origin>,
    /// The name that the unit's result has; nothing in units without one.
    result_name: Option<String>,
    /// Starts of tokens behind the pragma `{external}`, in order.
    external: Vec<(u32, ())>,
    /// The same behind `{attribute 'qualified_only'}`.
    qualified_only: Vec<(u32, ())>,
    /// The same behind `{attribute 'to_string'}`.
    to_string: Vec<(u32, ())>,
    /// The same behind `{attribute 'strict'}`.
    strict: Vec<(u32, ())>,
    /// The same behind `{attribute 'pack_mode' := '1'}`, with the bytes.
    packed: Vec<(u32, u32)>,
    /// The same behind `{attribute 'call_after_init'}`.
    call_after_init: Vec<(u32, ())>,
    /// The same behind the title that TIA Portal gives an organization block of the start.
    start_titles: Vec<(u32, ())>,
    /// True inside of what stands behind it.
    in_external: bool,
    /// The unit's constants without a type, by their keys.
    constants: BTreeMap<String, Expr>,
    /// Where generic blocks are named with their constants.
    templates: Vec<TemplateUse>,
    here: TextUnit,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(dialect: Dialect, file: FileId, text: &'a str, tokens: &[Token]) -> Self {
        let is_broken = |kind: TokenKind| matches!(kind, TokenKind::Unknown | TokenKind::Unterminated);
        let broken = tokens.iter().filter(|token| is_broken(token.kind)).map(|token| token.start);
        let starts_string =
            |token: &Token| text.get(token.start as usize..).is_some_and(|rest| rest.starts_with(['\'', '"']));
        let good = |token: &Token| match token.kind {
            // A string without an end still stands where a value is wanted.
            TokenKind::Unterminated if starts_string(token) => Some(Token { kind: TokenKind::String, ..*token }),
            TokenKind::Wire => Some(Token { kind: TokenKind::Identifier, ..*token }),
            kind if kind.is_trivia() || is_broken(kind) => None,
            _ => Some(*token),
        };
        let external = behind_pragma(tokens, text, |pragma| pragma.eq_ignore_ascii_case("external").then_some(()));
        let qualified_only =
            behind_pragma(tokens, text, |pragma| is_attribute(pragma, "'qualified_only'").then_some(()));
        let of_vendors = matches!(dialect, Dialect::Codesys | Dialect::TwinCat);
        let is_called = |pragma: &str| (of_vendors && is_attribute(pragma, "'call_after_init'")).then_some(());
        let call_after_init = behind_pragma(tokens, text, is_called);
        let starts = |title: &str| (dialect == Dialect::SiemensScl && is_start_title(title)).then_some(());
        let start_titles = behind_pragma(tokens, text, starts);
        let shows = |pragma: &str| (of_vendors && is_attribute(pragma, "'to_string'")).then_some(());
        let to_string = behind_pragma(tokens, text, shows);
        let limits = |pragma: &str| (of_vendors && is_attribute(pragma, "'strict'")).then_some(());
        let strict = behind_pragma(tokens, text, limits);
        let packed = behind_pragma(tokens, text, |pragma| packing(pragma).filter(|_| of_vendors));
        let mut tokens: Vec<Token> = tokens.iter().filter_map(good).collect();
        promote_soft_keywords(&mut tokens, text);
        Self {
            file,
            text,
            tokens,
            at: 0,
            nesting: 0,
            diagnostics: Vec::new(),
            broken: broken.collect(),
            suppressed: 0,
            abandoned: false,
            dialect,
            foreign: BTreeMap::new(),
            origin: None,
            result_name: None,
            external,
            qualified_only,
            to_string,
            strict,
            packed,
            call_after_init,
            start_titles,
            in_external: false,
            constants: BTreeMap::new(),
            templates: Vec::new(),
            here: TextUnit::default(),
        }
    }

    /// True if `{external}` stands before the next token.
    pub(super) fn at_external(&self) -> bool {
        self.before_next(&self.external).is_some()
    }

    /// True if `{attribute 'qualified_only'}` stands before the next token.
    pub(super) fn at_qualified_only(&self) -> bool {
        self.before_next(&self.qualified_only).is_some()
    }

    /// True if `{attribute 'to_string'}` stands before the next token.
    pub(super) fn at_to_string(&self) -> bool {
        self.before_next(&self.to_string).is_some()
    }

    /// True if `{attribute 'strict'}` stands before the next token.
    pub(super) fn at_strict(&self) -> bool {
        self.before_next(&self.strict).is_some()
    }

    /// True if `{attribute 'call_after_init'}` stands before the next token.
    pub(super) fn at_call_after_init(&self) -> bool {
        self.before_next(&self.call_after_init).is_some()
    }

    /// True if a block that began at `start` has the title of one that runs at the start.
    pub(super) fn has_start_title(&self, start: u32) -> bool {
        let end = self.span().start;
        self.start_titles.iter().any(|(at, ())| (start..end).contains(at))
    }

    /// Most bytes that the members of the structure behind the next token are aligned to, if an attribute says so.
    pub(super) fn packing(&self) -> Option<u32> {
        self.before_next(&self.packed)
    }

    /// What stands before the next token.
    fn before_next<T: Copy>(&self, found: &[(u32, T)]) -> Option<T> {
        let start = self.span().start;
        let at = found.binary_search_by_key(&start, |(start, _)| *start).ok()?;
        found.get(at).map(|(_, found)| *found)
    }

    /// The same, of text that was taken out of a file.
    pub(super) fn taken_out_of(self, origin: Option<&'a Origin>) -> Self {
        Self { origin, ..self }
    }

    /// True if the text there was made for something else in the file: it keeps to no dialect.
    pub(super) fn is_generated(&self, at: u32) -> bool {
        self.origin.is_some_and(|origin| !origin.is_verbatim(at))
    }

    pub(super) fn file(&self) -> FileId {
        self.file
    }

    pub(super) fn dialect(&self) -> Dialect {
        self.dialect
    }

    pub(super) fn note_template(&mut self, found: TemplateUse) {
        self.templates.push(found);
    }

    pub(super) fn take_templates(&mut self) -> Vec<TemplateUse> {
        std::mem::take(&mut self.templates)
    }

    pub(super) fn into_diagnostics(mut self) -> Vec<Diagnostic> {
        self.diagnostics.extend(self.foreign.into_values());
        self.diagnostics
    }

    /// Reports `feature` if the dialect lacks it, once for a file. The grammar goes on as if it had it.
    pub(super) fn require(&mut self, feature: Feature, span: Span) {
        self.require_or(feature, span, None);
    }

    /// The same, with what can be written instead.
    pub(super) fn require_or(&mut self, feature: Feature, span: Span, instead: Option<String>) {
        if !self.dialect.has(feature) && !self.is_generated(span.start) {
            let message = format!("{} is not part of {}", feature.about(), self.dialect);
            let homes = feature.help();
            let help = instead.map_or_else(|| homes.clone(), |instead| format!("write `{instead}`; {homes}"));
            let found = Diagnostic::error(Code::WrongDialect, span, message).with_help(help);
            self.foreign.entry(feature).or_insert(found);
        }
    }

    /// The name that the result of the unit has.
    pub(super) fn result_name(&self) -> Option<&str> {
        self.result_name.as_deref()
    }

    /// Sets it, and gives that of the unit around.
    pub(super) fn replace_result_name(&mut self, name: Option<String>) -> Option<String> {
        std::mem::replace(&mut self.result_name, name)
    }

    pub(super) fn here(&self) -> &TextUnit {
        &self.here
    }

    pub(super) fn replace_here(&mut self, here: TextUnit) -> TextUnit {
        std::mem::replace(&mut self.here, here)
    }

    /// Sets the constants without a type, and gives those of the unit around.
    pub(super) fn replace_constants(&mut self, constants: BTreeMap<String, Expr>) -> BTreeMap<String, Expr> {
        std::mem::replace(&mut self.constants, constants)
    }

    pub(super) fn constants_mut(&mut self) -> &mut BTreeMap<String, Expr> {
        &mut self.constants
    }

    /// Leaves out the tokens that `counts` says do not count.
    pub(super) fn keep(&mut self, counts: impl Fn(&Token) -> bool) {
        self.tokens.retain(counts);
    }

    pub(super) fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    /// Number of findings so far; shows whether a rule has reported any.
    pub(super) fn reported(&self) -> usize {
        self.diagnostics.len() + self.suppressed
    }

    /// Reports an error of the grammar, unless the lexer's error at this place explains it or the
    /// rest of the file has been given up.
    pub(super) fn report_syntax(&mut self, diagnostic: Diagnostic) {
        let (from, to) = (self.previous_span().start, self.span().start);
        let first = self.broken.partition_point(|start| *start < from);
        if self.abandoned || self.broken.get(first).is_some_and(|start| *start <= to) {
            self.suppressed += 1;
        } else {
            self.diagnostics.push(diagnostic);
        }
    }

    /// Notes that what is external begins or ends; gives what was before.
    pub(super) fn set_external(&mut self, external: bool) -> bool {
        std::mem::replace(&mut self.in_external, external)
    }

    /// True inside of what is done elsewhere, which keeps to no dialect.
    pub(super) fn is_in_external(&self) -> bool {
        self.in_external
    }

    /// Kind of the token taken last.
    pub(super) fn previous(&self) -> Option<TokenKind> {
        self.at.checked_sub(1).and_then(|at| self.tokens.get(at)).map(|token| token.kind)
    }

    pub(super) fn text(&self, start: u32, end: u32) -> &'a str {
        self.text.get(start as usize..end as usize).unwrap_or("")
    }

    pub(super) fn peek(&self) -> Option<TokenKind> {
        self.tokens.get(self.at).map(|token| token.kind)
    }

    pub(super) fn peek_ahead(&self, ahead: usize) -> Option<TokenKind> {
        self.tokens.get(self.at + ahead).map(|token| token.kind)
    }

    /// The text of the token so many places ahead.
    pub(super) fn text_ahead(&self, ahead: usize) -> &'a str {
        self.tokens.get(self.at + ahead).map_or("", |token| self.text(token.start, token.end))
    }

    /// True if a line ends before the token so many places ahead, or nothing follows.
    pub(super) fn is_line_break(&self, ahead: usize) -> bool {
        let Some(next) = self.tokens.get(self.at + ahead) else { return true };
        let before = (self.at + ahead).checked_sub(1).and_then(|before| self.tokens.get(before));
        before.is_none_or(|before| self.text(before.end, next.start).contains('\n'))
    }

    /// True if nothing stands between the token so many places ahead and the one behind it.
    pub(super) fn touches_next(&self, ahead: usize) -> bool {
        self.touch(self.at + ahead)
    }

    /// True if nothing stands between the token taken last and the one here.
    pub(super) fn touches_before(&self) -> bool {
        self.at.checked_sub(1).is_some_and(|before| self.touch(before))
    }

    /// True if nothing stands between this token and the one behind it.
    fn touch(&self, token: usize) -> bool {
        let pair = (self.tokens.get(token), self.tokens.get(token + 1));
        matches!(pair, (Some(first), Some(second)) if first.end == second.start)
    }

    /// Makes names of the keyword here and of those behind it that stand where a name does.
    pub(super) fn take_for_names(&mut self, keyword: Keyword) {
        let word = TokenKind::Keyword(keyword);
        let mut before = None;
        for at in self.at..self.tokens.len() {
            let next = self.tokens.get(at + 1).map(|token| token.kind);
            if self.tokens[at].kind == word && (at == self.at || is_name_place(before, next)) {
                self.tokens[at].kind = TokenKind::Identifier;
            }
            before = Some(self.tokens[at].kind);
        }
    }

    pub(super) fn take_word(&mut self, word: &str) -> bool {
        let found = self.at_word(word);
        if found {
            self.advance();
        }
        found
    }

    /// Number of tokens taken so far; shows whether a rule has made progress.
    pub(super) fn position(&self) -> usize {
        self.at
    }

    /// Span of the next token, or of the text's end.
    pub(super) fn span(&self) -> Span {
        let end = self.text.len() as u32;
        let (start, end) = self.tokens.get(self.at).map_or((end, end), |next| (next.start, next.end));
        Span::new(self.file, start, end)
    }

    /// Span of the token taken last.
    pub(super) fn previous_span(&self) -> Span {
        let previous = self.at.checked_sub(1).and_then(|at| self.tokens.get(at));
        let (start, end) = previous.map_or((0, 0), |token| (token.start, token.end));
        Span::new(self.file, start, end)
    }

    /// From `start` to the token taken last.
    pub(super) fn span_from(&self, start: Span) -> Span {
        let end = self.previous_span().end.max(start.start);
        Span { end, ..start }
    }

    pub(super) fn next_text(&self) -> &'a str {
        let span = self.span();
        self.text(span.start, span.end)
    }

    pub(super) fn advance(&mut self) {
        self.at = (self.at + 1).min(self.tokens.len());
    }

    pub(super) fn at_keyword(&self, keyword: Keyword) -> bool {
        self.peek() == Some(TokenKind::Keyword(keyword))
    }

    pub(super) fn at_mark(&self, mark: Punctuation) -> bool {
        self.peek() == Some(TokenKind::Punctuation(mark))
    }

    pub(super) fn take_keyword(&mut self, keyword: Keyword) -> bool {
        let found = self.at_keyword(keyword);
        if found {
            self.advance();
        }
        found
    }

    pub(super) fn take_mark(&mut self, mark: Punctuation) -> bool {
        let found = self.at_mark(mark);
        if found {
            self.advance();
        }
        found
    }

    /// All that follow a heading or section, so that a body never begins with one of them.
    pub(super) fn take_semicolons(&mut self) {
        while self.take_mark(Punctuation::Semicolon) {}
    }

    pub(super) fn expect_keyword(&mut self, keyword: Keyword) -> bool {
        let found = self.take_keyword(keyword);
        if !found {
            self.unexpected(&format!("`{}`", keyword.text()));
        }
        found
    }

    pub(super) fn expect_mark(&mut self, mark: Punctuation) -> bool {
        let found = self.take_mark(mark);
        if !found {
            self.unexpected(&format!("`{}`", mark.text()));
        }
        found
    }

    pub(super) fn take_identifier(&mut self) -> Option<Ident> {
        if self.peek() != Some(TokenKind::Identifier) {
            return None;
        }
        let text = self.next_text().trim_start_matches('#').trim_matches('"').to_owned();
        let ident = Ident { text, span: self.span() };
        self.advance();
        Some(ident)
    }

    /// True if the next token is this word, in any case.
    pub(super) fn at_word(&self, word: &str) -> bool {
        self.peek() == Some(TokenKind::Identifier) && self.next_text().eq_ignore_ascii_case(word)
    }

    pub(super) fn expect_identifier(&mut self, what: &str) -> Option<Ident> {
        self.name_keyword();
        let found = self.take_identifier();
        if found.is_none() {
            self.unexpected(what);
        }
        found
    }

    /// Reports that `wanted` should stand here, unless this place has been reported already.
    pub(super) fn unexpected(&mut self, wanted: &str) {
        self.report_missing(wanted, None);
    }

    /// The same for the end of the statement that begins at `opened`, which is shown, too.
    pub(super) fn unexpected_end(&mut self, end: Keyword, opened: Span) {
        self.report_missing(&format!("`{}`", end.text()), Some(opened));
    }

    fn report_missing(&mut self, wanted: &str, opened: Option<Span>) {
        let found =
            if self.peek().is_some() { format!("`{}`", self.next_text()) } else { "the end of the file".to_owned() };
        let span = self.span();
        let repeated = self.diagnostics.last().is_some_and(|last| last.span == span);
        if !repeated {
            let message = format!("{wanted} expected, found {found}");
            let mut missing = Diagnostic::error(Code::UnexpectedToken, span, message);
            if let Some(opened) = opened {
                missing = missing.with_label(opened, "begins here");
            }
            self.report_syntax(missing);
        }
    }

    /// Runs `rule` one level deeper; past the limit it reports and gives nothing.
    pub(super) fn nested<T>(&mut self, rule: impl FnOnce(&mut Self) -> T) -> Option<T> {
        if self.nesting == MAX_NESTING {
            self.too_deep();
            return None;
        }
        self.nesting += 1;
        let result = rule(self);
        self.nesting -= 1;
        Some(result)
    }

    /// Reports text that is nested too deep, once for a file: what follows cannot be trusted.
    pub(super) fn too_deep(&mut self) {
        let message = format!("nested deeper than {MAX_NESTING} levels");
        let span = self.span();
        self.report(Diagnostic::error(Code::NestingTooDeep, span, message));
        self.at = self.tokens.len();
        self.abandoned = true;
    }

    /// Reports an expression that is too high, unless the same was reported of a part of it.
    pub(super) fn report_too_high(&mut self, found: Diagnostic) {
        let of_part = |last: &Diagnostic| last.code == found.code && last.span.start >= found.span.start;
        if self.diagnostics.last().is_some_and(of_part) {
            self.suppressed += 1;
        } else {
            self.diagnostics.push(found);
        }
    }

    /// Skips to a token that `stop` accepts, or to the end.
    pub(super) fn skip_until(&mut self, stop: impl Fn(TokenKind) -> bool) {
        while let Some(kind) = self.peek() {
            if stop(kind) {
                return;
            }
            self.advance();
        }
    }
}

/// True if a keyword that stands between operands, or behind a name, stands here as a name itself.
fn is_name_place(before: Option<TokenKind>, next: Option<TokenKind>) -> bool {
    use Punctuation as P;
    let behind_operand = matches!(
        before,
        Some(
            TokenKind::Identifier
                | TokenKind::Integer
                | TokenKind::Real
                | TokenKind::Typed
                | TokenKind::String
                | TokenKind::WideString
                | TokenKind::DirectAddress
                | TokenKind::Keyword(Keyword::True | Keyword::False)
                | TokenKind::Punctuation(P::RightParen | P::RightBracket | P::Caret)
        )
    );
    // `MOD(a, b)` is a function, and an address follows `AT`.
    let follows = matches!(next, Some(TokenKind::Punctuation(P::LeftParen) | TokenKind::DirectAddress));
    !behind_operand && !follows
}

/// A name never follows another, so `METHOD Start` begins a method, and `method := 1` assigns. Nor has
/// anything but a transition a priority.
fn promote_soft_keywords(tokens: &mut [Token], text: &str) {
    let spelling = |token: &Token| text.get(token.start as usize..token.end as usize);
    let mut next_is_name = false;
    for at in (0..tokens.len()).rev() {
        let is_name = tokens[at].kind == TokenKind::Identifier;
        let ranked = || {
            let behind = (tokens.get(at + 1)?, tokens.get(at + 2)?);
            let opens = behind.0.kind == TokenKind::Punctuation(Punctuation::LeftParen);
            Some(opens && spelling(behind.1)?.eq_ignore_ascii_case("PRIORITY"))
        };
        if is_name && let Some(word) = spelling(&tokens[at]).and_then(Keyword::find) {
            let named = at.checked_sub(1).and_then(|before| spelling(&tokens[before])).is_some_and(names_what_follows);
            let is_member =
                at.checked_sub(1).is_some_and(|before| tokens[before].kind == TokenKind::Punctuation(Punctuation::Dot));
            let soft = next_is_name && !is_member && (word.is_soft() || word.is_of_chart() && !named);
            if soft || word == Keyword::Transition && ranked() == Some(true) {
                tokens[at].kind = TokenKind::Keyword(word);
            }
        }
        next_is_name = is_name;
    }
}

fn is_attribute(pragma: &str, wanted: &str) -> bool {
    attribute(pragma).is_some_and(|attribute| attribute.eq_ignore_ascii_case(wanted))
}

/// True for a word whose next one is a name, be it one that begins a part of a chart elsewhere: `CLASS Step IMPLEMENTS`.
fn names_what_follows(word: &str) -> bool {
    let words = ["CLASS", "INTERFACE", "FUNCTION_BLOCK", "METHOD", "PROPERTY", "EXTENDS", "IMPLEMENTS"];
    words.iter().any(|known| known.eq_ignore_ascii_case(word))
}
