//! Expressions (2nd ed. 3.3.1).

pub(super) mod calendar;
mod chain;
pub(super) mod constant;
pub(super) mod convert;
pub(super) mod dialect;
pub(super) mod dtl;
pub(super) mod enumeration;
pub(super) mod limit;
mod loss;
pub(super) mod operator;
mod register;

use super::Body;
use crate::check::types::operand::{Operand, constant};
use crate::diagnostic::{Code, Diagnostic, did_you_mean};
use crate::ir::{ElementaryType, Expr, ExprKind, TypeId, Value};
use crate::syntax::Span;
use crate::syntax::ast::{self, BinaryOp, Literal, TypedValue};
use crate::syntax::calendar::CalendarKind;

impl Body<'_, '_> {
    /// The meaning of an expression, or nothing after a report.
    pub(super) fn expression(&mut self, expr: &ast::Expr) -> Option<Operand> {
        match &expr.kind {
            ast::ExprKind::Literal(literal) => self.literal(literal, expr.span),
            ast::ExprKind::Paren(inner) => Some(self.expression(inner)?.with_span(expr.span)),
            ast::ExprKind::Unary(operator, operand) => {
                let operand = self.expression(operand)?;
                self.unary(*operator, operand, expr.span)
            }
            ast::ExprKind::Binary(operator @ (BinaryOp::AndThen | BinaryOp::OrElse), left, right) => {
                self.short_circuit(*operator, left, right, expr.span)
            }
            ast::ExprKind::Binary(operator, left, right) => {
                // What a comparison compares has nothing to do with where its result goes.
                let context = self.context.filter(|_| !operator.is_comparison());
                let (left, right) = self.within(context, |body| match operator {
                    BinaryOp::Equal | BinaryOp::NotEqual => body.both_compared(left, right),
                    _ => body.both_operands(left, right),
                });
                self.binary(*operator, left?, right?, expr.span)
            }
            ast::ExprKind::Chain(first, links) => self.row_of_operators(first, links, expr.span),
            ast::ExprKind::Call(call) => {
                let result = self.call_expression(call, expr.span)?;
                Some(self.referred_result(result))
            }
            ast::ExprKind::Name(name) if self.is_this(name) && !expr.names_the_object_by_caret() => {
                match self.this_pointer(name) {
                    Some(pointer) => Some(pointer),
                    None => self.load(expr),
                }
            }
            ast::ExprKind::Name(_)
            | ast::ExprKind::Member(..)
            | ast::ExprKind::Index(..)
            | ast::ExprKind::Part(..)
            | ast::ExprKind::Dereference(_)
            | ast::ExprKind::DirectAddress(_) => self.load(expr),
            ast::ExprKind::Assign(target, value) => {
                let done = self.within(None, |body| body.assign(target, value, expr.span))?;
                let found = self.load(target)?;
                let value = self.settle(found)?;
                let ty = value.ty;
                let kind = ExprKind::After(vec![done], Some(Box::new(value)));
                Some(Operand::Typed(Expr { kind, ty, span: expr.span }))
            }
            ast::ExprKind::Type(_) => {
                let message = "this is a type, a value is wanted";
                self.report(Diagnostic::error(Code::NotAVariable, expr.span, message));
                None
            }
            ast::ExprKind::Error => None,
        }
    }

    fn literal(&mut self, literal: &Literal, span: Span) -> Option<Operand> {
        Some(match literal {
            Literal::Bool(value) => Operand::Typed(constant(Value::Bool(*value), ElementaryType::Bool, span)),
            Literal::Integer(value) => Operand::Integer { value: *value, span },
            Literal::Real(value) => Operand::Real { value: *value, span },
            Literal::Duration { long, ns } => {
                let ty = if *long { ElementaryType::Ltime } else { ElementaryType::Time };
                self.check_duration(ty, *ns, span)?;
                Operand::Typed(constant(Value::Int(i128::from(*ns)), ty, span))
            }
            Literal::LongDuration(ns) => return self.long_duration(*ns, span),
            Literal::Calendar { kind: CalendarKind::Parts, ns, .. } => return self.dtl_literal(*ns, span),
            Literal::Calendar { kind, long, ns, .. } => {
                let value = Value::Int(i128::from(*ns));
                Operand::Typed(constant(value, calendar_type(*kind, *long), span))
            }
            Literal::Typed { prefix, value } => return self.typed_literal(prefix, value, span),
            Literal::String(text) => return self.text_literal(text, span),
        })
    }

    fn typed_literal(&mut self, prefix: &str, value: &TypedValue, span: Span) -> Option<Operand> {
        if let TypedValue::Text(text) = value {
            return self.typed_text(prefix, text, span);
        }
        if let Some(ty) = ElementaryType::find(prefix) {
            let operand = match value {
                TypedValue::Integer(value) => Operand::Integer { value: *value, span },
                TypedValue::Real(value) => Operand::Real { value: *value, span },
                TypedValue::Name(name) if ty == ElementaryType::Bool => {
                    let value = name.eq_ignore_ascii_case("TRUE");
                    if !value && !name.eq_ignore_ascii_case("FALSE") {
                        return self.malformed_literal(prefix, name, span);
                    }
                    Operand::Integer { value: i128::from(value), span }
                }
                TypedValue::Name(name) | TypedValue::Text(name) => return self.malformed_literal(prefix, name, span),
            };
            return Some(Operand::Typed(self.coerce(operand, ty.into())?));
        }
        let Some(key) = self.declarations.type_key(&prefix.to_ascii_uppercase()) else {
            let names = self.declarations.type_names();
            let help = did_you_mean(prefix, names);
            let message = format!("type `{prefix}` is not declared");
            let found = Diagnostic::error(Code::UnknownType, span, message);
            self.report(found.with_optional_help(help));
            return None;
        };
        let ty = self.declarations.named_type(&key, Some(span))?.ty;
        let operand = match value {
            TypedValue::Name(name) | TypedValue::Text(name) => return self.enumerator_of(ty, name, span),
            TypedValue::Integer(value) => Operand::Integer { value: *value, span },
            TypedValue::Real(value) => Operand::Real { value: *value, span },
        };
        let typed = self.coerce(operand, ty)?;
        Some(Operand::Typed(Expr { ty: self.declarations.types().of_value(ty), ..typed }))
    }

    pub(super) fn malformed_literal(&mut self, prefix: &str, value: &str, span: Span) -> Option<Operand> {
        let message = format!("`{value}` is not a value of {}", prefix.to_ascii_uppercase());
        self.report(Diagnostic::error(Code::InvalidLiteral, span, message));
        None
    }

    /// The value `name` of the enumeration `ty`.
    pub(super) fn enumerator_of(&mut self, ty: TypeId, name: &str, span: Span) -> Option<Operand> {
        let values = match self.declarations.types().get(ty) {
            crate::ir::Type::Enumeration { values, .. } => values.clone(),
            _ => Vec::new(),
        };
        if let Some((_, value)) = values.iter().find(|(known, _)| known.eq_ignore_ascii_case(name)) {
            return Some(Operand::Typed(enumeration_value(ty, *value, span)));
        }
        let message = format!("{} has no value `{name}`", self.type_name(ty));
        let help = did_you_mean(name, values.iter().map(|(known, _)| known.as_str()));
        let found = Diagnostic::error(Code::UnknownMember, span, message);
        self.report(found.with_optional_help(help));
        None
    }
}

fn calendar_type(kind: CalendarKind, long: bool) -> ElementaryType {
    match (kind, long) {
        (CalendarKind::Date, false) => ElementaryType::Date,
        (CalendarKind::Date, true) => ElementaryType::Ldate,
        (CalendarKind::TimeOfDay, false) => ElementaryType::Tod,
        (CalendarKind::TimeOfDay, true) => ElementaryType::Ltod,
        (CalendarKind::DateAndTime, false) => ElementaryType::Dt,
        (CalendarKind::DateAndTime | CalendarKind::Parts, _) => ElementaryType::Ldt,
    }
}

pub(super) fn enumeration_value(ty: TypeId, value: i128, span: Span) -> Expr {
    Expr { kind: ExprKind::Constant(Value::Int(value)), ty, span }
}
