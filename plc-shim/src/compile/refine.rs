//! What a condition says of the variables in it, where it holds and where it does not.

use super::emitter::Emitter;
use super::interval::{Interval, Slot, is_still};
use crate::ir::{Binary, ElementaryType, Expr, ExprKind, Unary};

/// Deepest condition that is looked into.
const MAX_DEPTH: u32 = 8;

/// A comparison read from right to left.
fn mirrored(operator: Binary) -> Binary {
    match operator {
        Binary::Less => Binary::Greater,
        Binary::LessEqual => Binary::GreaterEqual,
        Binary::Greater => Binary::Less,
        Binary::GreaterEqual => Binary::LessEqual,
        other => other,
    }
}

/// The comparison that holds where this one does not.
fn opposite(operator: Binary) -> Binary {
    match operator {
        Binary::Less => Binary::GreaterEqual,
        Binary::LessEqual => Binary::Greater,
        Binary::Greater => Binary::LessEqual,
        Binary::GreaterEqual => Binary::Less,
        Binary::Equal => Binary::NotEqual,
        Binary::NotEqual => Binary::Equal,
        other => other,
    }
}

/// What is left of a range whose numbers compare like this with one of `other`; it may be empty.
fn limited((low, high): Interval, operator: Binary, other: Interval) -> Interval {
    match operator {
        Binary::Less => (low, high.min(other.1 - 1)),
        Binary::LessEqual => (low, high.min(other.1)),
        Binary::Greater => (low.max(other.0 + 1), high),
        Binary::GreaterEqual => (low.max(other.0), high),
        Binary::Equal => (low.max(other.0), high.min(other.1)),
        _ => (low, high),
    }
}

impl Emitter<'_, '_> {
    /// From here on the condition, which has just been evaluated, is known to be `holds`.
    pub(super) fn assume(&mut self, condition: &Expr, holds: bool) {
        if is_still(condition) {
            self.assume_at(condition, holds, MAX_DEPTH);
        }
    }

    fn assume_at(&mut self, condition: &Expr, holds: bool, depth: u32) {
        let Some(depth) = depth.checked_sub(1) else { return };
        match &condition.kind {
            ExprKind::Unary(Unary::Not, operand) => self.assume_at(operand, !holds, depth),
            ExprKind::Binary(Binary::And, left, right) if holds => self.assume_both(left, right, true, depth),
            ExprKind::Binary(Binary::Or, left, right) if !holds => self.assume_both(left, right, false, depth),
            ExprKind::Conditional(parts) => self.assume_choice(parts, holds, depth),
            ExprKind::Binary(operator, left, right) if operator.is_comparison() => {
                let operator = if holds { *operator } else { opposite(*operator) };
                self.assume_comparison(left, operator, right);
                self.assume_comparison(right, mirrored(operator), left);
            }
            _ => {}
        }
    }

    fn assume_both(&mut self, left: &Expr, right: &Expr, holds: bool, depth: u32) {
        self.assume_at(left, holds, depth);
        self.assume_at(right, holds, depth);
    }

    /// `AND_THEN` is a choice of its right operand or FALSE, `OR_ELSE` of TRUE or its right operand.
    fn assume_choice(&mut self, [condition, then, otherwise]: &[Expr; 3], holds: bool, depth: u32) {
        let constant = |expr: &Expr| match &expr.kind {
            ExprKind::Constant(value) => value.as_int().map(|value| value != 0),
            _ => None,
        };
        if holds && constant(otherwise) == Some(false) {
            self.assume_both(condition, then, true, depth);
        } else if !holds && constant(then) == Some(true) {
            self.assume_both(condition, otherwise, false, depth);
        }
    }

    fn assume_comparison(&mut self, left: &Expr, operator: Binary, right: &Expr) {
        let Some((slot, ty)) = self.variable(left) else { return };
        let (Some(before), Some(other)) = (self.interval(left), self.interval(right)) else { return };
        let (low, high) = limited(before, operator, other);
        // An empty range is that of code which never runs.
        if low <= high && (low, high) != before {
            self.known.ranges.insert(slot, ty, (low, high));
        }
    }

    /// The integer variable whose number the expression is.
    pub(super) fn variable(&self, expr: &Expr) -> Option<(Slot, ElementaryType)> {
        match &expr.kind {
            ExprKind::Load(place) => {
                let ty = self.shared.types.elementary(place.ty).filter(|ty| ty.is_integer())?;
                Some((self.slot(place)?, ty))
            }
            ExprKind::Convert(_, operand) => {
                let (from, to) = (self.held_as(operand.ty).range()?, self.held_as(expr.ty).range()?);
                let whole = to.0 <= from.0 && from.1 <= to.1;
                whole.then(|| self.variable(operand)).flatten()
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_holds_every_number_that_fulfils_the_comparison() {
        type Fulfils = fn(&i128, &i128) -> bool;
        let operators: [(Binary, Fulfils); 6] = [
            (Binary::Less, i128::lt),
            (Binary::LessEqual, i128::le),
            (Binary::Greater, i128::gt),
            (Binary::GreaterEqual, i128::ge),
            (Binary::Equal, i128::eq),
            (Binary::NotEqual, i128::ne),
        ];
        for (operator, fulfils) in operators {
            for (range, other) in [((-5, 5), (0, 2)), ((0, 9), (4, 4)), ((3, 4), (-2, 8))] {
                let (low, high) = limited(range, operator, other);
                for value in range.0..=range.1 {
                    let possible = (other.0..=other.1).any(|other| fulfils(&value, &other));
                    assert!(!possible || (low..=high).contains(&value), "{value} {operator:?} {other:?}");
                }
            }
        }
    }
}
