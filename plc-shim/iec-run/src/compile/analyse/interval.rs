//! Between which numbers an integer lies, so that checks that cannot fail are left out.

use super::range::{Interval, Ranges, Slot};
use super::scope::Scope;
use onescan_iec::ir::{Binary, ElementaryType, Expr, ExprKind, Intrinsic, Place, Step, Unary, Value};

/// True if to evaluate the expression changes nothing.
pub(crate) fn is_still(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Constant(_) => true,
        ExprKind::Load(place) | ExprKind::Address(place) => place.steps.iter().all(|step| match step {
            Step::Offset(_) => true,
            Step::Index { index, .. } => is_still(index),
            Step::Pointer { .. } | Step::Open { .. } => false,
        }),
        ExprKind::Unary(_, operand)
        | ExprKind::Convert(_, operand)
        | ExprKind::FromRegister(operand)
        | ExprKind::Limited(_, _, operand) => is_still(operand),
        ExprKind::Binary(_, left, right) => is_still(left) && is_still(right),
        ExprKind::Conditional(parts) => parts.iter().all(is_still),
        ExprKind::Intrinsic(_, operands) => operands.iter().all(is_still),
        ExprKind::Text(_) | ExprKind::Call(_) | ExprKind::After(..) | ExprKind::Cast(_) => false,
    }
}

fn within(outer: Interval, inner: Interval) -> bool {
    outer.0 <= inner.0 && inner.1 <= outer.1
}

/// Deepest expression that is looked into: each level asks for its operands again, and their operands.
const MAX_DEPTH: u32 = 8;

/// Where the value of an integer expression lies; nothing for other types.
pub(crate) fn interval(scope: &Scope<'_>, ranges: &Ranges, expr: &Expr) -> Option<Interval> {
    // What the expression itself changes on its way is not what is known here.
    interval_at(scope, ranges, expr, if is_still(expr) { MAX_DEPTH } else { 0 })
}

fn interval_at(scope: &Scope<'_>, ranges: &Ranges, expr: &Expr, depth: u32) -> Option<Interval> {
    let ty = scope.types().elementary(expr.ty)?;
    let full = ty.range().filter(|_| ty != ElementaryType::Bool)?;
    let found = depth.checked_sub(1).and_then(|depth| narrower(scope, ranges, expr, depth));
    Some(found.filter(|found| within(full, *found)).unwrap_or(full))
}

/// What is known of a variable of type `ty` here: always so, or by the way to this place.
pub(crate) fn range_of(scope: &Scope<'_>, ranges: &Ranges, slot: Slot, ty: ElementaryType) -> Option<Interval> {
    scope.counter(slot).or_else(|| ranges.find(slot, ty))
}

/// What the expression's form says; it holds only if the type has all of it.
fn narrower(scope: &Scope<'_>, ranges: &Ranges, expr: &Expr, depth: u32) -> Option<Interval> {
    match &expr.kind {
        ExprKind::Constant(Value::Int(value)) => Some((*value, *value)),
        ExprKind::Load(place) => {
            let (slot, ty) = (scope.slot(place)?, scope.types().elementary(place.ty)?);
            range_of(scope, ranges, slot, ty)
        }
        ExprKind::Convert(_, operand) | ExprKind::FromRegister(operand) => interval_at(scope, ranges, operand, depth),
        ExprKind::Limited(low, high, _) => Some((*low, *high)),
        ExprKind::Unary(Unary::Negate, operand) => {
            interval_at(scope, ranges, operand, depth).map(|(low, high)| (-high, -low))
        }
        ExprKind::Binary(operator, left, right) => {
            let left = interval_at(scope, ranges, left, depth)?;
            let right = interval_at(scope, ranges, right, depth)?;
            combined(*operator, left, right)
        }
        ExprKind::Intrinsic(Intrinsic::FloorRemainder, operands) => match &operands[..] {
            [_, divisor] => interval_at(scope, ranges, divisor, depth).map(|(_, high)| (0, high - 1)),
            _ => None,
        },
        _ => None,
    }
}

/// What an assignment has given its target, `range`, is known from here on.
pub(crate) fn assigned(scope: &Scope<'_>, ranges: &mut Ranges, target: &Place, range: Option<Interval>) {
    let (Some(slot), Some(ty)) = (scope.slot(target), scope.types().elementary(target.ty)) else { return };
    if let Some(range) = range.filter(|range| ty.is_integer() && Some(*range) != ty.range()) {
        ranges.insert(slot, ty, range);
    }
}

/// True if the operands' ranges leave no need to cut the result of a short type.
pub(crate) fn fits(scope: &Scope<'_>, ranges: &Ranges, operator: Binary, left: &Expr, right: &Expr) -> bool {
    let ty = scope.held_as(left.ty);
    if ty.is_real() || ty.size() > 2 || ty == ElementaryType::Bool {
        return false;
    }
    match operator {
        Binary::And | Binary::Or | Binary::Xor => true,
        Binary::Add | Binary::Subtract | Binary::Multiply => {
            let found = interval(scope, ranges, left).zip(interval(scope, ranges, right));
            let found = found.and_then(|(left, right)| combined(operator, left, right));
            found.zip(ty.range()).is_some_and(|(found, range)| within(range, found))
        }
        _ => false,
    }
}

/// Where the results of two such operands lie.
pub(crate) fn combined(operator: Binary, (a, b): Interval, (c, d): Interval) -> Option<Interval> {
    // No value is in an empty one, as in the body of a loop that never runs.
    if a > b || c > d {
        return None;
    }
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
        let intervals = [(-7, 5), (0, 9), (3, 3), (2, 6), (-4, -1), (1, 0)];
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
