//! Text to tokens. Every byte of the text belongs to exactly one token.

mod scl;

use super::calendar::calendar_prefix;
use super::token::{Keyword, Punctuation, Token, TokenKind};
use crate::dialect::{Dialect, Feature};

/// How a line of debugging code begins.
const DEBUG_LINE: &str = "(*DBG:";

/// Splits `text`, in the default dialect, into tokens; their texts concatenated are `text`.
pub fn tokenize(text: &str) -> Vec<Token> {
    tokenize_in(Dialect::default(), text)
}

/// Splits `text` into tokens of `dialect`; their texts concatenated are `text`.
pub fn tokenize_in(dialect: Dialect, text: &str) -> Vec<Token> {
    let mut lexer = Lexer { text, at: 0, dialect, in_heading: false };
    let mut tokens = Vec::with_capacity(text.len() / 4);
    while lexer.at < text.len() {
        let start = lexer.at;
        let kind = lexer.token();
        debug_assert!(lexer.at > start, "a token is never empty");
        tokens.push(Token { kind, start: start as u32, end: lexer.at as u32 });
    }
    tokens
}

struct Lexer<'a> {
    text: &'a str,
    at: usize,
    dialect: Dialect,
    /// Between an SCL block's name and its first section.
    in_heading: bool,
}

impl<'a> Lexer<'a> {
    fn rest(&self) -> &'a str {
        self.text.get(self.at..).unwrap_or("")
    }

    fn peek(&self, ahead: usize) -> u8 {
        self.text.as_bytes().get(self.at + ahead).copied().unwrap_or(0)
    }

    fn take_while(&mut self, accept: impl Fn(char) -> bool) {
        let rest = self.rest();
        self.at += rest.find(|character| !accept(character)).unwrap_or(rest.len());
    }

    fn token(&mut self) -> TokenKind {
        let rest = self.rest();
        let Some(first) = rest.chars().next() else {
            return TokenKind::Unknown;
        };
        if self.dialect == Dialect::SiemensScl
            && let Some(found) = self.scl_token(rest, first)
        {
            return found;
        }
        match first {
            _ if first.is_whitespace() || first == '\u{feff}' => {
                self.take_while(|character| character.is_whitespace() || character == '\u{feff}');
                TokenKind::Whitespace
            }
            '(' if rest.starts_with(DEBUG_LINE) && self.is_debug_line() => {
                self.take_while(|character| character != '\n');
                TokenKind::BlockComment
            }
            '(' if rest.starts_with("(*") => self.block_comment("(*", "*)"),
            '/' if rest.starts_with("/*") => self.block_comment("/*", "*/"),
            '/' if rest.starts_with("//") => {
                self.take_while(|character| character != '\n');
                TokenKind::LineComment
            }
            '{' => self.pragma(),
            '\'' => self.string('\'', TokenKind::String),
            '"' => self.string('"', TokenKind::WideString),
            '%' => self.direct_address(),
            '`' => self.wire(),
            '0'..='9' => self.number(),
            _ if self.begins_name(first) => self.word(),
            _ => self.mark(first),
        }
    }

    fn begins_name(&self, first: char) -> bool {
        is_part_of_name(self.dialect, first) && !first.is_numeric()
    }

    /// A line of the C code that OpenPLC Editor puts behind a program, with comments and parentheses of its own: its tools
    /// take such lines out, whatever stands in them.
    fn is_debug_line(&self) -> bool {
        let is_first = self.text.get(..self.at).is_some_and(|before| before.is_empty() || before.ends_with('\n'));
        is_first && self.rest().lines().next().is_some_and(|line| line.trim_end().ends_with("*)"))
    }

    /// Comments nest in the 3rd edition (6.1.5), in the 2nd they do not (2.1.5).
    fn block_comment(&mut self, open: &str, close: &str) -> TokenKind {
        let nests = self.dialect.has(Feature::NestedComments);
        let mut depth = 0_usize;
        while self.at < self.text.len() {
            let rest = self.rest();
            if rest.starts_with(open) && (nests || depth == 0) {
                depth += 1;
                self.at += open.len();
            } else if rest.starts_with(close) {
                depth -= 1;
                self.at += close.len();
                if depth == 0 {
                    return TokenKind::BlockComment;
                }
            } else {
                self.at += rest.chars().next().map_or(1, char::len_utf8);
            }
        }
        TokenKind::Unterminated
    }

    fn pragma(&mut self) -> TokenKind {
        // C code of MatIEC, in which braces stand.
        if let Some(end) = self.rest().strip_prefix("{{").and_then(|inside| inside.find("}}")) {
            self.at += "{{".len() + end + "}}".len();
            return TokenKind::Pragma;
        }
        self.take_while(|character| character != '}');
        if self.at == self.text.len() {
            return TokenKind::Unterminated;
        }
        self.at += 1;
        TokenKind::Pragma
    }

    /// `$` escapes the quote (2nd ed. Table 6). A string does not span lines, so that a missing
    /// quote costs one line, not the file.
    fn string(&mut self, quote: char, kind: TokenKind) -> TokenKind {
        self.at += 1;
        while let Some(character) = self.rest().chars().next() {
            if character == '\n' {
                return TokenKind::Unterminated;
            }
            self.at += character.len_utf8();
            if character == quote {
                return kind;
            }
            if character == '$' {
                let escaped = self.rest().chars().next().filter(|next| *next != '\n');
                self.at += escaped.map_or(0, char::len_utf8);
            }
        }
        TokenKind::Unterminated
    }

    fn wire(&mut self) -> TokenKind {
        let is_part = |one: char| one.is_ascii_alphanumeric() || matches!(one, '_' | '.');
        let inside = self.rest().get(1..).unwrap_or("");
        let length = inside.find(|one| !is_part(one)).unwrap_or(inside.len());
        if length > 0 && inside.as_bytes().get(length) == Some(&b'`') {
            self.at += length + 2;
            return TokenKind::Wire;
        }
        self.take_while(|character| character == '`');
        TokenKind::Unknown
    }

    fn direct_address(&mut self) -> TokenKind {
        self.at += 1;
        self.take_while(|character| character.is_ascii_alphanumeric() || character == '*');
        while self.peek(0) == b'.' && self.peek(1).is_ascii_digit() {
            self.at += 1;
            self.take_while(|character| character.is_ascii_digit());
        }
        TokenKind::DirectAddress
    }

    fn digits(&mut self) {
        self.take_while(|character| character.is_ascii_digit() || character == '_');
    }

    /// `12`, `16#FF`, `1.5`, `1.5e-3`; `1..5` is an integer and a range.
    fn number(&mut self) -> TokenKind {
        self.digits();
        if self.peek(0) == b'#' && self.peek(1).is_ascii_alphanumeric() {
            self.at += 1;
            self.take_while(|character| character.is_ascii_alphanumeric() || character == '_');
            return TokenKind::Integer;
        }
        let mut kind = TokenKind::Integer;
        if self.peek(0) == b'.' && self.peek(1).is_ascii_digit() {
            self.at += 1;
            self.digits();
            kind = TokenKind::Real;
        }
        if self.exponent() {
            kind = TokenKind::Real;
        }
        kind
    }

    fn exponent(&mut self) -> bool {
        if !matches!(self.peek(0), b'e' | b'E') {
            return false;
        }
        let sign = usize::from(matches!(self.peek(1), b'+' | b'-'));
        let found = self.peek(1 + sign).is_ascii_digit();
        if found {
            self.at += 1 + sign;
            self.digits();
        }
        found
    }

    fn word(&mut self) -> TokenKind {
        let start = self.at;
        let dialect = self.dialect;
        self.take_while(|character| is_part_of_name(dialect, character));
        let text = self.text.get(start..self.at).unwrap_or("");
        if self.peek(0) == b'#' && matches!(self.peek(1), b'\'' | b'"') {
            self.at += 1;
            return self.string(char::from(self.peek(0)), TokenKind::Typed);
        }
        if let Some(blanks) = self.blanks_before_value() {
            self.at += 1 + blanks;
            self.typed_value();
            return TokenKind::Typed;
        }
        let after_sign = usize::from(matches!(self.peek(1), b'+' | b'-'));
        if self.peek(0) == b'#'
            && (self.peek(1 + after_sign).is_ascii_alphanumeric() || self.peek(1 + after_sign) == b'_')
        {
            self.at += 1 + after_sign;
            if self.peek(0).is_ascii_digit() && calendar_prefix(text).is_some() {
                self.calendar_value();
            } else {
                self.typed_value();
            }
            return TokenKind::Typed;
        }
        let keyword = Keyword::find(text)
            .filter(|keyword| keyword.is_in(self.dialect) && !keyword.is_soft() && !keyword.is_of_chart());
        keyword.map_or(TokenKind::Identifier, TokenKind::Keyword)
    }

    /// How many blanks stand between `#` and a name, where they may.
    fn blanks_before_value(&self) -> Option<usize> {
        let rest = self.rest().strip_prefix('#').filter(|_| self.dialect.has(Feature::SpacedValues))?;
        let name = rest.trim_start_matches([' ', '\t']);
        let blanks = rest.len() - name.len();
        (blanks > 0 && name.starts_with(|first: char| first.is_ascii_alphabetic() || first == '_')).then_some(blanks)
    }

    /// What follows `INT#`: digits with a base, a fraction, an exponent, a duration or a name.
    fn typed_value(&mut self) {
        if self.peek(0).is_ascii_digit() {
            self.number();
        }
        let word = |character: char| character.is_ascii_alphanumeric() || character == '_';
        self.take_while(word);
        while self.peek(0) == b'.' && self.peek(1).is_ascii_digit() {
            self.at += 1;
            self.take_while(word);
        }
    }

    /// What follows `DT#`: digits with `-`, `:` and `.` between them.
    fn calendar_value(&mut self) {
        loop {
            self.digits();
            if !matches!(self.peek(0), b'-' | b':' | b'.') || !self.peek(1).is_ascii_digit() {
                return;
            }
            self.at += 1;
        }
    }

    fn mark(&mut self, first: char) -> TokenKind {
        if let Some(found) = Punctuation::find(self.rest()) {
            self.at += found.text().len();
            return TokenKind::Punctuation(found);
        }
        self.foreign(first);
        TokenKind::Unknown
    }

    /// Passes what begins no token, as far as it is one thing: `||`, `$FF`, a text between typographic quotes.
    fn foreign(&mut self, first: char) {
        let line = self.rest().lines().next().unwrap_or("");
        let mut quotes = line.match_indices(is_typographic_quote).map(|(at, quote)| at + quote.len());
        if let Some(end) = quotes.nth(1).filter(|_| is_typographic_quote(first)) {
            self.at += end;
        } else if first == '$' && self.peek(1).is_ascii_hexdigit() {
            self.at += 1;
            self.take_while(|character| character.is_ascii_alphanumeric());
        } else {
            self.take_while(|character| character == first);
        }
    }
}

/// Quotes that word processors put in the place of `'` and `"`.
pub(super) fn is_typographic_quote(character: char) -> bool {
    matches!(character, '\u{2018}'..='\u{201f}')
}

/// Letters of every language in SCL, those of ASCII elsewhere (2nd ed. 2.1.1; TIA Portal: rules for names).
fn is_part_of_name(dialect: Dialect, character: char) -> bool {
    let beyond = dialect == Dialect::SiemensScl && character.is_alphanumeric();
    character.is_ascii_alphanumeric() || character == '_' || beyond
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn kinds(text: &str) -> Vec<(TokenKind, &str)> {
        let all = tokenize(text).into_iter();
        all.filter(|token| !token.kind.is_trivia())
            .map(|token| (token.kind, &text[token.start as usize..token.end as usize]))
            .collect()
    }

    #[test]
    fn numbers_end_where_the_standard_ends_them() {
        use TokenKind::{Integer, Punctuation as P, Real, Typed};
        assert_eq!(
            kinds("1..5 1.5e-3 16#FF_FF 1_000 2e3"),
            [
                (Integer, "1"),
                (P(Punctuation::Range), ".."),
                (Integer, "5"),
                (Real, "1.5e-3"),
                (Integer, "16#FF_FF"),
                (Integer, "1_000"),
                (Real, "2e3"),
            ]
        );
        assert_eq!(
            kinds("INT#1..INT#-5 t#1d2h_3m4.5s WORD#16#FF REAL#1.0E+3 Colour#Red"),
            [
                (Typed, "INT#1"),
                (P(Punctuation::Range), ".."),
                (Typed, "INT#-5"),
                (Typed, "t#1d2h_3m4.5s"),
                (Typed, "WORD#16#FF"),
                (Typed, "REAL#1.0E+3"),
                (Typed, "Colour#Red"),
            ]
        );
    }

    #[test]
    fn a_line_of_debugging_code_is_a_comment_whatever_stands_in_it() {
        let text = "x\n(*DBG:    return (void *)((((__IEC_BOOL_p *) p)->flags |= 1;*)\r\ny (*DBG: a *) z";
        let plain = kinds_without_blanks(text);
        let expected = [TokenKind::Identifier, TokenKind::BlockComment, TokenKind::Identifier];
        assert_eq!(plain[..3], expected);
        assert_eq!(plain[3..], [TokenKind::BlockComment, TokenKind::Identifier]);
    }

    fn kinds_without_blanks(text: &str) -> Vec<TokenKind> {
        tokenize(text).into_iter().map(|token| token.kind).filter(|kind| *kind != TokenKind::Whitespace).collect()
    }

    #[test]
    fn comments_nest_and_strings_escape() {
        assert_eq!(kinds("(* a (* b *) c *) // d\n /* e */ {f}"), []);
        assert_eq!(kinds("(* a (* b *)")[0].0, TokenKind::Unterminated);
        assert_eq!(kinds("'it$'s' x")[0], (TokenKind::String, "'it$'s'"));
        assert_eq!(kinds("'open\nx")[0], (TokenKind::Unterminated, "'open"));
        assert_eq!(kinds("dt#1984-06-25-15:36:55.360..1")[0], (TokenKind::Typed, "dt#1984-06-25-15:36:55.360"));
        assert_eq!(kinds("STRING#'a''b'")[0], (TokenKind::Typed, "STRING#'a'"));
        assert_eq!(kinds("%IX1.0.2;")[0], (TokenKind::DirectAddress, "%IX1.0.2"));
    }

    #[test]
    fn pragmas_and_comments_are_tokens_of_every_dialect() {
        use TokenKind::{BlockComment, LineComment, Pragma};
        let text = "{attribute 'x'} (* a *) // b\n{IF defined (y)} /* c */ {END_IF}";
        for dialect in Dialect::ALL {
            let trivia = tokenize_in(dialect, text).into_iter().map(|token| token.kind);
            let trivia: Vec<_> = trivia.filter(|kind| *kind != TokenKind::Whitespace).collect();
            assert_eq!(trivia, [Pragma, BlockComment, LineComment, Pragma, BlockComment, Pragma], "{dialect}");
        }
        let scl =
            "FUNCTION_BLOCK \"a b\"\nTITLE = it's\nVERSION : 0.1\nVAR\n#x \"y z\" (/* c */)\n  REGION it's\nEND_REGION";
        let tokens = tokenize_in(Dialect::SiemensScl, scl).into_iter();
        let seen: Vec<_> = tokens
            .filter(|token| token.kind != TokenKind::Whitespace)
            .map(|token| &scl[token.start as usize..token.end as usize])
            .collect();
        let expected = [
            "FUNCTION_BLOCK",
            "\"a b\"",
            "TITLE = it's",
            "VERSION : 0.1",
            "VAR",
            "#x",
            "\"y z\"",
            "(/* c */)",
            "REGION it's",
            "END_REGION",
        ];
        assert_eq!(seen, expected);
    }

    #[test]
    fn keywords_are_found_in_any_case() {
        assert_eq!(kinds("End_If")[0].0, TokenKind::Keyword(Keyword::EndIf));
        assert_eq!(kinds("END_IFX")[0].0, TokenKind::Identifier);
    }

    proptest! {
        #[test]
        fn no_byte_is_lost(text in "\\PC{0,200}|[ -~\\n]{0,200}|[(*)/{}'\"$#%.:=0-9a-fT_ \\n]{0,200}") {
            for dialect in Dialect::ALL {
                let joined: String = tokenize_in(dialect, &text)
                    .iter()
                    .map(|token| &text[token.start as usize..token.end as usize])
                    .collect();
                prop_assert_eq!(&joined, &text);
            }
        }
    }
}
