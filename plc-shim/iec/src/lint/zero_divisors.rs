//! W0720: a division by 0 stops the PLC each time that it is reached.

use super::bodies::Bodies;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::walk::{self, Visitor};
use crate::ir::{Binary, Expr, ExprKind, Value};

pub(super) fn lint(bodies: &Bodies<'_>, findings: &mut Vec<Diagnostic>) {
    for body in bodies.iter() {
        walk::statements(&body.checked.body, &mut Divisions { bodies, depth: 0, findings });
    }
}

struct Divisions<'a, 'f> {
    bodies: &'a Bodies<'a>,
    /// A constant may be 0 where a condition asks for it before.
    depth: u32,
    findings: &'f mut Vec<Diagnostic>,
}

impl Visitor for Divisions<'_, '_> {
    fn enter(&mut self) {
        self.depth += 1;
    }

    fn leave(&mut self) {
        self.depth -= 1;
    }

    fn expression(&mut self, expr: &Expr) {
        let ExprKind::Binary(operator, _, divisor) = &expr.kind else { return };
        let message = match operator {
            Binary::Divide => "this divides by 0, which stops the PLC",
            Binary::DivideAnyway => {
                "this divides by 0: the result is 0 for integers, and infinite or no number for reals"
            }
            Binary::Modulo => "the remainder of a division by 0 is 0, whatever is divided",
            _ => return,
        };
        let value = self.bodies.literal(divisor).or_else(|| {
            let anywhere = self.bodies.constant(divisor);
            anywhere.filter(|_| self.depth == 0)
        });
        if value.is_some_and(is_zero) {
            let found = Diagnostic::warning(Code::ZeroDivisor, divisor.span, message);
            self.findings
                .push(found.with_help("write the divisor that you mean, or a variable that you compare with 0 before"));
        }
    }
}

fn is_zero(value: Value) -> bool {
    value.as_f64() == 0.0
}
