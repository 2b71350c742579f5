//! W0724: a comparison that the range of a type decides. W0727: a condition that is TRUE or FALSE as written.

use super::bodies::Bodies;
use super::endless::literal;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{Binary, ElementaryType, Expr, ExprKind, Value};
use crate::syntax::ast::{self, StatementKind};
use crate::syntax::walk::{self, Visitor};

/// Comparisons with a number that no value of a type reaches, or that all reach.
pub(super) fn lint_comparisons(bodies: &Bodies<'_>, findings: &mut Vec<Diagnostic>) {
    for body in bodies.iter() {
        crate::ir::walk::statements(&body.checked.body, &mut Comparisons { bodies, findings });
    }
}

struct Comparisons<'a, 'f> {
    bodies: &'a Bodies<'a>,
    findings: &'f mut Vec<Diagnostic>,
}

/// The values of a type that is read as it is.
struct Range {
    ty: ElementaryType,
    low: i128,
    high: i128,
}

impl crate::ir::walk::Visitor for Comparisons<'_, '_> {
    fn expression(&mut self, expr: &Expr) {
        let ExprKind::Binary(operator, left, right) = &expr.kind else { return };
        let number = |side| self.bodies.literal(side).and_then(Value::as_int);
        let decided = match (self.range(left), number(right), number(left), self.range(right)) {
            (Some(range), Some(number), ..) => decided(*operator, &range, number).map(|holds| (range, holds)),
            (_, _, Some(number), Some(range)) => decided(turned(*operator), &range, number).map(|holds| (range, holds)),
            _ => None,
        };
        if let Some((Range { ty, low, high }, holds)) = decided {
            let always = if holds { "TRUE" } else { "FALSE" };
            let message = format!("this is always {always}: {ty} has the values {low} to {high}");
            let found = Diagnostic::warning(Code::DecidedComparison, expr.span, message);
            self.findings.push(
                found.with_help("compare with a number inside of them, or declare the variable with another type"),
            );
        }
    }
}

impl Comparisons<'_, '_> {
    /// The values that a variable, or an unsigned result, can have, whatever it is compared as.
    fn range(&self, expr: &Expr) -> Option<Range> {
        match &expr.kind {
            ExprKind::Load(_) => {
                let ty = self.bodies.types().elementary(expr.ty)?;
                let counts = ty.is_integer() || ty.is_bits() && ty != ElementaryType::Bool;
                let is_plain = !matches!(self.bodies.types().get(expr.ty), crate::ir::Type::Enumeration { .. });
                let (low, high) = ty.range().filter(|_| counts && is_plain)?;
                Some(Range { ty, low, high })
            }
            // What is computed of unsigned numbers has no sign either.
            ExprKind::Binary(Binary::Add | Binary::Subtract | Binary::Multiply, ..) => {
                let ty = self.bodies.types().elementary(expr.ty)?;
                let counts = !ty.is_signed() && ty.is_integer() || ty.is_bits() && ty != ElementaryType::Bool;
                let (low, high) = ty.range().filter(|_| counts)?;
                Some(Range { ty, low, high })
            }
            ExprKind::Convert(_, operand) => {
                let wide = self.bodies.types().elementary(expr.ty)?;
                let (least, most) = wide.range().filter(|_| wide.is_integer() || wide.is_bits())?;
                self.range(operand).filter(|range| least <= range.low && range.high <= most)
            }
            _ => None,
        }
    }
}

/// What a comparison of every value of a range with a number gives, if that is always the same.
fn decided(operator: Binary, range: &Range, number: i128) -> Option<bool> {
    let (low, high) = (range.low, range.high);
    match operator {
        Binary::Equal | Binary::NotEqual => (number < low || number > high).then_some(operator == Binary::NotEqual),
        Binary::Less => same(low < number, high < number),
        Binary::LessEqual => same(low <= number, high <= number),
        Binary::Greater => same(low > number, high > number),
        Binary::GreaterEqual => same(low >= number, high >= number),
        _ => None,
    }
}

fn same(at_low: bool, at_high: bool) -> Option<bool> {
    (at_low == at_high).then_some(at_low)
}

/// The comparison with its sides exchanged.
fn turned(operator: Binary) -> Binary {
    match operator {
        Binary::Less => Binary::Greater,
        Binary::LessEqual => Binary::GreaterEqual,
        Binary::Greater => Binary::Less,
        Binary::GreaterEqual => Binary::LessEqual,
        same => same,
    }
}

/// Conditions of IF and WHILE that are `TRUE`, `FALSE`, the opposite of one of them, or a comparison of two numbers.
pub(super) fn lint_conditions(unit: &super::Unit<'_>, findings: &mut Vec<Diagnostic>) {
    walk::unit(unit.pou, &mut Conditions { findings });
}

struct Conditions<'f> {
    findings: &'f mut Vec<Diagnostic>,
}

impl Conditions<'_> {
    fn condition(&mut self, condition: &ast::Expr, holds: bool) {
        let (message, help) = if holds {
            (
                "this condition is always TRUE",
                "leave it out: its statements run in every case, what is behind ELSE never does",
            )
        } else {
            (
                "this condition is always FALSE, so its statements never run",
                "delete them, or write the condition that you mean",
            )
        };
        self.findings.push(Diagnostic::warning(Code::ConstantCondition, condition.span, message).with_help(help));
    }
}

impl Visitor for Conditions<'_> {
    fn statement(&mut self, statement: &ast::Statement) {
        match &statement.kind {
            StatementKind::If(inner) => {
                for branch in &inner.branches {
                    if let Some(holds) = literal(&branch.condition) {
                        self.condition(&branch.condition, holds);
                    }
                }
            }
            // `WHILE TRUE` is a loop that EXIT leaves.
            StatementKind::While(inner) if literal(&inner.condition) == Some(false) => {
                self.condition(&inner.condition, false);
            }
            // REPEAT .. UNTIL TRUE runs once, as its author says; others have no condition.
            _ => {}
        }
    }
}
