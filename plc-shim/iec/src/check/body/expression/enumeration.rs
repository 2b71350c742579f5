//! Enumerations as integers and integers as enumerations, without conversion (CODESYS, TwinCAT).

use super::enumeration_value;
use crate::check::body::Body;
use crate::check::declare::Enumerator;
use crate::check::types::constant::fold;
use crate::check::types::operand::Operand;
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::Feature;
use crate::ir::{ElementaryType, Expr, ExprKind, Type, TypeId, Value};
use crate::syntax::{Span, ast};

impl Body<'_, '_> {
    pub(in crate::check::body) fn base_of_enumeration(&self, ty: TypeId, span: Span) -> Option<ElementaryType> {
        let Type::Enumeration { base, has_base, .. } = self.declarations.types().get(ty) else { return None };
        let dialect = self.declarations.dialect(span);
        let is_number = dialect.has(Feature::EnumerationsAsIntegers) || *has_base && dialect.has(Feature::NamedValues);
        is_number.then_some(*base)
    }

    /// Runs `check` where the place wants a value of this type, which separates values that several enumerations have.
    pub(in crate::check::body) fn wanting<T>(&mut self, ty: Option<TypeId>, check: impl FnOnce(&mut Self) -> T) -> T {
        let is_enumeration = |ty: &TypeId| matches!(self.declarations.types().get(*ty), Type::Enumeration { .. });
        let wanted = ty.filter(is_enumeration);
        let outer = std::mem::replace(&mut self.enumeration, wanted);
        let checked = check(self);
        self.enumeration = outer;
        checked
    }

    /// The value of this name that the place wants, of those that several enumerations have.
    pub(in crate::check::body) fn wanted_value(&self, several: &[Enumerator], span: Span) -> Option<Expr> {
        let wanted = self.enumeration.filter(|_| self.declarations.dialect(span).has(Feature::ValuesByContext))?;
        let found = several.iter().find(|value| value.ty == wanted)?;
        Some(enumeration_value(found.ty, found.value, span))
    }

    /// The value of this name that a declaration outside of units wants: the initial value of an enumeration is one of
    /// its own, even if these are known behind its name only (CODESYS, TwinCAT).
    pub(in crate::check::body) fn own_value(&self, name: &ast::Ident) -> Option<Expr> {
        let has = self.declarations.dialect(name.span).has(Feature::ValuesByContext);
        let wanted = self.enumeration.filter(|_| has && self.pou.is_none())?;
        let Type::Enumeration { values, .. } = self.declarations.types().get(wanted) else { return None };
        let (_, value) = values.iter().find(|(known, _)| known.eq_ignore_ascii_case(&name.text))?;
        Some(enumeration_value(wanted, *value, name.span))
    }

    /// Both operands of an operator; one may say of which enumeration the other is.
    pub(super) fn both_operands(&mut self, left: &ast::Expr, right: &ast::Expr) -> (Option<Operand>, Option<Operand>) {
        let type_of = |operand: &Option<Operand>| match operand {
            Some(Operand::Typed(expr)) => Some(expr.ty),
            _ => None,
        };
        if self.is_value_of_several(left) {
            let right = self.expression(right);
            return (self.wanting(type_of(&right), |body| body.expression(left)), right);
        }
        let left = self.expression(left);
        let wanted = type_of(&left);
        (left, self.wanting(wanted, |body| body.expression(right)))
    }

    /// The operands of `=` and `<>`: names of types may stand where the other side asks for one.
    pub(super) fn both_compared(&mut self, left: &ast::Expr, right: &ast::Expr) -> (Option<Operand>, Option<Operand>) {
        if let Some(named) = self.type_asked(left, right) {
            return (self.expression(left), named);
        }
        if let Some(named) = self.type_asked(right, left) {
            return (named, self.expression(right));
        }
        if let Some(address) = self.address_of_variant(left, right) {
            return self.both_operands(&address, right);
        }
        if let Some(address) = self.address_of_variant(right, left) {
            return self.both_operands(left, &address);
        }
        self.both_operands(left, right)
    }

    fn is_value_of_several(&self, expr: &ast::Expr) -> bool {
        let ast::ExprKind::Name(name) = &expr.kind else { return false };
        self.declarations.enumerators(&self.declarations.behind_libraries(name).key()).len() > 1
    }

    /// The number of an enumeration's value that a narrower type holds: a constant needs no more room than it takes.
    pub(super) fn value_as_number(&self, expr: &Expr, wanted: ElementaryType) -> Option<Expr> {
        self.base_of_enumeration(expr.ty, expr.span)?;
        let ExprKind::Constant(value) = &expr.kind else { return None };
        let number = value.as_int().filter(|number| wanted.wrap(*number) == *number)?;
        let is_number = wanted.is_integer() || wanted.is_bits() && wanted != ElementaryType::Bool;
        is_number.then(|| Expr { kind: ExprKind::Constant(Value::Int(number)), ty: wanted.into(), span: expr.span })
    }

    /// A value of an enumeration as its number, where the dialect has that; all else as it is.
    pub(in crate::check) fn as_number(&self, expr: Expr) -> Expr {
        match self.base_of_enumeration(expr.ty, expr.span) {
            Some(base) => Expr { ty: base.into(), ..expr },
            None => expr,
        }
    }

    /// Operands of one enumeration are compared as they are; else enumerations are their numbers.
    pub(super) fn as_numbers(&self, left: Operand, right: Operand, compared: bool) -> (Operand, Operand) {
        let alike = matches!((&left, &right), (Operand::Typed(left), Operand::Typed(right)) if left.ty == right.ty);
        if alike && compared {
            return (left, right);
        }
        let number = |operand| match operand {
            Operand::Typed(expr) => Operand::Typed(self.as_number(expr)),
            other => other,
        };
        (number(left), number(right))
    }

    /// The operand as a value of the enumeration `target`, where the dialect has that.
    pub(super) fn enumerated(&mut self, operand: Operand, target: TypeId) -> Result<Option<Expr>, Operand> {
        let Some(base) = self.base_of_enumeration(target, operand.span()) else { return Err(operand) };
        match operand {
            Operand::Typed(expr) if expr.ty == target => Ok(Some(expr)),
            Operand::Typed(_) | Operand::Integer { .. } => {
                let value = self.coerce(operand, base.into());
                Ok(value.map(|value| Expr { ty: target, ..value }))
            }
            other => Err(other),
        }
    }

    /// Reports what is assigned to an enumeration that is `strict` and does not take it; true if it is reported.
    pub(in crate::check::body) fn refuse_foreign_value(&mut self, operand: &Operand, target: TypeId) -> bool {
        let Type::Enumeration { name, values, is_strict: true, .. } = self.declarations.types().get(target) else {
            return false;
        };
        let number = match operand {
            Operand::Integer { value, .. } => Some(*value),
            Operand::Typed(expr) if expr.ty == target => return false,
            Operand::Typed(expr) => fold(self.declarations.types(), expr).ok().and_then(Value::as_int),
            _ => return false,
        };
        if number.is_some_and(|number| values.iter().any(|(_, value)| *value == number)) {
            return false;
        }
        let message = match number {
            Some(number) => format!("{number} is not a value of {name}, which is strict"),
            None => format!("{name} is strict and takes its own values only"),
        };
        let help = values.first().map(|(value, _)| format!("its values are written as `{name}.{value}`"));
        let found = Diagnostic::error(Code::StrictEnumeration, operand.span(), message);
        self.report(found.with_optional_help(help));
        true
    }

    /// Reports an operand with which nothing is reckoned, because its enumeration is `strict`.
    pub(super) fn refuse_strict_operands(&mut self, operands: [&Operand; 2]) -> Option<()> {
        for operand in operands {
            let Operand::Typed(expr) = operand else { continue };
            // The tools take its constants: they are numbers.
            if matches!(expr.kind, ExprKind::Constant(_)) {
                continue;
            }
            let Type::Enumeration { name, is_strict: true, .. } = self.declarations.types().get(expr.ty) else {
                continue;
            };
            let message = format!("{name} is strict: nothing is reckoned with its values");
            let found = Diagnostic::error(Code::StrictEnumeration, expr.span, message);
            self.report(found.with_help("assign a value by its name, or convert this one with TO_INT"));
            return None;
        }
        Some(())
    }
}
