//! Words to a formula as written.
//!
//! | binds | operators |
//! |---|---|
//! | loosest | `iff`, `implies` (to the right) |
//! | | `or` |
//! | | `and` |
//! | | `until`, `since` |
//! | | `not`, `always`, `eventually`, `within T`, `for T`, `once`, `historically` |
//! | | `<`, `<=`, `>`, `>=`, `=`, `<>` |
//! | tightest | `+`, `-`, then `*`, `/`, then `-x`, `abs()`, `rate()`, `min(,)`, `max(,)` |

use std::ops::Range;

use onescan_base::did_you_mean;

use super::error::{FormulaError, FormulaErrorKind};
use super::formula::{Arithmetic, Comparison, Edge, Formula, Term, TermKind, Window};
use super::token::{Keyword, Token, TokenKind, tokens};

/// A signal as written.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Written {
    pub(super) name: String,
    pub(super) place: Range<usize>,
}

type Parsed<T> = Result<T, FormulaError>;

/// Greatest depth of formulas within formulas: evaluation recurses.
const MAX_DEPTH: usize = 100;

/// The formula in `text`.
pub(super) fn parse(text: &str) -> Parsed<Formula<Written>> {
    let mut parser = Parser { tokens: tokens(text)?, at: 0, depth: 0 };
    let formula = parser.formula()?;
    match parser.peek().kind {
        TokenKind::End => Ok(formula),
        _ => Err(parser.misspelt().unwrap_or_else(|| parser.expected("an operator or the end"))),
    }
}

/// Letters of a word that may be a misspelt one of the language: shorter ones are names and units.
const MISSPELT_MIN: usize = 4;

struct Parser {
    /// The last one is the end, which is never passed.
    tokens: Vec<Token>,
    at: usize,
    depth: usize,
}

impl Parser {
    fn peek(&self) -> &Token {
        &self.tokens[self.at]
    }

    fn advance(&mut self) -> Token {
        let token = self.peek().clone();
        self.at = (self.at + 1).min(self.tokens.len() - 1);
        token
    }

    fn take_sign(&mut self, signs: &[&'static str]) -> Option<&'static str> {
        match self.peek().kind {
            TokenKind::Sign(sign) if signs.contains(&sign) => {
                self.advance();
                Some(sign)
            }
            _ => None,
        }
    }

    fn take_keyword(&mut self, keywords: &[Keyword]) -> Option<Keyword> {
        match self.peek().kind {
            TokenKind::Keyword(keyword) if keywords.contains(&keyword) => {
                self.advance();
                Some(keyword)
            }
            _ => None,
        }
    }

    fn expect_sign(&mut self, sign: &'static str, expected: &'static str) -> Parsed<()> {
        self.take_sign(&[sign]).map(|_| ()).ok_or_else(|| self.expected(expected))
    }

    fn expected(&self, expected: &'static str) -> FormulaError {
        let token = self.peek();
        let found = match &token.kind {
            TokenKind::Keyword(keyword) => format!("`{}`", keyword.text()),
            TokenKind::Name(name) | TokenKind::Quoted(name) => format!("`{name}`"),
            TokenKind::Number(value) => format!("`{value}`"),
            TokenKind::Duration(_) => "a time".to_owned(),
            TokenKind::Sign(sign) => format!("`{sign}`"),
            TokenKind::End => "the end".to_owned(),
        };
        FormulaError::new(FormulaErrorKind::Expected { expected, found }, token.place.clone())
    }

    /// The word before what does not go on, if it is nearly one of the language: it was read as a signal.
    fn misspelt(&self) -> Option<FormulaError> {
        let before = self.tokens.get(self.at.checked_sub(1)?)?;
        let TokenKind::Name(name) = &before.kind else { return None };
        let words = Keyword::ALL.iter().map(|keyword| keyword.text());
        let help = did_you_mean(name, words).filter(|_| name.chars().count() >= MISSPELT_MIN)?;
        let kind = FormulaErrorKind::UnknownWord(name.clone());
        Some(FormulaError::new(kind, before.place.clone()).with_help(help))
    }

    /// Counts every level of nesting, whatever makes it.
    fn deeper<T>(&mut self, parse: impl FnOnce(&mut Self) -> Parsed<T>) -> Parsed<T> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(FormulaError::new(FormulaErrorKind::TooDeep(MAX_DEPTH), self.peek().place.clone()));
        }
        let parsed = parse(self);
        self.depth -= 1;
        parsed
    }

    fn formula(&mut self) -> Parsed<Formula<Written>> {
        self.deeper(|parser| {
            let left = parser.disjunction()?;
            let Some(keyword) = parser.take_keyword(&[Keyword::Implies, Keyword::Iff]) else { return Ok(left) };
            let right = Box::new(parser.formula()?);
            Ok(match keyword {
                Keyword::Iff => Formula::Iff(Box::new(left), right),
                _ => Formula::Implies(Box::new(left), right),
            })
        })
    }

    fn disjunction(&mut self) -> Parsed<Formula<Written>> {
        let mut left = self.conjunction()?;
        let mut operands = 0;
        while self.take_keyword(&[Keyword::Or]).is_some() {
            operands = self.one_more(operands)?;
            left = Formula::Or(Box::new(left), Box::new(self.conjunction()?));
        }
        Ok(left)
    }

    fn conjunction(&mut self) -> Parsed<Formula<Written>> {
        let mut left = self.temporal()?;
        let mut operands = 0;
        while self.take_keyword(&[Keyword::And]).is_some() {
            operands = self.one_more(operands)?;
            left = Formula::And(Box::new(left), Box::new(self.temporal()?));
        }
        Ok(left)
    }

    /// A chain of operators is a tree that leans to the left, and as deep as it is long.
    fn one_more(&self, operands: usize) -> Parsed<usize> {
        if operands + 1 >= MAX_DEPTH {
            return Err(FormulaError::new(FormulaErrorKind::TooDeep(MAX_DEPTH), self.peek().place.clone()));
        }
        Ok(operands + 1)
    }

    fn temporal(&mut self) -> Parsed<Formula<Written>> {
        let left = self.unary()?;
        let Some(keyword) = self.take_keyword(&[Keyword::Until, Keyword::Since]) else { return Ok(left) };
        let window = self.window()?;
        let (left, right) = (Box::new(left), Box::new(self.unary()?));
        Ok(match keyword {
            Keyword::Until => Formula::Until(window, left, right),
            _ => Formula::Since(window, left, right),
        })
    }

    fn unary(&mut self) -> Parsed<Formula<Written>> {
        self.deeper(|parser| {
            let TokenKind::Keyword(keyword) = parser.peek().kind else { return parser.relation() };
            let make: fn(Window, Box<Formula<Written>>) -> Formula<Written> = match keyword {
                Keyword::Not => |_, operand| Formula::Not(operand),
                Keyword::Always | Keyword::For => Formula::Always,
                Keyword::Eventually | Keyword::Within => Formula::Eventually,
                Keyword::Historically => Formula::Historically,
                Keyword::Once => Formula::Once,
                _ => return parser.relation(),
            };
            parser.advance();
            let window = match keyword {
                Keyword::Not => Window::WHOLE,
                Keyword::For | Keyword::Within => Window::first(parser.duration()?),
                _ => parser.window()?,
            };
            Ok(make(window, Box::new(parser.unary()?)))
        })
    }

    /// `[0, 200ms]`, `[200ms,]`, or nothing for the whole run.
    fn window(&mut self) -> Parsed<Window> {
        let start = self.peek().place.start;
        if self.take_sign(&["["]).is_none() {
            return Ok(Window::WHOLE);
        }
        let from_ns = self.duration()?;
        self.expect_sign(",", "`,` within the window")?;
        let to_ns = match self.peek().kind {
            TokenKind::Sign("]") => None,
            _ => Some(self.duration()?),
        };
        let end = self.peek().place.end;
        self.expect_sign("]", "`]` behind the window")?;
        if to_ns.is_some_and(|to_ns| to_ns < from_ns) {
            return Err(FormulaError::new(FormulaErrorKind::EmptyWindow, start..end));
        }
        Ok(Window { from_ns, to_ns })
    }

    fn duration(&mut self) -> Parsed<u64> {
        let ns = match self.peek().kind {
            TokenKind::Duration(ns) => ns,
            TokenKind::Number(0.0) => 0,
            _ => return Err(self.expected("a time, as in `200ms`")),
        };
        self.advance();
        Ok(ns)
    }

    /// A comparison, a BOOL signal, an edge, a constant or a formula in parentheses.
    fn relation(&mut self) -> Parsed<Formula<Written>> {
        if let Some(keyword) = self.take_keyword(&[Keyword::Rose, Keyword::Fell, Keyword::Changed]) {
            return self.edge(keyword);
        }
        match self.take_keyword(&[Keyword::True, Keyword::False]) {
            Some(keyword) => return Ok(Formula::Constant(keyword == Keyword::True)),
            None if self.is_parenthesised_formula() => {
                self.advance();
                let formula = self.formula()?;
                self.expect_sign(")", "`)`")?;
                return Ok(formula);
            }
            None => {}
        }
        let left = self.sum()?;
        match self.comparison() {
            Some(comparison) => Ok(Formula::Compare(comparison, Box::new(left), Box::new(self.sum()?))),
            None => match left.kind {
                TermKind::Signal(signal) => Ok(Formula::Signal(signal)),
                _ => Err(self.expected("a comparison")),
            },
        }
    }

    fn edge(&mut self, keyword: Keyword) -> Parsed<Formula<Written>> {
        let edge = match keyword {
            Keyword::Rose => Edge::Rose,
            Keyword::Fell => Edge::Fell,
            _ => Edge::Changed,
        };
        self.expect_sign("(", "`(`")?;
        let operand = self.formula()?;
        self.expect_sign(")", "`)`")?;
        Ok(Formula::Edge(edge, Box::new(operand)))
    }

    fn comparison(&mut self) -> Option<Comparison> {
        let sign = self.take_sign(&["<", "<=", ">", ">=", "=", "==", "<>", "!="])?;
        Some(match sign {
            "<" => Comparison::Less,
            "<=" => Comparison::LessEqual,
            ">" => Comparison::Greater,
            ">=" => Comparison::GreaterEqual,
            "=" | "==" => Comparison::Equal,
            _ => Comparison::NotEqual,
        })
    }

    /// `(a and b)` is a formula, `(a + b) < c` begins with a term: what follows the closing
    /// parenthesis, and what stands within, decides.
    fn is_parenthesised_formula(&self) -> bool {
        if !matches!(self.peek().kind, TokenKind::Sign("(")) {
            return false;
        }
        let mut depth = 0_usize;
        for (index, token) in self.tokens.iter().enumerate().skip(self.at) {
            match token.kind {
                TokenKind::Sign("(") => depth += 1,
                TokenKind::Sign(")") if depth == 1 => {
                    let next = self.tokens.get(index + 1).map(|token| &token.kind);
                    return !matches!(
                        next,
                        Some(TokenKind::Sign(
                            "<" | "<=" | ">" | ">=" | "=" | "==" | "<>" | "!=" | "+" | "-" | "*" | "/"
                        ))
                    );
                }
                TokenKind::Sign(")") => depth -= 1,
                _ => {}
            }
        }
        true
    }

    fn sum(&mut self) -> Parsed<Term<Written>> {
        self.chain(&["+", "-"], Self::product)
    }

    fn product(&mut self) -> Parsed<Term<Written>> {
        self.chain(&["*", "/"], Self::factor)
    }

    fn chain(
        &mut self,
        signs: &[&'static str],
        operand: fn(&mut Self) -> Parsed<Term<Written>>,
    ) -> Parsed<Term<Written>> {
        let mut left = operand(self)?;
        let mut operands = 0;
        while let Some(sign) = self.take_sign(signs) {
            operands = self.one_more(operands)?;
            let operator = match sign {
                "+" => Arithmetic::Add,
                "-" => Arithmetic::Subtract,
                "*" => Arithmetic::Multiply,
                _ => Arithmetic::Divide,
            };
            left = binary(operator, left, operand(self)?);
        }
        Ok(left)
    }

    fn factor(&mut self) -> Parsed<Term<Written>> {
        self.deeper(|parser| {
            let token = parser.peek().clone();
            let start = token.place.start;
            let kind = match token.kind {
                TokenKind::Number(value) => {
                    parser.advance();
                    TermKind::Number(value, parser.unit())
                }
                TokenKind::Duration(ns) => {
                    parser.advance();
                    TermKind::Number(ns as f64, Some("ns".to_owned()))
                }
                TokenKind::Name(name) | TokenKind::Quoted(name) => {
                    parser.advance();
                    TermKind::Signal(Written { name, place: token.place.clone() })
                }
                TokenKind::Sign("-") => {
                    parser.advance();
                    TermKind::Negate(Box::new(parser.factor()?))
                }
                TokenKind::Sign("(") => {
                    parser.advance();
                    let inner = parser.sum()?;
                    parser.expect_sign(")", "`)`")?;
                    return Ok(inner);
                }
                TokenKind::Keyword(keyword @ (Keyword::Abs | Keyword::Rate | Keyword::Min | Keyword::Max)) => {
                    parser.advance();
                    return parser.function(keyword, start);
                }
                _ => return Err(parser.expected("a signal, a number or a formula")),
            };
            let end = parser.tokens[parser.at.saturating_sub(1)].place.end;
            Ok(Term { kind, place: start..end })
        })
    }

    /// A name right behind a number is its unit: two terms never stand side by side.
    fn unit(&mut self) -> Option<String> {
        let TokenKind::Name(name) = self.peek().kind.clone() else { return None };
        self.advance();
        // Units of a quotient: `mm/s`, `m/s`.
        let per = matches!(self.peek().kind, TokenKind::Sign("/"));
        let below = self.tokens.get(self.at + 1).map(|token| token.kind.clone());
        match below {
            Some(TokenKind::Name(below)) if per && super::unit::Unit::find(&format!("{name}/{below}")).is_some() => {
                self.advance();
                self.advance();
                Some(format!("{name}/{below}"))
            }
            _ => Some(name),
        }
    }

    fn function(&mut self, keyword: Keyword, start: usize) -> Parsed<Term<Written>> {
        self.expect_sign("(", "`(`")?;
        let mut term = self.sum()?;
        match keyword {
            Keyword::Min | Keyword::Max => {
                let operator = if keyword == Keyword::Min { Arithmetic::Min } else { Arithmetic::Max };
                self.expect_sign(",", "`,` and another value")?;
                term = binary(operator, term, self.sum()?);
                let mut operands = 1;
                while self.take_sign(&[","]).is_some() {
                    operands = self.one_more(operands)?;
                    term = binary(operator, term, self.sum()?);
                }
            }
            _ => {
                let kind = if keyword == Keyword::Abs { TermKind::Abs } else { TermKind::Rate };
                let place = term.place.clone();
                term = Term { kind: kind(Box::new(term)), place };
            }
        }
        let end = self.peek().place.end;
        self.expect_sign(")", "`)`")?;
        Ok(Term { place: start..end, ..term })
    }
}

fn binary(operator: Arithmetic, left: Term<Written>, right: Term<Written>) -> Term<Written> {
    let place = left.place.start..right.place.end;
    Term { kind: TermKind::Binary(operator, Box::new(left), Box::new(right)), place }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn operators_bind_as_the_table_says() {
        let same = [
            ("a and b or c implies d", "((a and b) or c) implies d"),
            ("a implies b implies c", "a implies (b implies c)"),
            ("not a and b", "(not a) and b"),
            ("always a implies b", "(always a) implies b"),
            ("always within 1s a", "always (within 1s (a))"),
            ("a and b until[0,1s] c", "a and (b until[0,1s] c)"),
        ];
        for (bare, clear) in same {
            let places = |formula: Formula<Written>| strip(&format!("{formula:?}"));
            assert_eq!(places(parse(bare).unwrap()), places(parse(clear).unwrap()), "{bare}");
        }
    }

    /// The text without places.
    fn strip(debug: &str) -> String {
        let mut kept = String::new();
        let mut rest = debug;
        while let Some(start) = rest.find("place: ") {
            kept.push_str(&rest[..start]);
            rest = &rest[start..];
            rest = &rest[rest.find([' ', '}']).map_or(rest.len(), |space| space + 1)..];
            rest = rest.trim_start_matches(|c: char| c.is_ascii_digit() || c == '.');
        }
        kept + rest
    }

    #[test]
    fn parentheses_hold_formulas_and_terms() {
        assert!(parse("(a + b) * 2 < c and (d or e)").is_ok());
        assert!(parse("((a)) implies (b > 1)").is_ok());
        assert!(parse("speed < 5 mm/s").is_ok());
        assert!(parse("min(a, b, 3) >= abs(-c)").is_ok());
    }

    #[test]
    fn what_does_not_go_on_is_reported_with_its_place() {
        let wrong = |text: &str| {
            let error = parse(text).unwrap_err();
            format!("{}..{} {error}", error.place.start, error.place.end)
        };
        assert_eq!(wrong("always"), "6..6 expected a signal, a number or a formula, found the end");
        assert_eq!(wrong("within x"), "7..8 expected a time, as in `200ms`, found `x`");
        assert_eq!(wrong("eventualy b > 3"), "0..9 `eventualy` is not a word of expectations");
        assert_eq!(wrong("a implies alway (b)"), "10..15 `alway` is not a word of expectations");
        assert_eq!(parse("eventualy b").unwrap_err().help.as_deref(), Some("did you mean `eventually`?"));
        assert_eq!(wrong("a b"), "2..3 expected an operator or the end, found `b`");
        assert_eq!(wrong("once[2s,1s] a"), "4..11 the window ends before it begins");
        assert_eq!(wrong("1 + 2"), "5..5 expected a comparison, found the end");
    }

    #[test]
    fn nesting_has_a_limit() {
        for text in ["not ".repeat(5000) + "a", "(".repeat(5000) + "a", "a and ".repeat(5000) + "a", "-".repeat(5000)] {
            assert!(matches!(parse(&text).unwrap_err().kind, FormulaErrorKind::TooDeep(_)));
        }
    }
}
