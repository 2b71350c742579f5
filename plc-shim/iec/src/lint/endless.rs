//! W0709: `WHILE TRUE` and `REPEAT .. UNTIL FALSE` that nothing leaves. A scan ends only if all loops do.

use std::cmp::Ordering;

use super::Unit;
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::Span;
use crate::syntax::ast::{BinaryOp, Expr, ExprKind, Instruction, Literal, Statement, StatementKind, UnaryOp};
use crate::syntax::walk::{self, Visitor};

pub(super) fn lint(unit: &Unit<'_>, findings: &mut Vec<Diagnostic>) {
    walk::unit(unit.pou, &mut Loops { findings });
}

struct Loops<'f> {
    findings: &'f mut Vec<Diagnostic>,
}

impl Visitor for Loops<'_> {
    fn statement(&mut self, statement: &Statement) {
        let (condition, body) = match &statement.kind {
            StatementKind::While(inner) if literal(&inner.condition) == Some(true) => (&inner.condition, &inner.body),
            StatementKind::Repeat(inner) if literal(&inner.until) == Some(false) => (&inner.until, &inner.body),
            _ => return,
        };
        if !is_left(body, Inside::Itself) {
            self.report(condition.span);
        }
    }
}

impl Loops<'_> {
    fn report(&mut self, span: Span) {
        let found = Diagnostic::warning(Code::EndlessLoop, span, "nothing leaves this loop, so the scan never ends");
        let help = "a program is called again in every cycle: write what it does once in a cycle, or leave with EXIT";
        self.findings.push(found.with_help(help));
    }
}

/// The value of `TRUE`, `(FALSE)`, `NOT TRUE`.
pub(super) fn literal(condition: &Expr) -> Option<bool> {
    match &condition.kind {
        ExprKind::Literal(Literal::Bool(value)) => Some(*value),
        ExprKind::Paren(inner) => literal(inner),
        ExprKind::Unary(UnaryOp::Not, inner) => literal(inner).map(|value| !value),
        ExprKind::Binary(operator, left, right) => compared(*operator, integer(left)?.cmp(&integer(right)?)),
        _ => None,
    }
}

fn integer(expr: &Expr) -> Option<i128> {
    match &expr.kind {
        ExprKind::Literal(Literal::Integer(value)) => Some(*value),
        ExprKind::Paren(inner) => integer(inner),
        _ => None,
    }
}

fn compared(operator: BinaryOp, order: Ordering) -> Option<bool> {
    Some(match operator {
        BinaryOp::Equal => order.is_eq(),
        BinaryOp::NotEqual => order.is_ne(),
        BinaryOp::Less => order.is_lt(),
        BinaryOp::LessEqual => order.is_le(),
        BinaryOp::Greater => order.is_gt(),
        BinaryOp::GreaterEqual => order.is_ge(),
        _ => return None,
    })
}

/// Whose `EXIT` is met.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Inside {
    Itself,
    AnotherLoop,
}

/// True if a statement of the list may leave the loop. A jump may lead anywhere.
fn is_left(list: &[Statement], inside: Inside) -> bool {
    list.iter().any(|statement| match &statement.kind {
        StatementKind::Exit => inside == Inside::Itself,
        // What is wrong has been reported, and may have been meant to leave.
        StatementKind::Return | StatementKind::Jump(_) | StatementKind::Error => true,
        StatementKind::Instruction(inner) => matches!(**inner, Instruction::Jump(..) | Instruction::Return(_)),
        StatementKind::If(inner) => {
            inner.branches.iter().any(|branch| is_left(&branch.body, inside)) || is_left(&inner.otherwise, inside)
        }
        StatementKind::Case(inner) => {
            inner.branches.iter().any(|branch| is_left(&branch.body, inside)) || is_left(&inner.otherwise, inside)
        }
        StatementKind::Try(inner) => {
            [&inner.body, &inner.handler, &inner.finally].into_iter().any(|list| is_left(list, inside))
        }
        StatementKind::For(inner) => is_left(&inner.body, Inside::AnotherLoop),
        StatementKind::While(inner) => is_left(&inner.body, Inside::AnotherLoop),
        StatementKind::Repeat(inner) => is_left(&inner.body, Inside::AnotherLoop),
        _ => false,
    })
}
