//! Rust text to the few tokens that paths and modules are made of, with their lines.

/// A token; all that no path needs is a mark.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Token {
    Word(String),
    /// `::`
    Path,
    Mark(char),
}

impl Token {
    pub fn is_word(&self, word: &str) -> bool {
        matches!(self, Self::Word(own) if own == word)
    }

    pub fn is_mark(&self, mark: char) -> bool {
        *self == Self::Mark(mark)
    }
}

/// The tokens of a text, without comments and literals.
pub fn tokens(text: &str) -> Vec<(Token, usize)> {
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
    found: Vec<(Token, usize)>,
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

    fn add(&mut self, token: Token) {
        self.found.push((token, self.line));
    }

    fn token(&mut self) {
        match (self.peek(0), self.peek(1)) {
            (Some('/'), Some('/')) => {
                while self.peek(0).is_some_and(|next| next != '\n') {
                    self.skip(1);
                }
            }
            (Some('/'), Some('*')) => self.block_comment(),
            (Some('"'), _) => self.string(),
            (Some('r'), Some('"' | '#')) if self.raw_hashes().is_some() => self.raw_string(),
            (Some('\''), _) => self.quote(),
            (Some(':'), Some(':')) => {
                self.add(Token::Path);
                self.skip(2);
            }
            (Some(first), _) if first.is_alphanumeric() || first == '_' => self.word(),
            (Some(other), _) => {
                if !other.is_whitespace() {
                    self.add(Token::Mark(other));
                }
                self.skip(1);
            }
            (None, _) => {}
        }
    }

    /// Block comments stand inside of one another.
    fn block_comment(&mut self) {
        let mut depth = 0;
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
                return;
            }
        }
    }

    fn string(&mut self) {
        self.skip(1);
        while let Some(next) = self.peek(0) {
            self.skip(if next == '\\' { 2 } else { 1 });
            if next == '"' {
                return;
            }
        }
    }

    /// The number of `#` of a raw string that begins here.
    fn raw_hashes(&self) -> Option<usize> {
        let hashes = (1..=self.chars.len()).take_while(|ahead| self.peek(*ahead) == Some('#')).count();
        (self.peek(1 + hashes) == Some('"')).then_some(hashes)
    }

    fn raw_string(&mut self) {
        let hashes = self.raw_hashes().unwrap_or(0);
        self.skip(2 + hashes);
        while let Some(next) = self.peek(0) {
            let ends = next == '"' && (1..=hashes).all(|ahead| self.peek(ahead) == Some('#'));
            self.skip(if ends { 1 + hashes } else { 1 });
            if ends {
                return;
            }
        }
    }

    /// A character, or a lifetime, of which only the quote is skipped.
    fn quote(&mut self) {
        match (self.peek(1), self.peek(2)) {
            (Some('\\'), _) => {
                self.skip(3);
                while self.peek(0).is_some_and(|next| next != '\'') {
                    self.skip(1);
                }
                self.skip(1);
            }
            (Some(_), Some('\'')) => self.skip(3),
            // The name of a lifetime is a word that leads nowhere: it must not be taken for one of a path.
            _ => {
                self.skip(1);
                while self.peek(0).is_some_and(|next| next.is_alphanumeric() || next == '_') {
                    self.skip(1);
                }
            }
        }
    }

    fn word(&mut self) {
        let mut text = String::new();
        let line = self.line;
        while let Some(next) = self.peek(0).filter(|next| next.is_alphanumeric() || *next == '_') {
            text.push(next);
            self.skip(1);
        }
        self.found.push((Token::Word(text), line));
    }
}

#[test]
fn comments_and_literals_are_not_tokens() {
    let text = "a::b /* x /* y */ z */ \"crate::c\" r#\"crate::\"d\"# 'e' '\\'' &'f g // h\ni";
    let words: Vec<_> = tokens(text).into_iter().filter(|(token, _)| matches!(token, Token::Word(_))).collect();
    let word = |text: &str, line| (Token::Word(text.to_owned()), line);
    assert_eq!(words, [word("a", 1), word("b", 1), word("g", 1), word("i", 2)]);
}
