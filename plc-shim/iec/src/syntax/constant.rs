//! Constant expressions of tasks (2nd ed. 2.7.2), computed from the text: INTERVAL and PRIORITY.

use std::collections::BTreeMap;

use crate::syntax::ast::{
    BinaryOp, Expr, ExprKind, Initialiser, InitialiserKind, Literal, Qualifier, Section, UnaryOp,
};

/// The value of a constant expression.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Constant {
    Integer(i128),
    Duration(i128),
}

/// Global constants by name in capitals.
pub type Constants<'a> = BTreeMap<String, &'a Expr>;

/// Notes the constants that a section declares.
pub fn note<'a>(section: &'a Section, constants: &mut Constants<'a>) {
    if !section.qualifiers.contains(&Qualifier::Constant) {
        return;
    }
    for variable in &section.variables {
        if let Some(Initialiser { kind: InitialiserKind::Value(value), .. }) = &variable.initial {
            constants.extend(variable.names.iter().map(|name| (name.key(), value)));
        }
    }
}

/// How many constants may stand for each other.
const DEPTH_MAX: u32 = 32;

/// The value of `expr`; nothing if it has none that the text alone determines.
pub fn value(expr: &Expr, constants: &Constants<'_>) -> Option<Constant> {
    within(expr, constants, DEPTH_MAX)
}

fn within(expr: &Expr, constants: &Constants<'_>, depth: u32) -> Option<Constant> {
    match &expr.kind {
        ExprKind::Literal(Literal::Integer(value)) => Some(Constant::Integer(*value)),
        ExprKind::Literal(Literal::Duration { ns, .. }) => Some(Constant::Duration(i128::from(*ns))),
        ExprKind::Name(name) => within(constants.get(&name.key())?, constants, depth.checked_sub(1)?),
        ExprKind::Paren(inner) => within(inner, constants, depth),
        ExprKind::Unary(UnaryOp::Negate, inner) => match within(inner, constants, depth)? {
            Constant::Integer(value) => value.checked_neg().map(Constant::Integer),
            Constant::Duration(ns) => ns.checked_neg().map(Constant::Duration),
        },
        ExprKind::Binary(op, left, right) => {
            computed(*op, within(left, constants, depth)?, within(right, constants, depth)?)
        }
        ExprKind::Chain(first, links) => links.iter().try_fold(within(first, constants, depth)?, |left, link| {
            computed(link.operator, left, within(&link.operand, constants, depth)?)
        }),
        _ => None,
    }
}

/// What 2nd ed. Tables 24 and 30 have for these operands.
fn computed(op: BinaryOp, left: Constant, right: Constant) -> Option<Constant> {
    use Constant::{Duration, Integer};
    let (duration, left, right) = match (left, right) {
        (Integer(left), Integer(right)) => (false, left, right),
        (Duration(left), Duration(right)) if matches!(op, BinaryOp::Add | BinaryOp::Subtract) => (true, left, right),
        (Duration(left), Integer(right)) if matches!(op, BinaryOp::Multiply | BinaryOp::Divide) => (true, left, right),
        (Integer(left), Duration(right)) if op == BinaryOp::Multiply => (true, left, right),
        _ => return None,
    };
    let value = match op {
        BinaryOp::Add => left.checked_add(right),
        BinaryOp::Subtract => left.checked_sub(right),
        BinaryOp::Multiply => left.checked_mul(right),
        BinaryOp::Divide => left.checked_div(right),
        _ => None,
    }?;
    Some(if duration { Duration(value) } else { Integer(value) })
}
