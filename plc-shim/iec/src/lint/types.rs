//! The type of an expression, as far as a warning needs it: is it a real number?

use super::index::Index;
use crate::ir::ElementaryType;
use crate::syntax::ast::{Call, Expr, ExprKind, Literal, Pou, SectionKind, TypeSpec, TypeSpecKind, TypedValue};

/// True if the expression is known to be REAL or LREAL.
pub(super) fn is_real(expr: &Expr, pou: &Pou, index: &Index<'_>) -> bool {
    match &expr.kind {
        ExprKind::Literal(literal) => is_real_literal(literal),
        ExprKind::Paren(inner) | ExprKind::Unary(_, inner) => is_real(inner, pou, index),
        ExprKind::Binary(operator, left, right) => {
            !operator.is_comparison() && (is_real(left, pou, index) || is_real(right, pou, index))
        }
        ExprKind::Chain(first, links) => {
            let any = || links.iter().any(|link| is_real(&link.operand, pou, index));
            !links.iter().any(|link| link.operator.is_comparison()) && (is_real(first, pou, index) || any())
        }
        ExprKind::Call(call) => gives_real(call, pou, index),
        _ => spec_of(expr, pou, index).is_some_and(|spec| is_real_spec(spec, index)),
    }
}

fn is_real_literal(literal: &Literal) -> bool {
    match literal {
        Literal::Real(_) => true,
        Literal::Typed { prefix, value } => matches!(value, TypedValue::Real(_)) || is_real_name(prefix),
        _ => false,
    }
}

fn is_real_name(name: &str) -> bool {
    ElementaryType::find(name).is_some_and(ElementaryType::is_real)
}

fn is_real_spec<'a>(spec: &'a TypeSpec, index: &Index<'a>) -> bool {
    matches!(&index.resolved(spec).kind, TypeSpecKind::Name(name) if is_real_name(&name.text))
}

/// By the result that a user's function declares, or a standard function's name promises.
fn gives_real(call: &Call, pou: &Pou, index: &Index<'_>) -> bool {
    let ExprKind::Name(name) = &call.callee.kind else { return false };
    let key = name.key();
    if let Some(function) = index.unit(&key) {
        return function.result.as_ref().is_some_and(|spec| is_real_spec(spec, index));
    }
    match key.rsplit_once("TO_") {
        Some((_, to)) => is_real_name(to),
        None => match key.as_str() {
            "SQRT" | "LN" | "LOG" | "EXP" | "SIN" | "COS" | "TAN" | "ASIN" | "ACOS" | "ATAN" | "EXPT" => true,
            "ABS" | "MAX" | "MIN" | "LIMIT" | "ADD" | "SUB" | "MUL" | "DIV" => {
                call.arguments.iter().any(|argument| match argument {
                    crate::syntax::ast::Argument::Positional(value) | crate::syntax::ast::Argument::Input(_, value) => {
                        is_real(value, pou, index)
                    }
                    crate::syntax::ast::Argument::Output { .. } => false,
                })
            }
            _ => false,
        },
    }
}

/// The declared type of a place.
fn spec_of<'a>(expr: &Expr, pou: &'a Pou, index: &Index<'a>) -> Option<&'a TypeSpec> {
    match &expr.kind {
        ExprKind::Name(name) => {
            let key = name.key();
            if let Some((_, variable)) = index.declared(pou, &key) {
                return Some(&variable.spec);
            }
            match pou.result.as_ref().filter(|_| pou.name.key() == key) {
                Some(result) => Some(result),
                None => index.global(&key).map(|variable| &variable.spec),
            }
        }
        ExprKind::Paren(inner) => spec_of(inner, pou, index),
        ExprKind::Dereference(inner) => match &index.resolved(spec_of(inner, pou, index)?).kind {
            TypeSpecKind::Reference(_, target) => Some(target),
            _ => None,
        },
        ExprKind::Index(inner, _) => match &index.resolved(spec_of(inner, pou, index)?).kind {
            TypeSpecKind::Array(_, element) | TypeSpecKind::OpenArray(_, element) => Some(element),
            _ => None,
        },
        ExprKind::Member(inner, member) => {
            let (spec, key) = (index.resolved(spec_of(inner, pou, index)?), member.key());
            if matches!(spec.kind, TypeSpecKind::Struct(_) | TypeSpecKind::Overlapping(_) | TypeSpecKind::Union(_)) {
                return index.field(spec, &key);
            }
            let (section, variable) = index.declared(index.block(spec)?, &key)?;
            (section.kind != SectionKind::Temp).then_some(&variable.spec)
        }
        _ => None,
    }
}
