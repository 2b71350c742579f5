//! Tokens to tree: recursive descent, with precedence climbing for expressions.
//!
//! An error is reported once and skipped up to a token at which the grammar can go on, so that
//! one slip makes one diagnostic.

mod assignment;
mod chart;
mod conditional;
mod configuration;
mod cursor;
mod declaration;
mod exception;
mod expression;
mod foreign;
mod here;
mod initialiser;
mod instruction;
mod object;
mod scl;
mod slip;
mod statement;
mod text_unit;
mod type_spec;
mod untyped_constant;

use self::cursor::Cursor;
use super::ast::{CompilationUnit, Expr, Initialiser};
use super::lexer::{tokenize, tokenize_in};
use super::pragma::sets_by_c;
use super::token::{Token, TokenKind};
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::{Dialect, Feature};
use crate::source::origin::Origin;
use crate::source::{FileId, SourceFile};
use crate::syntax::Span;

/// Greatest depth to which statements, types and parentheses may be nested.
pub const MAX_NESTING: u16 = 200;

/// More characters than these that begin no token are not slips, if the file declares nothing.
const RUBBISH: usize = 3;

/// A file's tree, beside its tokens.
#[derive(Debug, Clone)]
pub struct Parsed {
    /// Every token of the file.
    pub tokens: Vec<Token>,
    pub unit: CompilationUnit,
    /// What is wrong with the text.
    pub diagnostics: Vec<Diagnostic>,
}

/// Parses `text`, the text of `file`, in the default dialect. Never fails: the tree holds what could be
/// understood.
pub fn parse(file: FileId, text: &str) -> Parsed {
    parse_in(Dialect::default(), file, text)
}

/// Parses `text`, the text of `file`, as `dialect`. Never fails either.
pub fn parse_in(dialect: Dialect, file: FileId, text: &str) -> Parsed {
    parse_text(dialect, file, text, None)
}

/// Parses a file in its own dialect; text that stands for other than text in it may be what only the
/// extraction writes. Never fails either.
pub fn parse_source(id: FileId, file: &SourceFile) -> Parsed {
    let mut parsed = parse_text(file.dialect(), id, file.text(), file.origin());
    parsed.unit.word_size = file.word_size();
    parsed
}

fn parse_text(dialect: Dialect, file: FileId, text: &str, origin: Option<&Origin>) -> Parsed {
    let tokens = tokenize_in(dialect, text);
    let mut cursor = Cursor::new(dialect, file, text, &tokens).taken_out_of(origin);
    report_lexical_errors(&mut cursor, &tokens);
    conditional::apply(&mut cursor, &tokens);
    let declared = cursor.compilation_unit();
    let unit = CompilationUnit { dialect, templates: cursor.take_templates(), ..declared };
    let mut diagnostics = cursor.into_diagnostics();
    if unit.declarations.is_empty() {
        leave_out_rubbish(&mut diagnostics);
    }
    Parsed { tokens, unit, diagnostics }
}

/// In a file that declares nothing, its first error says it all: what stands in it is not a program.
fn leave_out_rubbish(diagnostics: &mut Vec<Diagnostic>) {
    let unknown = |found: &Diagnostic| found.code == Code::UnknownCharacter;
    let grammar = diagnostics.iter().position(|found| found.code == Code::UnexpectedToken);
    if let Some(first) = grammar.filter(|_| diagnostics.iter().filter(|found| unknown(found)).count() > RUBBISH) {
        let first = diagnostics.swap_remove(first);
        *diagnostics = vec![first.with_help("this file seems to hold something else than a program")];
    }
}

/// The initial value that `text`, the text of `file`, is on its own, and what is wrong with it.
pub(crate) fn parse_initialiser(dialect: Dialect, file: FileId, text: &str) -> (Initialiser, Vec<Diagnostic>) {
    let tokens = tokenize_in(dialect, text);
    let mut cursor = Cursor::new(dialect, file, text, &tokens);
    report_lexical_errors(&mut cursor, &tokens);
    let initialiser = cursor.initialiser();
    if cursor.peek().is_some() {
        cursor.unexpected("the end of the value");
    }
    (initialiser, cursor.into_diagnostics())
}

/// The expression that `text` is, if it is one without errors.
pub fn parse_expression(text: &str) -> Option<Expr> {
    let tokens = tokenize(text);
    let mut cursor = Cursor::new(Dialect::default(), FileId(0), text, &tokens);
    report_lexical_errors(&mut cursor, &tokens);
    let expression = cursor.expression();
    (cursor.peek().is_none() && cursor.reported() == 0).then_some(expression)
}

/// Says that C code, which `MatIEC` takes between braces, is not carried out: what it sets would be missing.
fn report_c_code(cursor: &mut Cursor<'_>, span: Span) {
    let text = cursor.text(span.start, span.end);
    let sets = sets_by_c(text);
    if sets && cursor.dialect().has(Feature::CCode) {
        let message = "C code is a stub: the variables that it sets keep their values";
        let found = Diagnostic::warning(Code::StubUsed, span, message);
        cursor.report(found.with_help("write in Structured Text what it does"));
    } else if sets {
        let message = "C code that sets variables is not carried out";
        let found = Diagnostic::error(Code::VendorRuntime, span, message);
        let help = format!("write in Structured Text what it does; {}", Feature::CCode.help());
        cursor.report(found.with_help(help));
    } else if text.starts_with("{{") {
        let found = Diagnostic::warning(Code::VendorRuntime, span, "C code is not carried out");
        cursor.report(found.with_help("it sets no variable, so the values are the same without it"));
    }
}

fn report_lexical_errors(cursor: &mut Cursor<'_>, tokens: &[Token]) {
    for token in tokens {
        let span = Span::new(cursor.file(), token.start, token.end);
        match token.kind {
            TokenKind::Unterminated => {
                // The place where it begins is the place to look at, not all that it swallowed.
                let span = Span { end: (token.start + 1).min(token.end), ..span };
                cursor.report(Diagnostic::error(Code::Unterminated, span, "comment, pragma or string without an end"));
            }
            TokenKind::Pragma => report_c_code(cursor, span),
            TokenKind::LineComment => cursor.require(Feature::LineComments, span),
            TokenKind::BlockComment if cursor.text(span.start, span.end).starts_with('/') => {
                cursor.require(Feature::StarComments, span);
            }
            TokenKind::Wire if !cursor.is_generated(token.start) => {
                let message = "a name does not stand between backquotes";
                cursor.report(Diagnostic::error(Code::UnknownCharacter, span, message));
            }
            TokenKind::Unknown => {
                let text = cursor.text(token.start, token.end).escape_debug().to_string();
                let message = format!("`{text}` begins no token");
                let help = slip::meant_by(&text);
                let found = Diagnostic::error(Code::UnknownCharacter, span, message);
                cursor.report(found.with_optional_help(help));
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests;
