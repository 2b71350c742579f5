//! Lines and comments: what the author wrote around declarations.

use onescan_iec::dialect::Dialect;
use onescan_iec::syntax::SourceFile;
use onescan_iec::syntax::lexer::tokenize_in;
use onescan_iec::syntax::token::{Token, TokenKind};

/// The tokens of a file's part, with their places in the file.
pub(super) fn tokens(file: &SourceFile, start: u32, end: u32) -> Vec<Token> {
    let mut tokens = tokenize_in(file.dialect(), part(file, start, end));
    for token in &mut tokens {
        token.start += start;
        token.end += start;
    }
    tokens
}

/// A part of a file's text.
pub(super) fn part(file: &SourceFile, start: u32, end: u32) -> &str {
    file.text().get(start as usize..end as usize).unwrap_or("")
}

/// The comments of a part of a file, a line each.
pub(super) fn comments(file: &SourceFile, start: u32, end: u32) -> String {
    let mut text = String::new();
    for token in tokens(file, start, end) {
        if let Some(comment) = comment(part(file, token.start, token.end), token.kind) {
            text.push_str(&comment);
            text.push('\n');
        }
    }
    text
}

/// The comment that stands behind something in its line, with a blank before it.
pub(super) fn comment_behind(file: &SourceFile, end: u32) -> String {
    let rest = file.text().get(end as usize..).and_then(|rest| rest.lines().next()).unwrap_or("");
    let tokens = tokenize_in(file.dialect(), rest);
    let first = tokens.iter().find(|token| token.kind != TokenKind::Whitespace);
    let text = first.and_then(|token| comment(rest.get(token.start as usize..token.end as usize)?, token.kind));
    text.map_or(String::new(), |text| format!("   {text}"))
}

/// A comment as SCL has it: `/* .. */` is none there.
pub(super) fn comment(written: &str, kind: TokenKind) -> Option<String> {
    match kind {
        TokenKind::LineComment => Some(written.trim_end().to_owned()),
        TokenKind::BlockComment => {
            let inner = written.strip_prefix("/*").and_then(|rest| rest.strip_suffix("*/"));
            Some(match inner {
                Some(inner) => format!("(*{}*)", inner.replace("*)", "* )")),
                None => written.to_owned(),
            })
        }
        _ => None,
    }
}

/// Program text with the comments that SCL has, and without pragmas.
pub(super) fn with_comments(text: &str, dialect: Dialect) -> String {
    let mut new = String::with_capacity(text.len());
    for token in tokenize_in(dialect, text) {
        let written = text.get(token.start as usize..token.end as usize).unwrap_or("");
        match token.kind {
            TokenKind::Pragma => {}
            kind => new.push_str(comment(written, kind).as_deref().unwrap_or(written)),
        }
    }
    new
}

/// The lines without what all of them are indented by, `width` blanks before each, no blanks behind.
pub(super) fn indented(text: &str, width: usize) -> String {
    let is_blank = |line: &&str| line.trim().is_empty();
    let blanks = |line: &str| line.len() - line.trim_start().len();
    // The first line begins in the middle of one.
    let (first, rest) = text.split_once('\n').unwrap_or((text, ""));
    let common = rest.lines().filter(|line| !is_blank(line)).map(blanks).min().unwrap_or(0);
    let mut lines = vec![first.trim()];
    lines.extend(rest.lines().map(|line| line.get(common.min(blanks(line))..).unwrap_or("").trim_end()));
    let from = lines.iter().position(|line| !is_blank(line)).unwrap_or(lines.len());
    let to = lines.iter().rposition(|line| !is_blank(line)).map_or(from, |at| at + 1);
    let mut indented = String::new();
    for line in lines.get(from..to).unwrap_or_default() {
        if !line.is_empty() {
            indented.push_str(&" ".repeat(width));
            indented.push_str(line);
        }
        indented.push('\n');
    }
    indented
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_indented_alike() {
        assert_eq!(indented("\n        a\n            b\n\n        c  \n  \n", 3), "   a\n       b\n\n   c\n");
        assert_eq!(indented(" x : Int; ", 6), "      x : Int;\n");
        assert_eq!(indented(" \n ", 6), "");
    }

    #[test]
    fn comments_are_those_of_scl() {
        let file = SourceFile::new("a.st", "(* a *) x /* b */ // c  \n y");
        assert_eq!(comments(&file, 0, 27), "(* a *)\n(* b *)\n// c\n");
    }
}
