//! Tokens that only SCL sources of Siemens have.

use super::Lexer;
use crate::syntax::token::{Keyword, TokenKind};

/// Lines between a block's name and its first section, to their end free text.
const HEADING_LINES: [&str; 5] = ["TITLE", "AUTHOR", "FAMILY", "NAME", "VERSION"];

impl Lexer<'_> {
    /// A token that other dialects read in another way.
    pub(super) fn scl_token(&mut self, rest: &str, first: char) -> Option<TokenKind> {
        match first {
            '"' => Some(self.string('"', TokenKind::Identifier)),
            '#' => self.local_name(rest),
            '(' if rest.starts_with("(/*") => Some(self.block_comment("(/*", "*/)")),
            _ if first.is_ascii_alphabetic() => self.scl_word(rest),
            _ => None,
        }
    }

    /// `#name` or `#"any name"`
    fn local_name(&mut self, rest: &str) -> Option<TokenKind> {
        let second = rest.chars().nth(1)?;
        if second == '"' {
            self.at += 1;
            return Some(self.string('"', TokenKind::Identifier));
        }
        if !second.is_alphabetic() && second != '_' {
            return None;
        }
        self.at += 1;
        self.take_while(|character| character.is_alphanumeric() || character == '_');
        Some(TokenKind::Identifier)
    }

    fn scl_word(&mut self, rest: &str) -> Option<TokenKind> {
        let end = rest.find(|character: char| !character.is_ascii_alphanumeric() && character != '_');
        let word = rest.get(..end.unwrap_or(rest.len()))?;
        let is = |name: &&str| name.eq_ignore_ascii_case(word);
        // What is to be read has no meaning for the program: the name of a region, a heading.
        if is(&"REGION") && self.begins_line() || self.in_heading && HEADING_LINES.iter().any(is) {
            // More may follow a version.
            let version = is(&"VERSION");
            self.at += word.len();
            self.take_while(|one| if version { " \t:0123456789.'\"".contains(one) } else { one != '\n' });
            return Some(TokenKind::Pragma);
        }
        if is(&"END_REGION") {
            self.at += word.len();
            return Some(TokenKind::Pragma);
        }
        if is(&"P") && rest.as_bytes().get(1) == Some(&b'#') {
            self.at += 2;
            self.take_while(|character| character.is_ascii_alphanumeric() || matches!(character, '_' | '.'));
            return Some(TokenKind::Typed);
        }
        if is(&"CONST") {
            self.in_heading = false;
        }
        match Keyword::find(word)? {
            Keyword::Function | Keyword::FunctionBlock | Keyword::OrganizationBlock | Keyword::DataBlock => {
                self.in_heading = true;
            }
            Keyword::Type => self.in_heading = true,
            Keyword::Struct | Keyword::Begin => self.in_heading = false,
            keyword if keyword.text().starts_with("VAR") || keyword.text().starts_with("END_") => {
                self.in_heading = false;
            }
            _ => {}
        }
        None
    }

    /// True if nothing but blanks stands before in the line.
    fn begins_line(&self) -> bool {
        let before = self.text.get(..self.at).unwrap_or("");
        let line = before.rsplit('\n').next().unwrap_or("");
        line.chars().all(char::is_whitespace)
    }
}
