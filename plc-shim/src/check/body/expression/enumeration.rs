//! Enumerations as integers and integers as enumerations, without conversion (CODESYS, TwinCAT).

use crate::check::body::Body;
use crate::check::types::operand::Operand;
use crate::dialect::Feature;
use crate::ir::{ElementaryType, Expr, Type, TypeId};
use crate::syntax::Span;

impl Body<'_, '_> {
    pub(in crate::check::body) fn base_of_enumeration(&self, ty: TypeId, span: Span) -> Option<ElementaryType> {
        match self.declarations.types().get(ty) {
            Type::Enumeration { base, .. } if self.declarations.dialect(span).has(Feature::EnumerationsAsIntegers) => {
                Some(*base)
            }
            _ => None,
        }
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
