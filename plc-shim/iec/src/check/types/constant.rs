//! Constant expressions to values, by the rules that the compiled code follows.

use crate::ir::{Binary, ElementaryType, Expr, ExprKind, Intrinsic, Rounding, TypeTable, Unary, Value};
use crate::syntax::Span;

/// Why an expression has no constant value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::check) enum NoValue {
    NotConstant(Span),
    DivisionByZero(Span),
}

/// The value of a constant expression.
pub(in crate::check) fn fold(types: &TypeTable, expr: &Expr) -> Result<Value, NoValue> {
    let not_constant = NoValue::NotConstant(expr.span);
    let ty = types.elementary(expr.ty).ok_or(not_constant)?;
    match &expr.kind {
        ExprKind::Constant(value) => Ok(*value),
        ExprKind::Unary(operator, operand) => Ok(unary(*operator, ty, fold(types, operand)?)),
        ExprKind::Binary(operator, left, right) => {
            let operands = types.elementary(left.ty).ok_or(not_constant)?;
            let (left, right) = (fold(types, left)?, fold(types, right)?);
            binary(*operator, operands, left, right).map_err(|()| NoValue::DivisionByZero(expr.span))
        }
        ExprKind::Convert(rounding, operand) => Ok(convert(*rounding, ty, fold(types, operand)?)),
        ExprKind::FromRegister(operand) => Ok(convert(Rounding::NearestEven, ty, fold(types, operand)?)),
        ExprKind::Conditional(parts) => {
            let [condition, then, otherwise] = &**parts;
            let holds = fold(types, condition)? == Value::Bool(true);
            fold(types, if holds { then } else { otherwise })
        }
        ExprKind::Limited(_, _, operand) => fold(types, operand),
        ExprKind::Address(place) => place.fixed_address().map(|at| Value::Int(i128::from(at))).ok_or(not_constant),
        ExprKind::Intrinsic(shift @ (Intrinsic::ShiftLeft | Intrinsic::ShiftRight), operands) => {
            let [value, count] = &operands[..] else { return Err(not_constant) };
            let (value, count) = (fold(types, value)?, fold(types, count)?);
            shifted(*shift, ty, value, count).ok_or(not_constant)
        }
        ExprKind::Load(_)
        | ExprKind::Intrinsic(..)
        | ExprKind::Text(_)
        | ExprKind::Call(_)
        | ExprKind::Cast(_)
        | ExprKind::After(..) => Err(not_constant),
    }
}

/// Bits that are shifted out are lost, and zeros come in (2nd ed. Table 25); a count beyond the width depends on the
/// dialect, so that it is left to the running program.
fn shifted(shift: Intrinsic, ty: ElementaryType, value: Value, count: Value) -> Option<Value> {
    let width = ty.size().checked_mul(8)?;
    let count = u32::try_from(count.as_int()?).ok().filter(|count| *count < width)?;
    let mask = (1_i128 << width) - 1;
    let bits = value.as_int()? & mask;
    let moved = if shift == Intrinsic::ShiftLeft { (bits << count) & mask } else { bits >> count };
    Some(Value::Int(ty.wrap(moved)))
}

fn unary(operator: Unary, ty: ElementaryType, value: Value) -> Value {
    match (operator, value) {
        (Unary::Negate, Value::Int(value)) => Value::Int(ty.wrap(-value)),
        (Unary::Negate, Value::Real(value)) => Value::Real(-value),
        (Unary::Negate, Value::Lreal(value)) => Value::Lreal(-value),
        (Unary::Not, Value::Int(value)) => Value::Int(ty.wrap(!value)),
        (_, Value::Bool(value)) => Value::Bool(!value),
        (Unary::Not, other) => other,
    }
}

/// The error is a division by zero.
fn binary(operator: Binary, ty: ElementaryType, left: Value, right: Value) -> Result<Value, ()> {
    if operator.is_comparison() {
        return Ok(Value::Bool(compare(operator, left, right)));
    }
    Ok(match (left, right) {
        (Value::Real(left), Value::Real(right)) => {
            if operator == Binary::Divide && right == 0.0 {
                return Err(());
            }
            Value::Real(match operator {
                Binary::Add => left + right,
                Binary::Subtract => left - right,
                Binary::Multiply => left * right,
                _ => left / right,
            })
        }
        (Value::Lreal(left), Value::Lreal(right)) => Value::Lreal(real(operator, left, right)?),
        _ => {
            let (left, right) = (left.as_int().ok_or(())?, right.as_int().ok_or(())?);
            let value = ty.wrap(integer(operator, left, right)?);
            if ty == ElementaryType::Bool { Value::Bool(value != 0) } else { Value::Int(value) }
        }
    })
}

pub(in crate::check) fn real(operator: Binary, left: f64, right: f64) -> Result<f64, ()> {
    Ok(match operator {
        Binary::Add => left + right,
        Binary::Subtract => left - right,
        Binary::Multiply => left * right,
        Binary::Divide if right == 0.0 => return Err(()),
        _ => left / right,
    })
}

/// Exact up to 64 bit operands; the caller wraps.
pub(in crate::check) fn integer(operator: Binary, left: i128, right: i128) -> Result<i128, ()> {
    Ok(match operator {
        Binary::Add => left.wrapping_add(right),
        Binary::Subtract => left.wrapping_sub(right),
        Binary::Multiply => left.wrapping_mul(right),
        Binary::Divide if right == 0 => return Err(()),
        // 2nd ed. Table 24: the result of MOD 0 is 0.
        Binary::DivideAnyway | Binary::Modulo if right == 0 => 0,
        Binary::Divide | Binary::DivideAnyway => left.wrapping_div(right),
        Binary::Modulo => left.wrapping_rem(right),
        Binary::And => left & right,
        Binary::Or => left | right,
        _ => left ^ right,
    })
}

fn compare(operator: Binary, left: Value, right: Value) -> bool {
    use std::cmp::Ordering::{Equal, Greater, Less};
    let order = match (left.as_int(), right.as_int()) {
        (Some(left), Some(right)) => Some(left.cmp(&right)),
        _ => left.as_f64().partial_cmp(&right.as_f64()),
    };
    match operator {
        Binary::Equal => order == Some(Equal),
        Binary::NotEqual => order != Some(Equal),
        Binary::Less => order == Some(Less),
        Binary::LessEqual => matches!(order, Some(Less | Equal)),
        Binary::Greater => order == Some(Greater),
        _ => matches!(order, Some(Greater | Equal)),
    }
}

/// A constant as one of another type.
pub(in crate::check) fn convert(rounding: Rounding, target: ElementaryType, value: Value) -> Value {
    match (target, value) {
        (ElementaryType::Real, Value::Int(value)) => Value::Real(value as f32),
        (ElementaryType::Real, value) => Value::Real(value.as_f64() as f32),
        (ElementaryType::Lreal, value) => Value::Lreal(value.as_f64()),
        (ElementaryType::Bool, value) => Value::Bool(value.as_f64() != 0.0),
        (_, Value::Real(_) | Value::Lreal(_)) => {
            let real = value.as_f64();
            let whole = match rounding {
                Rounding::NearestEven => real.round_ties_even(),
                Rounding::NearestAway => real.round(),
                Rounding::Truncate => real.trunc(),
                Rounding::Up => real.ceil(),
                Rounding::Down => real.floor(),
            };
            // A cast saturates and makes NaN zero, as the compiled code does.
            let (low, high) = target.range().unwrap_or((0, 0));
            Value::Int((whole as i128).clamp(low, high))
        }
        (_, value) => Value::Int(target.wrap(value.as_int().unwrap_or(0))),
    }
}

/// The value that an elementary variable's bytes stand for.
pub(in crate::check) fn decode(ty: ElementaryType, image: &[u8]) -> Value {
    let mut bytes = [0; 8];
    for (target, source) in bytes.iter_mut().zip(image) {
        *target = *source;
    }
    let raw = u64::from_le_bytes(bytes);
    match ty {
        ElementaryType::Bool => Value::Bool(raw != 0),
        ElementaryType::Real => Value::Real(f32::from_bits(raw as u32)),
        ElementaryType::Lreal => Value::Lreal(f64::from_bits(raw)),
        _ => Value::Int(ty.wrap(i128::from(raw))),
    }
}
