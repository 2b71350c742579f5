//! Expressions between `${` and `}`: the part of Python's that robots' files use.
//!
//! Source: Python language reference, ch. 6 (precedence, comparisons that chain, short circuits).

use super::value::Value;

/// Longest expression, in tokens, and its deepest nesting.
const TOKENS_MAX: usize = 500;
const DEPTH_MAX: usize = 64;

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Expression {
    Constant(Value),
    Name(String),
    List(Vec<Self>),
    Comprehension(Box<Comprehension>),
    Index(Box<Self>, Box<Self>),
    Member(Box<Self>, String),
    /// Callee, arguments, and those with names.
    Call(Box<Self>, Vec<Self>, Vec<(String, Self)>),
    Minus(Box<Self>),
    Not(Box<Self>),
    Binary(&'static str, Box<Self>, Box<Self>),
    /// The first operand, and each operator with the next.
    Compare(Box<Self>, Vec<(&'static str, Self)>),
    And(Box<Self>, Box<Self>),
    Or(Box<Self>, Box<Self>),
    Choice(Box<Self>, Box<Self>, Box<Self>),
}

/// `[each for names in of if filter]`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Comprehension {
    pub(super) each: Expression,
    /// What an item is called, or its parts are.
    pub(super) names: Vec<String>,
    pub(super) of: Expression,
    pub(super) filter: Option<Expression>,
}

#[derive(Clone, Debug, PartialEq)]
enum Token {
    Constant(Value),
    Name(String),
    Sign(&'static str),
}

/// Signs, longer ones first.
const SIGNS: &[&str] =
    &["**", "//", "==", "!=", "<=", ">=", "<", ">", "+", "-", "*", "/", "%", "(", ")", "[", "]", ",", ".", "=", ":"];

fn tokens(text: &str) -> Result<Vec<Token>, String> {
    let mut tokens = Vec::new();
    let mut rest = text.trim_start();
    while let Some(first) = rest.chars().next() {
        if tokens.len() >= TOKENS_MAX {
            return Err("the expression is too long".to_owned());
        }
        let decimal = first == '.' && rest[1..].starts_with(|c: char| c.is_ascii_digit());
        let taken = if first == '\'' || first == '"' {
            let inner = &rest[1..];
            let end = inner.find(first).ok_or_else(|| format!("the text {rest} does not end"))?;
            tokens.push(Token::Constant(Value::Text(inner[..end].to_owned())));
            end + 2
        } else if first.is_ascii_digit() || decimal {
            let length = number_length(rest);
            let number = Value::literal(&rest[..length]);
            if number.number().is_none() {
                return Err(format!("`{}` is not a number", &rest[..length]));
            }
            tokens.push(Token::Constant(number));
            length
        } else if first.is_alphabetic() || first == '_' {
            let length = rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len());
            tokens.push(match &rest[..length] {
                "True" | "true" => Token::Constant(Value::Bool(true)),
                "False" | "false" => Token::Constant(Value::Bool(false)),
                "None" => Token::Constant(Value::None),
                name => Token::Name(name.to_owned()),
            });
            length
        } else {
            let sign = SIGNS.iter().find(|sign| rest.starts_with(**sign));
            let sign = sign.ok_or_else(|| format!("`{first}` means nothing in an expression"))?;
            tokens.push(Token::Sign(sign));
            sign.len()
        };
        rest = rest[taken..].trim_start();
    }
    Ok(tokens)
}

fn number_length(text: &str) -> usize {
    let mut before = ' ';
    let part = |c: char| {
        let exponent = matches!(c, '+' | '-') && matches!(before, 'e' | 'E');
        let is_part = c.is_ascii_digit() || matches!(c, '.' | 'e' | 'E') || exponent;
        before = c;
        !is_part
    };
    text.find(part).unwrap_or(text.len())
}

struct Parser {
    tokens: Vec<Token>,
    at: usize,
    depth: usize,
}

impl Expression {
    /// # Errors
    /// A text that is not an expression of those that are known here.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let mut parser = Parser { tokens: tokens(text)?, at: 0, depth: 0 };
        let expression = parser.choice()?;
        match parser.tokens.get(parser.at) {
            None => Ok(expression),
            Some(_) => Err(format!("`{}` is not an expression that is understood here", text.trim())),
        }
    }
}

/// Whether an expression asks for the value of a name.
pub(super) fn mentions(text: &str, name: &str) -> bool {
    let Ok(tokens) = tokens(text) else { return false };
    let named = |at: &usize| matches!(&tokens[*at], Token::Name(known) if known == name);
    // behind a `.` it is the name of a member
    let is_member = |at: usize| at.checked_sub(1).is_some_and(|before| tokens[before] == Token::Sign("."));
    (0..tokens.len()).filter(named).any(|at| !is_member(at))
}

type Parsed = Result<Expression, String>;

impl Parser {
    fn word(&mut self, word: &str) -> bool {
        let found = matches!(self.tokens.get(self.at), Some(Token::Name(name)) if name == word);
        self.at += usize::from(found);
        found
    }

    fn sign(&mut self, signs: &[&'static str]) -> Option<&'static str> {
        let Some(Token::Sign(sign)) = self.tokens.get(self.at) else { return None };
        let found = signs.contains(sign).then_some(*sign);
        self.at += usize::from(found.is_some());
        found
    }

    fn expect(&mut self, sign: &'static str) -> Result<(), String> {
        self.sign(&[sign]).map(|_| ()).ok_or_else(|| format!("the expression lacks a `{sign}`"))
    }

    fn choice(&mut self) -> Parsed {
        self.depth += 1;
        if self.depth > DEPTH_MAX {
            return Err("the expression is nested too deep".to_owned());
        }
        let then = self.or()?;
        let parsed = if self.word("if") {
            let condition = self.or()?;
            if !self.word("else") {
                return Err("`if` without `else`".to_owned());
            }
            Expression::Choice(Box::new(condition), Box::new(then), Box::new(self.choice()?))
        } else {
            then
        };
        self.depth -= 1;
        Ok(parsed)
    }

    fn or(&mut self) -> Parsed {
        let mut left = self.and()?;
        while self.word("or") {
            left = Expression::Or(Box::new(left), Box::new(self.and()?));
        }
        Ok(left)
    }

    fn and(&mut self) -> Parsed {
        let mut left = self.not()?;
        while self.word("and") {
            left = Expression::And(Box::new(left), Box::new(self.not()?));
        }
        Ok(left)
    }

    fn not(&mut self) -> Parsed {
        let mut turned = false;
        let mut any = false;
        while self.word("not") {
            (turned, any) = (!turned, true);
        }
        let inner = self.comparison()?;
        let not = |inner| Expression::Not(Box::new(inner));
        Ok(match (any, turned) {
            (false, _) => inner,
            (true, true) => not(inner),
            (true, false) => not(not(inner)),
        })
    }

    fn comparison(&mut self) -> Parsed {
        let first = self.sum()?;
        let mut others = Vec::new();
        loop {
            let operator = if self.word("in") {
                "in"
            } else if self.word("not") {
                if !self.word("in") {
                    return Err("`not` without `in`".to_owned());
                }
                "not in"
            } else if self.word("is") {
                if self.word("not") { "!=" } else { "==" }
            } else if let Some(sign) = self.sign(&["==", "!=", "<=", ">=", "<", ">"]) {
                sign
            } else {
                break;
            };
            others.push((operator, self.sum()?));
        }
        Ok(if others.is_empty() { first } else { Expression::Compare(Box::new(first), others) })
    }

    fn sum(&mut self) -> Parsed {
        let mut left = self.term()?;
        while let Some(sign) = self.sign(&["+", "-"]) {
            left = Expression::Binary(sign, Box::new(left), Box::new(self.term()?));
        }
        Ok(left)
    }

    fn term(&mut self) -> Parsed {
        let mut left = self.unary()?;
        while let Some(sign) = self.sign(&["*", "/", "//", "%"]) {
            left = Expression::Binary(sign, Box::new(left), Box::new(self.unary()?));
        }
        Ok(left)
    }

    fn unary(&mut self) -> Parsed {
        let mut minus = false;
        while let Some(sign) = self.sign(&["+", "-"]) {
            minus ^= sign == "-";
        }
        let power = self.power()?;
        Ok(if minus { Expression::Minus(Box::new(power)) } else { power })
    }

    fn power(&mut self) -> Parsed {
        let base = self.postfix()?;
        if self.sign(&["**"]).is_none() {
            return Ok(base);
        }
        self.depth += 1;
        if self.depth > DEPTH_MAX {
            return Err("the expression is nested too deep".to_owned());
        }
        let exponent = self.unary()?;
        self.depth -= 1;
        Ok(Expression::Binary("**", Box::new(base), Box::new(exponent)))
    }

    fn postfix(&mut self) -> Parsed {
        let mut inner = self.atom()?;
        loop {
            match self.sign(&["[", ".", "("]) {
                Some("[") => {
                    let index = self.choice()?;
                    self.expect("]")?;
                    inner = Expression::Index(Box::new(inner), Box::new(index));
                }
                Some(".") => match self.tokens.get(self.at) {
                    Some(Token::Name(name)) => {
                        inner = Expression::Member(Box::new(inner), name.clone());
                        self.at += 1;
                    }
                    _ => return Err("a `.` needs a name behind it".to_owned()),
                },
                Some(_) => inner = self.call(inner)?,
                None => return Ok(inner),
            }
        }
    }

    fn call(&mut self, callee: Expression) -> Parsed {
        let (mut plain, mut named) = (Vec::new(), Vec::new());
        while self.sign(&[")"]).is_none() {
            let name = match (self.tokens.get(self.at), self.tokens.get(self.at + 1)) {
                (Some(Token::Name(name)), Some(Token::Sign("="))) => Some(name.clone()),
                _ => None,
            };
            if let Some(name) = name {
                self.at += 2;
                named.push((name, self.choice()?));
            } else {
                plain.push(self.choice()?);
            }
            if self.sign(&[","]).is_none() {
                self.expect(")")?;
                break;
            }
        }
        Ok(Expression::Call(Box::new(callee), plain, named))
    }

    fn atom(&mut self) -> Parsed {
        let token = self.tokens.get(self.at).cloned();
        self.at += 1;
        match token {
            Some(Token::Constant(value)) => Ok(Expression::Constant(value)),
            Some(Token::Name(name)) => Ok(Expression::Name(name)),
            Some(Token::Sign("(")) => {
                self.listed(")").map(
                    |(mut list, commas)| {
                        if list.len() == 1 && !commas { list.remove(0) } else { Expression::List(list) }
                    },
                )
            }
            Some(Token::Sign("[")) => self.bracketed(),
            Some(Token::Sign(sign)) => Err(format!("`{sign}` stands where a value should")),
            None => Err("the expression ends where a value should stand".to_owned()),
        }
    }

    /// A list, of which the opening bracket is taken.
    fn bracketed(&mut self) -> Parsed {
        let start = self.at;
        if self.sign(&["]"]).is_some() {
            return Ok(Expression::List(Vec::new()));
        }
        let each = self.choice()?;
        if !self.word("for") {
            self.at = start;
            return self.listed("]").map(|(list, _)| Expression::List(list));
        }
        let mut names = Vec::new();
        while !self.word("in") {
            match self.tokens.get(self.at) {
                Some(Token::Name(name)) => names.push(name.clone()),
                _ => return Err("`for` needs names and an `in`".to_owned()),
            }
            self.at += 1;
            self.sign(&[","]);
        }
        let of = self.or()?;
        let filter = if self.word("if") { Some(self.or()?) } else { None };
        self.expect("]")?;
        Ok(Expression::Comprehension(Box::new(Comprehension { each, names, of, filter })))
    }

    /// Values up to a closing sign, and whether there was a comma.
    fn listed(&mut self, close: &'static str) -> Result<(Vec<Expression>, bool), String> {
        let (mut list, mut commas) = (Vec::new(), false);
        while self.sign(&[close]).is_none() {
            list.push(self.choice()?);
            if self.sign(&[","]).is_some() {
                commas = true;
            } else {
                self.expect(close)?;
                break;
            }
        }
        Ok((list, commas))
    }
}
