//! Program text and the comments in it: which of them belong to a declaration.

use std::ops::Range;

use onescan_iec::syntax::SourceFile;
use onescan_iec::syntax::lexer::tokenize_in;
use onescan_iec::syntax::token::{Token, TokenKind};

/// What holds formatted text: the schema leaves the element open.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Wrapper {
    /// A paragraph, as Beremiz and OpenPLC write it.
    Paragraph,
    /// An element of a name of its own, as CODESYS writes it.
    Codesys,
}

/// The text of a file.
pub(crate) struct Page<'t> {
    pub(crate) text: &'t str,
    pub(crate) tokens: Vec<Token>,
    /// How text of it is wrapped in XML.
    pub(crate) wrapper: Wrapper,
}

impl<'t> Page<'t> {
    pub(crate) fn of(file: &'t SourceFile) -> Self {
        let tokens = tokenize_in(file.dialect(), file.text());
        Self { text: file.text(), tokens, wrapper: Wrapper::Codesys }
    }

    /// Text whose comments do not matter, for a project of any tool's.
    pub(crate) fn bare(text: &'t str) -> Self {
        Self { text, tokens: Vec::new(), wrapper: Wrapper::Paragraph }
    }

    /// What is written there.
    pub(crate) fn slice(&self, at: Range<u32>) -> &'t str {
        self.text.get(at.start as usize..at.end as usize).unwrap_or("")
    }

    /// Where the line ends in which `at` is.
    pub(crate) fn line_end(&self, at: u32) -> u32 {
        let rest = self.text.get(at as usize..).unwrap_or("");
        at + rest.find('\n').unwrap_or(rest.len()) as u32
    }

    /// The words of all comments in a range, each comment from a line of its own; empty without any.
    pub(crate) fn remarks(&self, within: Range<u32>) -> String {
        let is_comment = |token: &&Token| matches!(token.kind, TokenKind::BlockComment | TokenKind::LineComment);
        let comments = self.within(within).filter(is_comment);
        let words: Vec<String> = comments.map(|token| words(self.slice(token.start..token.end))).collect();
        words.join("\n").trim().to_owned()
    }

    /// All pragmas in a range.
    pub(crate) fn pragmas(&self, within: Range<u32>) -> Vec<&'t str> {
        let pragmas = self.within(within).filter(|token| token.kind == TokenKind::Pragma);
        pragmas.map(|token| self.slice(token.start..token.end)).collect()
    }

    fn within(&self, range: Range<u32>) -> impl Iterator<Item = &Token> {
        let first = self.tokens.partition_point(|token| token.start < range.start);
        let tokens = self.tokens.get(first..).unwrap_or(&[]).iter();
        tokens.take_while(move |token| token.start < range.end)
    }

    /// The first of the words `text` at or behind `from`.
    pub(crate) fn word_behind(&self, text: &str, from: u32) -> Option<&Token> {
        let first = self.tokens.partition_point(|token| token.start < from);
        self.tokens.get(first..)?.iter().find(|token| self.is(token, text))
    }

    /// The last of the words `text` in front of `to`.
    pub(crate) fn word_before(&self, text: &str, to: u32) -> Option<&Token> {
        let end = self.tokens.partition_point(|token| token.start < to);
        self.tokens.get(..end)?.iter().rfind(|token| self.is(token, text))
    }

    fn is(&self, token: &Token, text: &str) -> bool {
        let is_word = matches!(token.kind, TokenKind::Keyword(_) | TokenKind::Identifier);
        is_word && self.slice(token.start..token.end).eq_ignore_ascii_case(text)
    }
}

/// What a comment says.
fn words(comment: &str) -> String {
    let inner = comment.strip_prefix("(*").and_then(|rest| rest.strip_suffix("*)"));
    let inner = inner.or_else(|| comment.strip_prefix("/*").and_then(|rest| rest.strip_suffix("*/")));
    let inner = inner.or_else(|| comment.strip_prefix("//")).unwrap_or(comment);
    let lines: Vec<&str> = inner.lines().map(str::trim).collect();
    lines.join("\n").trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_say_what_is_between_their_marks() {
        let file = SourceFile::new("a.st", "x (* one\n   two *) y // three\nz /* four */");
        let page = Page::of(&file);
        assert_eq!(page.remarks(0..page.text.len() as u32), "one\ntwo\nthree\nfour");
        assert_eq!((page.remarks(0..2), page.line_end(0)), (String::new(), 8));
    }
}
