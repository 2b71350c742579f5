//! A formula's text as words, numbers and signs.

use std::ops::Range;

use super::error::{FormulaError, FormulaErrorKind};

/// A piece of a formula with its place.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Token {
    pub(super) kind: TokenKind,
    pub(super) place: Range<usize>,
}

/// The pieces of a formula.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum TokenKind {
    /// A word of the language, in lower case.
    Keyword(Keyword),
    /// The name of a signal or a unit.
    Name(String),
    /// A name in backquotes, which is a signal's whatever it looks like.
    Quoted(String),
    Number(f64),
    /// A number with a unit of time right behind it, in nanoseconds.
    Duration(u64),
    Sign(&'static str),
    End,
}

macro_rules! keywords {
    ($($variant:ident = $text:literal),* $(,)?) => {
        /// The words of the language.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(super) enum Keyword { $($variant),* }

        impl Keyword {
            pub(super) const ALL: &[Self] = &[$(Self::$variant),*];

            pub(super) fn text(self) -> &'static str {
                match self { $(Self::$variant => $text),* }
            }
        }
    };
}

keywords! {
    True = "true", False = "false", Not = "not", And = "and", Or = "or", Implies = "implies", Iff = "iff",
    Always = "always", Eventually = "eventually", Until = "until", Within = "within", For = "for",
    Historically = "historically", Once = "once", Since = "since",
    Rose = "rose", Fell = "fell", Changed = "changed",
    Abs = "abs", Min = "min", Max = "max", Rate = "rate",
}

impl Keyword {
    /// Words are read without regard to case, as those of the PLC's languages are.
    fn find(text: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|keyword| keyword.text().eq_ignore_ascii_case(text))
    }
}

/// Longer signs first.
const SIGNS: [&str; 18] =
    ["<=", ">=", "<>", "!=", "==", "<", ">", "=", "+", "-", "*", "/", "(", ")", "[", "]", ",", ";"];

/// The text in pieces, the end among them.
pub(super) fn tokens(text: &str) -> Result<Vec<Token>, FormulaError> {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(first) = text[at..].chars().next() {
        if first.is_whitespace() {
            at += first.len_utf8();
            continue;
        }
        let (kind, length) = token(&text[at..], first, at)?;
        found.push(Token { kind, place: at..at + length });
        at += length;
    }
    found.push(Token { kind: TokenKind::End, place: text.len()..text.len() });
    Ok(found)
}

fn token(rest: &str, first: char, at: usize) -> Result<(TokenKind, usize), FormulaError> {
    if first.is_ascii_digit() {
        return number(rest, at);
    }
    if first == '`' {
        let end = rest[1..].find('`').ok_or_else(|| FormulaError::new(FormulaErrorKind::Quote, at..at + rest.len()))?;
        return Ok((TokenKind::Quoted(rest[1..=end].to_owned()), end + 2));
    }
    if is_letter(first) {
        return Ok(word(rest));
    }
    match SIGNS.iter().find(|sign| rest.starts_with(**sign)) {
        Some(sign) => Ok((TokenKind::Sign(sign), sign.len())),
        None => Err(FormulaError::new(FormulaErrorKind::Character(first), at..at + first.len_utf8())),
    }
}

/// Letters of names, and the signs that units are written with.
fn is_letter(c: char) -> bool {
    c.is_ascii_alphabetic() || matches!(c, '_' | '%' | '°' | 'µ')
}

/// A keyword, or a name with its points and indices: `axis[3].position`.
fn word(rest: &str) -> (TokenKind, usize) {
    let inside = |c: char| is_letter(c) || c.is_ascii_digit();
    let plain = rest.find(|c| !inside(c)).unwrap_or(rest.len());
    if let Some(keyword) = Keyword::find(&rest[..plain]) {
        return (TokenKind::Keyword(keyword), plain);
    }
    let mut length = plain;
    loop {
        let tail = &rest[length..];
        if let Some(member) = tail.strip_prefix('.').filter(|member| member.starts_with(inside)) {
            length += 1 + member.find(|c| !inside(c)).unwrap_or(member.len());
        } else if let Some(index) = index_length(tail) {
            length += index;
        } else {
            return (TokenKind::Name(rest[..length].to_owned()), length);
        }
    }
}

/// How long the index `[3]` or `[1,-2]` is that the text begins with.
fn index_length(tail: &str) -> Option<usize> {
    let inner = tail.strip_prefix('[')?;
    let end = inner.find(']')?;
    let digits = |c: char| c.is_ascii_digit() || matches!(c, ',' | '-');
    (end > 0 && inner[..end].chars().all(digits)).then_some(end + 2)
}

/// A number; a unit of time right behind it makes it a duration.
fn number(rest: &str, at: usize) -> Result<(TokenKind, usize), FormulaError> {
    let digits = |text: &str| text.find(|c: char| !c.is_ascii_digit() && c != '_').unwrap_or(text.len());
    let mut length = digits(rest);
    if rest[length..].starts_with('.') && rest[length + 1..].starts_with(|c: char| c.is_ascii_digit()) {
        length += 1 + digits(&rest[length + 1..]);
    }
    let unit: usize = rest[length..].find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(rest.len() - length);
    if unit > 0 && !is_exponent(&rest[length..]) {
        let text = &rest[..length + unit];
        let parsed: Result<onescan_server::time::VirtualTime, _> = text.parse();
        let wrong = |error| FormulaError::new(FormulaErrorKind::Time(format!("{error}")), at..at + text.len());
        return Ok((TokenKind::Duration(parsed.map_err(wrong)?.as_nanos()), text.len()));
    }
    if is_exponent(&rest[length..]) {
        let signed = usize::from(rest[length + 1..].starts_with(['+', '-']));
        length += 1 + signed + digits(&rest[length + 1 + signed..]);
    }
    let text = &rest[..length];
    match text.replace('_', "").parse::<f64>() {
        Ok(value) if value.is_finite() => Ok((TokenKind::Number(value), length)),
        _ => Err(FormulaError::new(FormulaErrorKind::Number(text.to_owned()), at..at + length)),
    }
}

/// True for `e3`, `E-3`: digits follow.
fn is_exponent(rest: &str) -> bool {
    rest.strip_prefix(['e', 'E'])
        .is_some_and(|rest| rest.strip_prefix(['+', '-']).unwrap_or(rest).starts_with(|c: char| c.is_ascii_digit()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kinds(text: &str) -> Vec<TokenKind> {
        tokens(text).unwrap().into_iter().map(|token| token.kind).collect()
    }

    #[test]
    fn words_numbers_and_durations_end_where_they_should() {
        let found = kinds("ALWAYS[0,1.5s] axis[3].x >= 1e-3 `a-b` 5 bar");
        let expected = vec![
            TokenKind::Keyword(Keyword::Always),
            TokenKind::Sign("["),
            TokenKind::Number(0.0),
            TokenKind::Sign(","),
            TokenKind::Duration(1_500_000_000),
            TokenKind::Sign("]"),
            TokenKind::Name("axis[3].x".to_owned()),
            TokenKind::Sign(">="),
            TokenKind::Number(1e-3),
            TokenKind::Quoted("a-b".to_owned()),
            TokenKind::Number(5.0),
            TokenKind::Name("bar".to_owned()),
            TokenKind::End,
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn what_is_not_a_word_is_refused_at_its_place() {
        assert_eq!(tokens("a ? b").unwrap_err().place, 2..3);
        assert_eq!(tokens("a < 5parsec").unwrap_err().place, 4..11);
        assert_eq!(tokens("`a").unwrap_err().place, 0..2);
    }
}
