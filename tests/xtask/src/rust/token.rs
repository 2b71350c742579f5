//! Rust text as tokens, with comments and literals kept: they are measured, too.

/// A token and the line that it begins on, counted from 1.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Token {
    pub(crate) kind: Kind,
    pub(crate) line: usize,
    /// The line that it ends on.
    pub(crate) end: usize,
}

/// What a token is. Texts are without their marks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Kind {
    Word(String),
    /// A string, also a raw one or one of bytes.
    Text(String),
    /// `//` or `/* */`
    Comment(String),
    /// `///`, `//!`, `/** */` or `/*! */`
    Doc(String),
    /// A number, a character or a lifetime.
    Other,
    Mark(char),
}

impl Token {
    pub(crate) fn is_word(&self, word: &str) -> bool {
        matches!(&self.kind, Kind::Word(own) if own == word)
    }

    pub(crate) fn is_mark(&self, mark: char) -> bool {
        self.kind == Kind::Mark(mark)
    }

    pub(crate) fn is_comment(&self) -> bool {
        matches!(self.kind, Kind::Comment(_) | Kind::Doc(_))
    }
}

/// All tokens of a text, in order. Text that is not Rust gives some tokens, never a failure.
pub(crate) fn tokens(text: &str) -> Vec<Token> {
    let mut scanner = Scanner { chars: text.chars().collect(), at: 0, line: 1, found: Vec::new() };
    while scanner.at < scanner.chars.len() {
        scanner.token();
    }
    scanner.found
}

struct Scanner {
    chars: Vec<char>,
    at: usize,
    line: usize,
    found: Vec<Token>,
}

impl Scanner {
    fn peek(&self, ahead: usize) -> Option<char> {
        self.chars.get(self.at + ahead).copied()
    }

    fn skip(&mut self, count: usize) {
        for _ in 0..count {
            self.line += usize::from(self.peek(0) == Some('\n'));
            self.at += 1;
        }
    }

    fn taken(&self, from: usize, until: usize) -> String {
        self.chars.get(from..until).map(|chars| chars.iter().collect()).unwrap_or_default()
    }

    fn token(&mut self) {
        let line = self.line;
        let kind = match (self.peek(0), self.peek(1)) {
            (Some('/'), Some('/')) => Some(self.line_comment()),
            (Some('/'), Some('*')) => Some(self.block_comment()),
            (Some('"'), _) => Some(self.string()),
            (Some('r'), Some('"' | '#')) if self.raw_hashes(1).is_some() => Some(self.raw_string(1)),
            (Some('b' | 'c'), Some('"')) => {
                self.skip(1);
                Some(self.string())
            }
            (Some('b' | 'c'), Some('r')) if self.raw_hashes(2).is_some() => Some(self.raw_string(2)),
            (Some('b'), Some('\'')) => {
                self.skip(1);
                Some(self.quote())
            }
            (Some('\''), _) => Some(self.quote()),
            (Some(first), _) if first.is_alphanumeric() || first == '_' => Some(self.word()),
            (Some(other), _) => {
                self.skip(1);
                (!other.is_whitespace()).then_some(Kind::Mark(other))
            }
            (None, _) => None,
        };
        if let Some(kind) = kind {
            self.found.push(Token { kind, line, end: self.line });
        }
    }

    fn line_comment(&mut self) -> Kind {
        let from = self.at;
        while self.peek(0).is_some_and(|next| next != '\n') {
            self.skip(1);
        }
        let text = self.taken(from, self.at);
        // Four slashes are a plain comment again.
        let doc = text.starts_with("//!") || text.starts_with("///") && !text.starts_with("////");
        let inner = text.trim_start_matches(['/', '!']).trim().to_owned();
        if doc { Kind::Doc(inner) } else { Kind::Comment(inner) }
    }

    /// Block comments nest.
    fn block_comment(&mut self) -> Kind {
        let (from, mut depth) = (self.at, 0_usize);
        while let Some(first) = self.peek(0) {
            match (first, self.peek(1)) {
                ('/', Some('*')) => {
                    depth += 1;
                    self.skip(2);
                }
                ('*', Some('/')) => {
                    depth -= 1;
                    self.skip(2);
                }
                _ => self.skip(1),
            }
            if depth == 0 {
                break;
            }
        }
        let text = self.taken(from, self.at);
        let doc = text.len() > "/**/".len() && (text.starts_with("/**") || text.starts_with("/*!"));
        let inner = text.trim_start_matches(['/', '*', '!']);
        let inner = inner.strip_suffix("*/").unwrap_or(inner).trim().to_owned();
        if doc { Kind::Doc(inner) } else { Kind::Comment(inner) }
    }

    fn string(&mut self) -> Kind {
        let from = self.at + 1;
        self.skip(1);
        while let Some(next) = self.peek(0) {
            self.skip(if next == '\\' { 2 } else { 1 });
            if next == '"' {
                break;
            }
        }
        Kind::Text(self.taken(from, self.at.saturating_sub(1).max(from)))
    }

    /// The number of `#` of a raw string whose `r` ends before `ahead`.
    fn raw_hashes(&self, ahead: usize) -> Option<usize> {
        let hashes = (ahead..self.chars.len()).take_while(|ahead| self.peek(*ahead) == Some('#')).count();
        (self.peek(ahead + hashes) == Some('"')).then_some(hashes)
    }

    fn raw_string(&mut self, ahead: usize) -> Kind {
        let hashes = self.raw_hashes(ahead).unwrap_or(0);
        self.skip(ahead + hashes + 1);
        let from = self.at;
        while let Some(next) = self.peek(0) {
            if next == '"' && (1..=hashes).all(|ahead| self.peek(ahead) == Some('#')) {
                let text = self.taken(from, self.at);
                self.skip(1 + hashes);
                return Kind::Text(text);
            }
            self.skip(1);
        }
        Kind::Text(self.taken(from, self.at))
    }

    /// A character or a lifetime.
    fn quote(&mut self) -> Kind {
        match (self.peek(1), self.peek(2)) {
            (Some('\\'), _) => {
                self.skip(3);
                while self.peek(0).is_some_and(|next| next != '\'') {
                    self.skip(1);
                }
                self.skip(1);
            }
            (Some(_), Some('\'')) => self.skip(3),
            _ => {
                self.skip(1);
                while self.peek(0).is_some_and(|next| next.is_alphanumeric() || next == '_') {
                    self.skip(1);
                }
            }
        }
        Kind::Other
    }

    fn word(&mut self) -> Kind {
        let from = self.at;
        let number = self.peek(0).is_some_and(|first| first.is_ascii_digit());
        while self.peek(0).is_some_and(|next| next.is_alphanumeric() || next == '_') {
            self.skip(1);
        }
        if number { Kind::Other } else { Kind::Word(self.taken(from, self.at)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kinds(text: &str) -> Vec<Kind> {
        tokens(text).into_iter().map(|token| token.kind).collect()
    }

    #[test]
    fn comments_and_texts_are_kept_without_their_marks() {
        let text = "/// a\n//! b\n//// c\n/* d /* e */ */ \"f\\\"g\" r#\"h\"i\"# b\"j\" br\"k\"";
        let wanted = [
            Kind::Doc("a".to_owned()),
            Kind::Doc("b".to_owned()),
            Kind::Comment("c".to_owned()),
            Kind::Comment("d /* e */".to_owned()),
            Kind::Text("f\\\"g".to_owned()),
            Kind::Text("h\"i".to_owned()),
            Kind::Text("j".to_owned()),
            Kind::Text("k".to_owned()),
        ];
        assert_eq!(kinds(text), wanted);
    }

    #[test]
    fn characters_and_lifetimes_are_not_texts() {
        let wanted = [Kind::Other, Kind::Other, Kind::Other, Kind::Mark('&'), Kind::Other, Kind::Word("f".to_owned())];
        assert_eq!(kinds("'e' '\\'' b'\"' &'f f"), wanted);
        assert_eq!(kinds("1_000u8 x"), [Kind::Other, Kind::Word("x".to_owned())]);
    }

    #[test]
    fn a_token_knows_its_lines() {
        let found = tokens("a\n\"b\n\nc\" d");
        let lines: Vec<_> = found.iter().map(|token| (token.line, token.end)).collect();
        assert_eq!(lines, [(1, 1), (2, 4), (4, 4)]);
    }

    #[test]
    fn an_unfinished_literal_does_not_fail() {
        for text in ["\"a", "r#\"a", "/* a", "'", "b\"", "\"\\"] {
            tokens(text);
        }
    }
}
