//! What Python's operators make of two values, without those of lists beside numbers.

use super::names::Evaluated;
use super::value::{Value, quoted};

/// What a sign makes of two values: whole numbers stay whole while they fit.
pub(super) fn binary(sign: &str, left: &Value, right: &Value) -> Evaluated {
    if sign == "+" {
        match (left, right) {
            (Value::Text(one), Value::Text(other)) => return Ok(Value::Text(format!("{one}{other}"))),
            (Value::List(one), Value::List(other)) => return Ok(Value::List([one.as_slice(), other].concat())),
            // numbers are added below, and what is none is refused there
            _ => {}
        }
    }
    if let (Value::Whole(one), Value::Whole(other)) = (left, right) {
        let whole = match sign {
            "+" => one.checked_add(*other),
            "-" => one.checked_sub(*other),
            "*" => one.checked_mul(*other),
            "//" if *other > 0 => one.checked_div_euclid(*other),
            "%" if *other > 0 => one.checked_rem_euclid(*other),
            "**" => u32::try_from(*other).ok().and_then(|exponent| one.checked_pow(exponent)),
            _ => None,
        };
        if let Some(whole) = whole {
            return Ok(Value::Whole(whole));
        }
    }
    let (Some(one), Some(other)) = (left.number(), right.number()) else {
        return Err(format!("`{sign}` does not go with {} and {}", quoted(left), quoted(right)));
    };
    if matches!(sign, "/" | "//" | "%") && other == 0.0 {
        return Err("division by 0".to_owned());
    }
    Ok(Value::Number(match sign {
        "+" => one + other,
        "-" => one - other,
        "*" => one * other,
        "/" => one / other,
        "//" => libm::floor(one / other),
        "%" => one - other * libm::floor(one / other),
        _ => libm::pow(one, other),
    }))
}
