//! The part of NuSMV's language that models are written in (user manual 2.5, secs. 2.1 to 2.3 and 3).

use std::fmt;

/// A module.
#[derive(Debug, Default)]
pub(super) struct Module {
    pub(super) name: String,
    pub(super) parameters: Vec<String>,
    pub(super) variables: Vec<(String, Type)>,
    pub(super) defines: Vec<(String, Expression)>,
    pub(super) inits: Vec<(String, Expression)>,
    pub(super) nexts: Vec<(String, Expression)>,
    /// Each with its text.
    pub(super) specifications: Vec<(String, Expression)>,
}

/// What a variable may be.
#[derive(Debug)]
pub(super) enum Type {
    Boolean,
    Symbols(Vec<String>),
    Range(i64, i64),
    Instance(String, Vec<Expression>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Binary {
    Implies,
    Or,
    And,
    Equal,
    Unequal,
    Plus,
    Minus,
}

/// Operators of branching time with one operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Branching {
    AG,
    EF,
}

#[derive(Clone, Debug)]
pub(super) enum Expression {
    /// A name, with its path.
    Name(Vec<String>),
    Number(i64),
    Truth(bool),
    Not(Box<Expression>),
    Binary(Binary, Box<Expression>, Box<Expression>),
    Case(Vec<(Expression, Expression)>),
    Set(Vec<Expression>),
    Next(Box<Expression>),
    Branching(Branching, Box<Expression>),
    ExistsUntil(Box<Expression>, Box<Expression>),
}

/// What is not a model.
#[derive(Debug)]
pub(super) struct SyntaxError {
    line: usize,
    why: String,
}

impl fmt::Display for SyntaxError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.why)
    }
}

/// Signs, the longer ones first.
const SIGNS: [&str; 20] =
    [":=", "->", "!=", "..", "(", ")", "{", "}", "[", "]", ",", ";", ":", ".", "=", "!", "&", "|", "+", "-"];

/// Words and signs with their lines; comments are left out.
fn tokens(text: &str) -> Result<Vec<(&str, usize)>, SyntaxError> {
    let mut all = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let mut rest = line.split("--").next().unwrap_or_default().trim_start();
        while let Some(first) = rest.chars().next() {
            let length = match SIGNS.iter().find(|sign| rest.starts_with(**sign)) {
                Some(sign) => sign.len(),
                None => rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(rest.len()),
            };
            if length == 0 {
                return Err(SyntaxError { line: number + 1, why: format!("nothing begins with `{first}`") });
            }
            all.push((&rest[..length], number + 1));
            rest = rest[length..].trim_start();
        }
    }
    all.push(("", text.lines().count() + 1));
    Ok(all)
}

/// The modules of a model.
pub(super) fn parse(text: &str) -> Result<Vec<Module>, SyntaxError> {
    let mut parser = Parser { tokens: tokens(text)?, at: 0 };
    let mut modules = Vec::new();
    while parser.here() != "" {
        modules.push(parser.module()?);
    }
    Ok(modules)
}

struct Parser<'t> {
    tokens: Vec<(&'t str, usize)>,
    at: usize,
}

impl<'t> Parser<'t> {
    fn here(&self) -> &'t str {
        self.tokens[self.at].0
    }

    fn wrong<T>(&self, why: impl Into<String>) -> Result<T, SyntaxError> {
        Err(SyntaxError { line: self.tokens[self.at].1, why: why.into() })
    }

    /// Takes the token if it is this one.
    fn takes(&mut self, token: &str) -> bool {
        let is = self.here() == token;
        self.at += usize::from(is);
        is
    }

    fn expect(&mut self, token: &str) -> Result<(), SyntaxError> {
        if self.takes(token) { Ok(()) } else { self.wrong(format!("`{token}` expected")) }
    }

    fn is_word(&self) -> bool {
        self.here().starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
    }

    fn word(&mut self) -> Result<String, SyntaxError> {
        if !self.is_word() {
            return self.wrong("a name expected");
        }
        self.at += 1;
        Ok(self.tokens[self.at - 1].0.to_owned())
    }

    /// True in front of the next section, module or the end.
    fn ends_section(&self) -> bool {
        matches!(self.here(), "" | "MODULE" | "VAR" | "DEFINE" | "ASSIGN" | "SPEC")
    }

    fn module(&mut self) -> Result<Module, SyntaxError> {
        self.expect("MODULE")?;
        let mut module = Module { name: self.word()?, ..Module::default() };
        if self.takes("(") {
            module.parameters = self.list(")", Self::word)?;
        }
        loop {
            match self.here() {
                "VAR" => self.section(&mut module, Self::variable)?,
                "DEFINE" => self.section(&mut module, Self::define)?,
                "ASSIGN" => self.section(&mut module, Self::assign)?,
                "SPEC" => self.specification(&mut module)?,
                "" | "MODULE" => return Ok(module),
                _ => return self.wrong("a section or `MODULE` expected"),
            }
        }
    }

    fn section(
        &mut self,
        module: &mut Module,
        entry: fn(&mut Self, &mut Module) -> Result<(), SyntaxError>,
    ) -> Result<(), SyntaxError> {
        self.at += 1;
        while !self.ends_section() {
            entry(self, module)?;
            self.expect(";")?;
        }
        Ok(())
    }

    fn list<T>(&mut self, end: &str, entry: fn(&mut Self) -> Result<T, SyntaxError>) -> Result<Vec<T>, SyntaxError> {
        let mut all = vec![entry(self)?];
        while self.takes(",") {
            all.push(entry(self)?);
        }
        self.expect(end)?;
        Ok(all)
    }

    fn variable(&mut self, module: &mut Module) -> Result<(), SyntaxError> {
        let name = self.word()?;
        self.expect(":")?;
        let ty = match self.here() {
            "boolean" => {
                self.at += 1;
                Type::Boolean
            }
            "{" => {
                self.at += 1;
                Type::Symbols(self.list("}", Self::word)?)
            }
            _ if self.is_word() => {
                let of = self.word()?;
                let given = if self.takes("(") { self.list(")", Self::expression)? } else { Vec::new() };
                Type::Instance(of, given)
            }
            _ => {
                let low = self.number()?;
                self.expect("..")?;
                Type::Range(low, self.number()?)
            }
        };
        module.variables.push((name, ty));
        Ok(())
    }

    fn number(&mut self) -> Result<i64, SyntaxError> {
        let Ok(number) = self.here().parse() else { return self.wrong("a number expected") };
        self.at += 1;
        Ok(number)
    }

    fn define(&mut self, module: &mut Module) -> Result<(), SyntaxError> {
        let name = self.word()?;
        self.expect(":=")?;
        module.defines.push((name, self.expression()?));
        Ok(())
    }

    fn assign(&mut self, module: &mut Module) -> Result<(), SyntaxError> {
        let which = self.word()?;
        self.expect("(")?;
        let name = self.word()?;
        self.expect(")")?;
        self.expect(":=")?;
        let value = self.expression()?;
        match which.as_str() {
            "init" => module.inits.push((name, value)),
            "next" => module.nexts.push((name, value)),
            _ => return self.wrong("`init` or `next` expected"),
        }
        Ok(())
    }

    fn specification(&mut self, module: &mut Module) -> Result<(), SyntaxError> {
        self.at += 1;
        let from = self.at;
        let claim = self.expression()?;
        let words: Vec<&str> = self.tokens[from..self.at].iter().map(|(word, _)| *word).collect();
        module.specifications.push((words.join(" "), claim));
        self.takes(";");
        Ok(())
    }

    /// `->` binds least, then `|`, `&`, `!` and the operators of branching time, comparisons, sums.
    fn expression(&mut self) -> Result<Expression, SyntaxError> {
        let left = self.either()?;
        if !self.takes("->") {
            return Ok(left);
        }
        Ok(Expression::Binary(Binary::Implies, Box::new(left), Box::new(self.expression()?)))
    }

    fn either(&mut self) -> Result<Expression, SyntaxError> {
        self.chain(&[("|", Binary::Or)], Self::both)
    }

    fn both(&mut self) -> Result<Expression, SyntaxError> {
        self.chain(&[("&", Binary::And)], Self::prefixed)
    }

    fn chain(
        &mut self,
        signs: &[(&str, Binary)],
        operand: fn(&mut Self) -> Result<Expression, SyntaxError>,
    ) -> Result<Expression, SyntaxError> {
        let mut left = operand(self)?;
        while let Some((sign, binary)) = signs.iter().find(|(sign, _)| *sign == self.here()) {
            self.expect(sign)?;
            left = Expression::Binary(*binary, Box::new(left), Box::new(operand(self)?));
        }
        Ok(left)
    }

    fn prefixed(&mut self) -> Result<Expression, SyntaxError> {
        match self.here() {
            "!" => {
                self.at += 1;
                Ok(Expression::Not(Box::new(self.prefixed()?)))
            }
            "AG" | "EF" => {
                let branching = if self.here() == "AG" { Branching::AG } else { Branching::EF };
                self.at += 1;
                Ok(Expression::Branching(branching, Box::new(self.prefixed()?)))
            }
            _ => self.comparison(),
        }
    }

    fn comparison(&mut self) -> Result<Expression, SyntaxError> {
        self.chain(&[("=", Binary::Equal), ("!=", Binary::Unequal)], Self::sum)
    }

    fn sum(&mut self) -> Result<Expression, SyntaxError> {
        self.chain(&[("+", Binary::Plus), ("-", Binary::Minus)], Self::single)
    }

    fn single(&mut self) -> Result<Expression, SyntaxError> {
        match self.here() {
            "(" => {
                self.at += 1;
                let inner = self.expression()?;
                self.expect(")")?;
                Ok(inner)
            }
            "{" => {
                self.at += 1;
                Ok(Expression::Set(self.list("}", Self::expression)?))
            }
            "TRUE" | "FALSE" => {
                self.at += 1;
                Ok(Expression::Truth(self.tokens[self.at - 1].0 == "TRUE"))
            }
            "case" => self.case(),
            "next" => {
                self.at += 1;
                self.expect("(")?;
                let inner = self.expression()?;
                self.expect(")")?;
                Ok(Expression::Next(Box::new(inner)))
            }
            "E" => {
                self.at += 1;
                self.expect("[")?;
                let hold = self.expression()?;
                self.expect("U")?;
                let until = self.expression()?;
                self.expect("]")?;
                Ok(Expression::ExistsUntil(Box::new(hold), Box::new(until)))
            }
            _ if self.is_word() => {
                let mut path = vec![self.word()?];
                while self.takes(".") {
                    path.push(self.word()?);
                }
                Ok(Expression::Name(path))
            }
            here if here.starts_with(|c: char| c.is_ascii_digit()) => Ok(Expression::Number(self.number()?)),
            _ => self.wrong("an expression expected"),
        }
    }

    fn case(&mut self) -> Result<Expression, SyntaxError> {
        self.expect("case")?;
        let mut arms = Vec::new();
        while !self.takes("esac") {
            let condition = self.expression()?;
            self.expect(":")?;
            arms.push((condition, self.expression()?));
            self.expect(";")?;
        }
        Ok(Expression::Case(arms))
    }
}
