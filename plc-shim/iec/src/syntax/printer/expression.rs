//! Expressions to text.

use super::Printer;
use crate::syntax::ast::{Argument, BinaryOp, Call, Expr, ExprKind, Literal, TypedValue, UnaryOp};

impl Printer {
    pub(super) fn expression(&mut self, expr: &Expr) {
        match &expr.kind {
            ExprKind::Literal(literal) => self.literal(literal),
            ExprKind::Name(name) => {
                self.variable_name(name);
                if expr.names_the_object_by_caret() {
                    self.word("^");
                }
            }
            ExprKind::DirectAddress(text) => self.word(text),
            ExprKind::Member(base, name) => {
                self.expression(base);
                self.word(".");
                self.name(name);
            }
            ExprKind::Part(base, part) => {
                self.expression(base);
                self.word(".");
                self.word(&part.text);
            }
            ExprKind::Dereference(base) => {
                self.expression(base);
                // The first caret is part of the name.
                let is_short = base.names_the_object() && !base.names_the_object_by_caret();
                self.word(if is_short { "^^" } else { "^" });
            }
            ExprKind::Index(base, indices) => {
                self.expression(base);
                self.word("[");
                self.separated(indices, Self::expression);
                self.word("]");
            }
            ExprKind::Call(call) => self.call(call),
            ExprKind::Unary(operator, operand) => {
                self.word(match operator {
                    UnaryOp::Negate => "-",
                    UnaryOp::Plus => "+",
                    UnaryOp::Not => "NOT ",
                });
                self.operand_of(operand, |kind| matches!(kind, ExprKind::Binary(BinaryOp::Power, ..)));
            }
            ExprKind::Binary(operator, left, right) => {
                let is_sign = |kind: &ExprKind| matches!(kind, ExprKind::Unary(..));
                self.operand_of(left, |kind| *operator == BinaryOp::Power && is_sign(kind));
                self.word(" ");
                self.word(operator.text());
                self.word(" ");
                self.expression(right);
            }
            ExprKind::Chain(first, links) => {
                self.expression(first);
                for link in links {
                    self.word(" ");
                    self.word(link.operator.text());
                    self.word(" ");
                    self.expression(&link.operand);
                }
            }
            ExprKind::Paren(inner) => {
                self.word("(");
                self.expression(inner);
                self.word(")");
            }
            ExprKind::Assign(target, value) => {
                self.expression(target);
                self.word(" := ");
                self.expression(value);
            }
            ExprKind::Type(spec) => self.type_spec(spec),
            ExprKind::Error => {}
        }
    }

    /// Between parentheses what a sign and `**` make of it depends on the dialect.
    fn operand_of(&mut self, operand: &Expr, is_ambiguous: impl Fn(&ExprKind) -> bool) {
        if !is_ambiguous(&operand.kind) {
            return self.expression(operand);
        }
        self.word("(");
        self.expression(operand);
        self.word(")");
    }

    pub(super) fn call(&mut self, call: &Call) {
        self.expression(&call.callee);
        self.arguments(&call.arguments);
    }

    /// `(x, IN := y)`
    pub(super) fn arguments(&mut self, arguments: &[Argument]) {
        self.word("(");
        self.separated(arguments, Self::argument);
        self.word(")");
    }

    pub(super) fn argument(&mut self, argument: &Argument) {
        match argument {
            Argument::Positional(expr) => self.expression(expr),
            Argument::Input(name, expr) => {
                self.name(name);
                self.word(" := ");
                self.expression(expr);
            }
            Argument::Output { name, negated, target } => {
                if *negated {
                    self.word("NOT ");
                }
                self.name(name);
                self.word(" => ");
                if let Some(target) = target {
                    self.expression(target);
                }
            }
        }
    }

    fn literal(&mut self, literal: &Literal) {
        let text = match literal {
            Literal::Bool(true) => "TRUE".to_owned(),
            Literal::Bool(false) => "FALSE".to_owned(),
            Literal::Integer(value) => value.to_string(),
            // The shortest text that reads back to the same number, always with `.` or `e`.
            Literal::Real(value) => format!("{value:?}"),
            Literal::Typed { prefix, value } => match value {
                TypedValue::Integer(value) => format!("{prefix}#{value}"),
                TypedValue::Real(value) => format!("{prefix}#{value:?}"),
                TypedValue::Name(name) | TypedValue::Text(name) => format!("{prefix}#{name}"),
            },
            Literal::Duration { long, ns } => {
                let (prefix, sign) = (if *long { "LT" } else { "T" }, if *ns < 0 { "-" } else { "" });
                format!("{prefix}#{sign}{}ns", ns.unsigned_abs())
            }
            Literal::LongDuration(ns) => format!("LT#{ns}ns"),
            Literal::String(text) | Literal::Calendar { text, .. } => text.clone(),
        };
        self.word(&text);
    }
}
