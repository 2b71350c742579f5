//! What a condition says of the variables in it, where it holds and where it does not.

use super::interval::{interval, is_still};
use super::range::{Interval, Ranges, Slot};
use super::scope::Scope;
use onescan_iec::ir::{Binary, ElementaryType, Expr, ExprKind, Unary};

/// Deepest condition that is looked into; a machine-made one may be nested without end.
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

/// From here on the condition, which has just been evaluated, is known to be `holds`.
pub(crate) fn assume(scope: &Scope<'_>, ranges: &mut Ranges, condition: &Expr, holds: bool) {
    // A condition that changes something on its way says nothing of what its variables are afterwards.
    if is_still(condition) {
        Refinement { scope, ranges }.assume(condition, holds, MAX_DEPTH);
    }
}

struct Refinement<'r, 'p> {
    scope: &'r Scope<'p>,
    ranges: &'r mut Ranges,
}

impl Refinement<'_, '_> {
    fn assume(&mut self, condition: &Expr, holds: bool, depth: u32) {
        let Some(depth) = depth.checked_sub(1) else { return };
        match &condition.kind {
            ExprKind::Unary(Unary::Not, operand) => self.assume(operand, !holds, depth),
            ExprKind::Binary(Binary::And, left, right) if holds => self.both(left, right, true, depth),
            ExprKind::Binary(Binary::Or, left, right) if !holds => self.both(left, right, false, depth),
            ExprKind::Conditional(parts) => self.choice(parts, holds, depth),
            ExprKind::Binary(operator, left, right) if operator.is_comparison() => {
                let operator = if holds { *operator } else { opposite(*operator) };
                self.comparison(left, operator, right);
                self.comparison(right, mirrored(operator), left);
            }
            // A variable, a constant or a call: true and false are not ranges.
            _ => {}
        }
    }

    fn both(&mut self, left: &Expr, right: &Expr, holds: bool, depth: u32) {
        self.assume(left, holds, depth);
        self.assume(right, holds, depth);
    }

    /// `AND_THEN` is a choice of its right operand or FALSE, `OR_ELSE` of TRUE or its right operand.
    fn choice(&mut self, [condition, then, otherwise]: &[Expr; 3], holds: bool, depth: u32) {
        let constant = |expr: &Expr| match &expr.kind {
            ExprKind::Constant(value) => value.as_int().map(|value| value != 0),
            _ => None,
        };
        if holds && constant(otherwise) == Some(false) {
            self.both(condition, then, true, depth);
        } else if !holds && constant(then) == Some(true) {
            self.both(condition, otherwise, false, depth);
        }
    }

    fn comparison(&mut self, left: &Expr, operator: Binary, right: &Expr) {
        let Some((slot, ty)) = variable(self.scope, left) else { return };
        let before = interval(self.scope, self.ranges, left);
        let (Some(before), Some(other)) = (before, interval(self.scope, self.ranges, right)) else { return };
        let (low, high) = limited(before, operator, other);
        // An empty range is that of code which never runs.
        if low <= high && (low, high) != before {
            self.ranges.insert(slot, ty, (low, high));
        }
    }
}

/// The integer variable whose number the expression is.
fn variable(scope: &Scope<'_>, expr: &Expr) -> Option<(Slot, ElementaryType)> {
    match &expr.kind {
        ExprKind::Load(place) => {
            let ty = scope.types().elementary(place.ty).filter(|ty| ty.is_integer())?;
            Some((scope.slot(place)?, ty))
        }
        ExprKind::Convert(_, operand) | ExprKind::FromRegister(operand) => {
            let (from, to) = (scope.held_as(operand.ty).range()?, scope.held_as(expr.ty).range()?);
            let whole = to.0 <= from.0 && from.1 <= to.1;
            whole.then(|| variable(scope, operand)).flatten()
        }
        _ => None,
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
