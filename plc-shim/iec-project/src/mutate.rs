//! Mutants: programs with one small mistake, to find out whether anything would notice it.
//!
//! | mutation | of | to |
//! |---|---|---|
//! | operator | `+` `-` `*` `/` `MOD` | the opposite; `*` for `MOD` |
//! | operator | `<` `<=` `>` `>=` | the one with, or without, equality; and the opposite |
//! | operator | `=` `<>`, `AND` `OR` `XOR` | the opposite, `OR` for `XOR` |
//! | operator | `NOT a`, `-a` | `a` |
//! | constant | `TRUE`, `FALSE` | the other |
//! | constant | a number | one more; twice a REAL |
//! | constant | a duration | twice as long |
//! | condition | of `IF`, `ELSIF`, `WHILE`, `UNTIL` | its opposite |
//! | statement | an assignment, a call | nothing |
//! | timer | `TON` `TOF` `TP`, `R_TRIG` `F_TRIG`, `RS` `SR` | another one with the same variables |
//!
//! What is changed is text: all else of the file stays byte for byte. Of drawn programs it is the text that they were read as.

use std::collections::BTreeSet;
use std::fmt;
use std::ops::Range;
use std::str::FromStr;

use onescan_iec::input::Input;
use onescan_iec::source::{FileId, LineColumn, SourceFile, Span};
use onescan_iec::syntax::ast::{
    BinaryOp, Call, Declaration, Expr, ExprKind, IfStatement, Initialiser, InitialiserKind, Literal, Pou, Section,
    Statement, StatementKind, TypeSpecKind, UnaryOp,
};
use onescan_iec::syntax::token::TokenKind;
use onescan_iec::syntax::{parse_source, tokenize_in, walk};

/// What is changed in a mutant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum MutantKind {
    Operator,
    Constant,
    Condition,
    /// A statement is left out.
    Statement,
    /// A timer or another standard block is of another kind.
    Timer,
}

/// A word that is not one of a [`MutantKind`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("write one of {}", MutantKind::ALL.map(MutantKind::word).join(", "))]
pub struct UnknownMutantKind;

impl MutantKind {
    pub const ALL: [Self; 5] = [Self::Operator, Self::Constant, Self::Condition, Self::Statement, Self::Timer];

    /// As it is written and shown.
    pub fn word(self) -> &'static str {
        match self {
            Self::Operator => "operator",
            Self::Constant => "constant",
            Self::Condition => "condition",
            Self::Statement => "statement",
            Self::Timer => "timer",
        }
    }
}

impl fmt::Display for MutantKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.word())
    }
}

impl FromStr for MutantKind {
    type Err = UnknownMutantKind;

    fn from_str(word: &str) -> Result<Self, UnknownMutantKind> {
        Self::ALL.into_iter().find(|kind| kind.word() == word).ok_or(UnknownMutantKind)
    }
}

/// One small mistake in one file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mutant {
    pub kind: MutantKind,
    /// Bytes of the program text that are replaced.
    pub range: Range<u32>,
    /// What comes in their place.
    pub replacement: String,
    pub was: String,
    /// Where it stands, as its author sees the file.
    pub place: LineColumn,
    /// The line of the statement that it is in, as its author sees it.
    pub line: u32,
}

impl fmt::Display for Mutant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let short = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
        match self.kind {
            MutantKind::Statement => write!(f, "`{}` is left out", short(&self.was)),
            _ => write!(f, "`{}` for `{}`", short(&self.replacement), short(&self.was)),
        }
    }
}

/// All mutants of a file, in the order of its text. None of text that does not parse.
pub fn mutants(file: &SourceFile) -> Vec<Mutant> {
    let parsed = parse_source(FileId(0), file);
    if parsed.diagnostics.iter().any(|found| found.severity == onescan_iec::Severity::Error) {
        return Vec::new();
    }
    let mut finder = Finder { file, found: Vec::new(), line: 1, later: BTreeSet::new() };
    for declaration in &parsed.unit.declarations {
        finder.declaration(declaration);
    }
    let mut found = finder.found;
    found.sort_by_key(|mutant| (mutant.range.start, mutant.range.end));
    found.dedup_by(|one, other| one.range == other.range && one.replacement == other.replacement);
    found
}

impl Mutant {
    /// The file with this mistake in it.
    #[must_use]
    pub fn applied_to(&self, input: &Input) -> Input {
        input.with_replaced(self.range.clone(), &self.replacement)
    }
}

struct Finder<'a> {
    file: &'a SourceFile,
    found: Vec<Mutant>,
    /// Of the statement at which it is.
    line: u32,
    /// Where conditions begin that stand behind statements of their own: of ELSIF and UNTIL.
    later: BTreeSet<u32>,
}

impl Finder<'_> {
    fn declaration(&mut self, declaration: &Declaration) {
        match declaration {
            Declaration::Pou(pou) => self.unit(pou),
            Declaration::Globals(section) => self.section(section),
            Declaration::Namespace(namespace) => {
                for inner in &namespace.declarations {
                    self.declaration(inner);
                }
            }
            Declaration::Type(_) | Declaration::Using(_) | Declaration::Configuration(_) => {}
        }
    }

    fn unit(&mut self, pou: &Pou) {
        if pou.external {
            return;
        }
        for section in &pou.sections {
            self.section(section);
        }
        walk::unit(pou, self);
        for member in &pou.object.members {
            self.unit(&member.pou);
        }
    }

    fn section(&mut self, section: &Section) {
        for variable in &section.variables {
            if let TypeSpecKind::Name(name) = &variable.spec.kind
                && let Some(other) = twin(&name.key())
            {
                self.at(name.span);
                self.add(MutantKind::Timer, name.span, other);
            }
            if let Some(Initialiser { kind: InitialiserKind::Value(value), .. }) = &variable.initial {
                self.at(value.span);
                walk::Visitor::expression(self, value);
            }
        }
    }

    /// What follows belongs to the statement there.
    fn at(&mut self, span: Span) {
        self.line = self.file.line_column(span.start).line;
    }

    fn text(&self, span: Span) -> &str {
        self.file.text().get(span.start as usize..span.end as usize).unwrap_or_default()
    }

    fn add(&mut self, kind: MutantKind, span: Span, replacement: impl Into<String>) {
        let (was, replacement) = (self.text(span).to_owned(), replacement.into());
        if was.is_empty() || was == replacement {
            return;
        }
        let place = self.file.line_column(span.start);
        self.found.push(Mutant { kind, range: span.start..span.end, replacement, was, place, line: self.line });
    }

    /// The operator between two operands.
    fn operator(&mut self, left: Span, operator: BinaryOp, right: Span) {
        let between = Span::new(left.file, left.end, right.start);
        let tokens = tokenize_in(self.file.dialect(), self.text(between));
        // Brackets around the operands stand between them, too; they are not operators.
        let to_text = |start: u32, end: u32| {
            self.text(Span::new(left.file, left.end + start, left.end + end)).to_ascii_uppercase()
        };
        let names = |text: &str| text == operator.text() || operator == BinaryOp::And && text == "&";
        let is_blank = |kind| matches!(kind, TokenKind::Whitespace | TokenKind::BlockComment | TokenKind::LineComment);
        let token = tokens.iter().find(|token| !is_blank(token.kind) && names(&to_text(token.start, token.end)));
        let Some(token) = token else { return };
        let span = Span::new(left.file, left.end + token.start, left.end + token.end);
        for other in others(operator) {
            self.add(MutantKind::Operator, span, other.text());
        }
    }

    fn negated(&mut self, condition: &Expr) {
        let text = format!("NOT ({})", self.text(condition.span));
        self.at(condition.span);
        self.add(MutantKind::Condition, condition.span, text);
    }

    fn literal(&mut self, literal: &Literal, span: Span) {
        let replacement = match literal {
            Literal::Bool(value) => if *value { "FALSE" } else { "TRUE" }.to_owned(),
            Literal::Integer(number) => number.saturating_add(1).to_string(),
            Literal::Real(number) if *number == 0.0 => "1.0".to_owned(),
            Literal::Real(_) => format!("(2.0 * {})", self.text(span)),
            Literal::Duration { long: false, ns } if *ns % 500_000 == 0 => {
                format!("T#{}ms", (ns / 500_000).max(1))
            }
            Literal::Duration { ns, .. } => format!("LTIME#{}ns", ns.saturating_mul(2).max(1)),
            Literal::Typed { .. } | Literal::LongDuration(_) | Literal::Calendar { .. } | Literal::String(_) => return,
        };
        self.add(MutantKind::Constant, span, replacement);
    }
}

impl walk::Visitor for Finder<'_> {
    fn statement(&mut self, statement: &Statement) {
        self.at(statement.span);
        match &statement.kind {
            StatementKind::Assign(..)
            | StatementKind::Chain(..)
            | StatementKind::Update(..)
            | StatementKind::SetReset(..)
            | StatementKind::Call(Call { .. }) => self.add(MutantKind::Statement, statement.span, ""),
            StatementKind::If(IfStatement { branches, .. }) => {
                self.later.extend(branches.iter().skip(1).map(|branch| branch.condition.span.start));
                for branch in branches {
                    self.negated(&branch.condition);
                }
                self.at(statement.span);
            }
            StatementKind::While(each) => self.negated(&each.condition),
            StatementKind::Repeat(each) => {
                self.later.insert(each.until.span.start);
                self.negated(&each.until);
            }
            _ => {}
        }
    }

    fn expression(&mut self, expr: &Expr) {
        if self.later.contains(&expr.span.start) {
            self.at(expr.span);
        }
        match &expr.kind {
            ExprKind::Literal(literal) => self.literal(literal, expr.span),
            ExprKind::Unary(UnaryOp::Not | UnaryOp::Negate, operand) => {
                let operand = self.text(operand.span).to_owned();
                self.add(MutantKind::Operator, expr.span, operand);
            }
            ExprKind::Binary(operator, left, right) => self.operator(left.span, *operator, right.span),
            ExprKind::Chain(first, links) => {
                let mut left = first.span;
                for link in links {
                    self.operator(left, link.operator, link.operand.span);
                    left = link.operand.span;
                }
            }
            _ => {}
        }
    }
}

/// The operators that are mistaken for one.
fn others(operator: BinaryOp) -> &'static [BinaryOp] {
    use BinaryOp as B;
    match operator {
        B::Add => &[B::Subtract],
        B::Subtract => &[B::Add],
        B::Multiply => &[B::Divide],
        B::Divide | B::Modulo => &[B::Multiply],
        B::Power => &[],
        B::Less => &[B::LessEqual, B::GreaterEqual],
        B::LessEqual => &[B::Less, B::Greater],
        B::Greater => &[B::GreaterEqual, B::LessEqual],
        B::GreaterEqual => &[B::Greater, B::Less],
        B::Equal => &[B::NotEqual],
        B::NotEqual => &[B::Equal],
        B::And => &[B::Or],
        B::Or | B::Xor => &[B::And],
        B::AndThen => &[B::OrElse],
        B::OrElse => &[B::AndThen],
    }
}

/// The standard block that is mistaken for one.
fn twin(name: &str) -> Option<&'static str> {
    Some(match name {
        "TON" | "TP" => "TOF",
        "TOF" => "TON",
        "R_TRIG" => "F_TRIG",
        "F_TRIG" => "R_TRIG",
        "RS" => "SR",
        "SR" => "RS",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use onescan_iec::input::kind::SourceKind;

    const PROGRAM: &str = "PROGRAM Main
VAR
    delay : TON;
    limit : INT := 3;
    on, off : BOOL;
END_VAR
    delay(IN := on AND NOT off, PT := T#1.5s);
    IF (limit + 1) <= 4 (* <= *) OR off THEN
        on := TRUE;
    ELSIF limit > 9 THEN
        off := TRUE;
    END_IF;
    limit := limit * 2 - 1;
END_PROGRAM
";

    #[test]
    fn each_small_mistake_is_found_with_its_place() {
        let input = Input::from_text("main.st", SourceKind::Text, PROGRAM);
        let all = mutants(input.file());
        let reported = |mutant: &Mutant| {
            let LineColumn { line, column } = mutant.place;
            format!("{line}:{column} {} (line {}): {mutant}\n", mutant.kind.word(), mutant.line)
        };
        insta::assert_snapshot!(all.iter().map(reported).collect::<String>());
    }

    /// A mutant parses, and is the text with one part replaced.
    #[test]
    fn a_mutant_is_a_program() {
        let input = Input::from_text("main.st", SourceKind::Text, PROGRAM);
        for mutant in mutants(input.file()) {
            let changed = mutant.applied_to(&input);
            assert!(parse_source(FileId(0), changed.file()).diagnostics.is_empty(), "{mutant}");
            let (start, end) = (mutant.range.start as usize, mutant.range.end as usize);
            let expected = format!("{}{}{}", &PROGRAM[..start], mutant.replacement, &PROGRAM[end..]);
            assert_eq!(&**changed.file().text(), expected);
        }
    }

    #[test]
    fn text_that_is_wrong_has_none() {
        assert!(
            mutants(Input::from_text("m.st", SourceKind::Text, "PROGRAM Main a := ; END_PROGRAM").file()).is_empty()
        );
    }
}
