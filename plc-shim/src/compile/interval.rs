//! Between which numbers an integer lies, so that checks that cannot fail are left out.

use super::emitter::Emitter;
pub(super) use super::range::Slot;
use crate::ir::{Binary, ElementaryType, Expr, ExprKind, Intrinsic, Place, Step, Storage, Unary, Value};

/// Smallest and greatest value.
pub(super) type Interval = (i128, i128);

/// Control variables of the loops around, which their bodies do not change.
#[derive(Debug, Clone, Default)]
pub(super) struct Facts {
    known: Vec<(Slot, Interval)>,
}

impl Facts {
    pub(super) fn push(&mut self, slot: Slot, interval: Interval) {
        self.known.push((slot, interval));
    }

    pub(super) fn pop(&mut self) {
        self.known.pop();
    }

    pub(super) fn find(&self, slot: Slot) -> Option<Interval> {
        self.known.iter().rev().find(|(known, _)| *known == slot).map(|(_, interval)| *interval)
    }
}

/// True if to evaluate the expression changes nothing.
pub(super) fn is_still(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Constant(_) => true,
        ExprKind::Load(place) | ExprKind::Address(place) => place.steps.iter().all(|step| match step {
            Step::Offset(_) => true,
            Step::Index { index, .. } => is_still(index),
            Step::Pointer { .. } | Step::Open { .. } => false,
        }),
        ExprKind::Unary(_, operand) | ExprKind::Convert(_, operand) | ExprKind::Limited(_, _, operand) => {
            is_still(operand)
        }
        ExprKind::Binary(_, left, right) => is_still(left) && is_still(right),
        ExprKind::Conditional(parts) => parts.iter().all(is_still),
        ExprKind::Intrinsic(_, operands) => operands.iter().all(is_still),
        ExprKind::Text(_) | ExprKind::Call(_) | ExprKind::After(..) | ExprKind::Cast(_) => false,
    }
}

fn within(outer: Interval, inner: Interval) -> bool {
    outer.0 <= inner.0 && inner.1 <= outer.1
}

/// Deepest expression that is looked into.
const MAX_DEPTH: u32 = 8;

impl Emitter<'_, '_> {
    /// Where the value of an integer expression lies; nothing for other types.
    pub(super) fn interval(&self, expr: &Expr) -> Option<Interval> {
        // What the expression itself changes on its way is not what is known here.
        self.interval_at(expr, if is_still(expr) { MAX_DEPTH } else { 0 })
    }

    fn interval_at(&self, expr: &Expr, depth: u32) -> Option<Interval> {
        let ty = self.shared.types.elementary(expr.ty)?;
        let full = ty.range().filter(|_| ty != ElementaryType::Bool)?;
        let found = depth.checked_sub(1).and_then(|depth| self.narrower(expr, depth));
        Some(found.filter(|found| within(full, *found)).unwrap_or(full))
    }

    /// What is known of a variable of type `ty` here: always so, or by the way to this place.
    pub(super) fn range_of(&self, slot: Slot, ty: ElementaryType) -> Option<Interval> {
        self.facts.find(slot).or_else(|| self.known.ranges.find(slot, ty))
    }

    /// What the expression's form says; it holds only if the type has all of it.
    fn narrower(&self, expr: &Expr, depth: u32) -> Option<Interval> {
        match &expr.kind {
            ExprKind::Constant(Value::Int(value)) => Some((*value, *value)),
            ExprKind::Load(place) => {
                let (slot, ty) = (self.slot(place)?, self.shared.types.elementary(place.ty)?);
                self.range_of(slot, ty)
            }
            ExprKind::Convert(_, operand) => self.interval_at(operand, depth),
            ExprKind::Limited(low, high, _) => Some((*low, *high)),
            ExprKind::Unary(Unary::Negate, operand) => {
                self.interval_at(operand, depth).map(|(low, high)| (-high, -low))
            }
            ExprKind::Binary(operator, left, right) => {
                let (left, right) = (self.interval_at(left, depth)?, self.interval_at(right, depth)?);
                combined(*operator, left, right)
            }
            ExprKind::Intrinsic(Intrinsic::FloorRemainder, operands) => match &operands[..] {
                [_, divisor] => self.interval_at(divisor, depth).map(|(_, high)| (0, high - 1)),
                _ => None,
            },
            _ => None,
        }
    }

    /// The variable, if its place is known.
    pub(super) fn slot(&self, place: &Place) -> Option<Slot> {
        match place.storage {
            _ if place.part.is_some() => None,
            Storage::Register(local) => Some(Slot::Register(self.register(local))),
            _ => self.fixed_address(place).map(Slot::Memory),
        }
    }
}

/// Where the results of two such operands lie.
pub(super) fn combined(operator: Binary, (a, b): Interval, (c, d): Interval) -> Option<Interval> {
    match operator {
        Binary::Add => Some((a + c, b + d)),
        Binary::Subtract => Some((a - d, b - c)),
        Binary::Multiply => {
            let products = [a.checked_mul(c)?, a.checked_mul(d)?, b.checked_mul(c)?, b.checked_mul(d)?];
            Some((*products.iter().min()?, *products.iter().max()?))
        }
        Binary::Divide if c > 0 && a >= 0 => Some((a / d, b / c)),
        Binary::Modulo if c > 0 && a >= 0 => Some((0, b.min(d - 1))),
        Binary::Modulo if c > 0 => Some((1 - d, d - 1)),
        Binary::And if a >= 0 && c >= 0 => Some((0, b.min(d))),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_hold_every_result() {
        let operators = [Binary::Add, Binary::Subtract, Binary::Multiply, Binary::Divide, Binary::Modulo, Binary::And];
        let intervals = [(-7, 5), (0, 9), (3, 3), (2, 6), (-4, -1)];
        for operator in operators {
            for left in intervals {
                for right in intervals {
                    let Some((low, high)) = combined(operator, left, right) else { continue };
                    for a in left.0..=left.1 {
                        for b in right.0..=right.1 {
                            let value = match operator {
                                Binary::Add => a + b,
                                Binary::Subtract => a - b,
                                Binary::Multiply => a * b,
                                Binary::Divide => a / b,
                                Binary::Modulo => a % b,
                                _ => a & b,
                            };
                            assert!((low..=high).contains(&value), "{operator:?} of {a} and {b}");
                        }
                    }
                }
            }
        }
    }
}
