//! Enumerations as integers and integers as enumerations, without conversion (CODESYS, TwinCAT).

use super::enumeration_value;
use crate::check::body::Body;
use crate::check::declare::Enumerator;
use crate::check::types::operand::Operand;
use crate::dialect::Feature;
use crate::ir::{ElementaryType, Expr, Type, TypeId};
use crate::syntax::{Span, ast};

impl Body<'_, '_> {
    pub(in crate::check::body) fn base_of_enumeration(&self, ty: TypeId, span: Span) -> Option<ElementaryType> {
        match self.declarations.types().get(ty) {
            Type::Enumeration { base, .. } if self.declarations.dialect(span).has(Feature::EnumerationsAsIntegers) => {
                Some(*base)
            }
            _ => None,
        }
    }

    /// Runs `check` where the place wants a value of this type, which tells values apart that several enumerations have.
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

    fn is_value_of_several(&self, expr: &ast::Expr) -> bool {
        let ast::ExprKind::Name(name) = &expr.kind else { return false };
        self.declarations.enumerators(&self.declarations.behind_libraries(name).key()).len() > 1
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
}
