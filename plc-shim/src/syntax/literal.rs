//! A literal's text to its value (2nd ed. 2.2, 3rd ed. 6.3).

use super::ast::{Literal, TypedValue};
use super::calendar::{calendar_prefix, parse_calendar};

/// Value of a literal's text, or what is wrong with it.
///
/// # Errors
/// A sentence that says what is wrong.
pub fn parse_integer(text: &str) -> Result<i128, String> {
    let (radix, digits) = match text.split_once('#') {
        None => (10, text),
        Some(("2", digits)) => (2, digits),
        Some(("8", digits)) => (8, digits),
        Some(("16", digits)) => (16, digits),
        Some((base, _)) => return Err(format!("base {base} is not 2, 8 or 16")),
    };
    let digits = without_underscores(digits)?;
    i128::from_str_radix(&digits, radix).map_err(|error| match error.kind() {
        std::num::IntErrorKind::PosOverflow => "integer is too large".to_owned(),
        _ => format!("`{digits}` is no number of base {radix}"),
    })
}

/// Value of a real literal's text.
///
/// # Errors
/// A sentence that says what is wrong.
pub fn parse_real(text: &str) -> Result<f64, String> {
    let digits = without_underscores(text)?;
    let value: f64 = digits.parse().map_err(|_| format!("`{text}` is no real number"))?;
    if value.is_finite() { Ok(value) } else { Err("real number is too large".to_owned()) }
}

/// Value of a literal with a type before its `#`.
///
/// # Errors
/// A sentence that says what is wrong.
pub fn parse_typed(text: &str) -> Result<Literal, String> {
    let (prefix, body) = text.split_once('#').ok_or("`#` is missing")?;
    // `D#Red` is a value of a user's own enumeration.
    let calendar = calendar_prefix(prefix).filter(|_| body.starts_with(|first: char| first.is_ascii_digit()));
    if let Some((kind, long)) = calendar {
        let ns = parse_calendar(kind, body)?;
        return Ok(Literal::Calendar { kind, long, ns, text: text.to_owned() });
    }
    match prefix.to_ascii_uppercase().as_str() {
        "T" | "TIME" => Ok(Literal::Duration { long: false, ns: parse_duration(body)? }),
        "LT" | "LTIME" => Ok(Literal::Duration { long: true, ns: parse_duration(body)? }),
        _ => Ok(Literal::Typed { prefix: prefix.to_owned(), value: parse_typed_value(body)? }),
    }
}

fn parse_typed_value(body: &str) -> Result<TypedValue, String> {
    if body.starts_with(['\'', '"']) {
        return Ok(TypedValue::Text(body.to_owned()));
    }
    let (negative, magnitude) = match body.as_bytes().first() {
        Some(b'-') => (true, &body[1..]),
        Some(b'+') => (false, &body[1..]),
        _ => (false, body),
    };
    if !magnitude.starts_with(|first: char| first.is_ascii_digit()) {
        return Ok(TypedValue::Name(body.to_owned()));
    }
    let based = magnitude.contains('#');
    if !based && magnitude.contains(['.', 'e', 'E']) {
        let value = parse_real(magnitude)?;
        return Ok(TypedValue::Real(if negative { -value } else { value }));
    }
    let value = parse_integer(magnitude)?;
    Ok(TypedValue::Integer(if negative { -value } else { value }))
}

/// Units in the order the standard wants them (2nd ed. 2.2.3.1), with their nanoseconds.
const UNITS: [(&str, i128); 7] = [
    ("d", 86_400_000_000_000),
    ("h", 3_600_000_000_000),
    ("m", 60_000_000_000),
    ("s", 1_000_000_000),
    ("ms", 1_000_000),
    ("us", 1_000),
    ("ns", 1),
];

/// Nanoseconds of `1d2h3m4s5ms6us7ns`; only the last unit may have a fraction.
///
/// # Errors
/// A sentence that says what is wrong.
pub fn parse_duration(text: &str) -> Result<i64, String> {
    let lower = text.to_ascii_lowercase();
    let (negative, mut rest) = lower.strip_prefix('-').map_or((false, &*lower), |rest| (true, rest));
    rest = rest.strip_prefix('+').unwrap_or(rest);
    let mut total: i128 = 0;
    let mut last_unit = None;
    while !rest.is_empty() {
        let end = rest.find(|first: char| first.is_ascii_alphabetic()).ok_or("unit is missing")?;
        let (number, tail) = rest.split_at(end);
        let end = tail.find(|first: char| !first.is_ascii_alphabetic()).unwrap_or(tail.len());
        let (unit, tail) = tail.split_at(end);
        let index = UNITS.iter().position(|(name, _)| *name == unit);
        let index = index.ok_or_else(|| format!("`{unit}` is no unit of time"))?;
        if last_unit.is_some_and(|last| last >= index) {
            return Err(format!("unit `{unit}` is out of order"));
        }
        last_unit = Some(index);
        let tail = tail.strip_prefix('_').unwrap_or(tail);
        total = total.saturating_add(scaled(number, UNITS[index].1, tail.is_empty())?);
        rest = tail;
    }
    if last_unit.is_none() {
        return Err("duration is empty".to_owned());
    }
    let total = if negative { -total } else { total };
    i64::try_from(total).map_err(|_| "duration is too long".to_owned())
}

/// `number` times `unit_ns`, a fraction below a nanosecond cut off.
fn scaled(number: &str, unit_ns: i128, fraction_allowed: bool) -> Result<i128, String> {
    let (whole, fraction) = number.split_once('.').unwrap_or((number, ""));
    if !fraction.is_empty() && !fraction_allowed {
        return Err("only the last unit may have a fraction".to_owned());
    }
    let whole: i128 = without_underscores(whole)?.parse().map_err(|_| "number is missing")?;
    let mut value = whole.checked_mul(unit_ns).ok_or("duration is too long")?;
    let mut weight = unit_ns;
    let digits = if fraction.is_empty() { String::new() } else { without_underscores(fraction)? };
    if !digits.bytes().all(|digit| digit.is_ascii_digit()) {
        return Err(format!("`{number}` is no number"));
    }
    for digit in digits.bytes() {
        // Remainders below a nanosecond are beyond the type's resolution.
        weight /= 10;
        value += i128::from(digit.wrapping_sub(b'0')) * weight;
    }
    Ok(value)
}

/// Single underscores between digits mean nothing (2nd ed. 2.2.1).
fn without_underscores(text: &str) -> Result<String, String> {
    if text.starts_with('_') || text.ends_with('_') || text.contains("__") {
        return Err("an underscore stands between two digits only".to_owned());
    }
    Ok(text.replace('_', ""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integers_of_every_base() {
        assert_eq!(parse_integer("1_000"), Ok(1000));
        assert_eq!(parse_integer("16#ff_FF"), Ok(0xffff));
        assert_eq!(parse_integer("2#1010"), Ok(10));
        assert!(parse_integer("3#1").is_err());
        assert!(parse_integer("2#12").is_err());
        assert!(parse_integer("1__0").is_err());
        assert!(parse_integer(&"9".repeat(60)).is_err());
    }

    #[test]
    fn durations_add_their_units() {
        assert_eq!(parse_duration("1d2h3m4s5ms6us7ns"), Ok(93_784_005_006_007));
        assert_eq!(parse_duration("1.5s"), Ok(1_500_000_000));
        assert_eq!(parse_duration("-1s_500ms"), Ok(-1_500_000_000));
        assert_eq!(parse_duration("25h"), Ok(90_000_000_000_000));
        assert_eq!(parse_duration("0.0000000009s"), Ok(0));
        assert_eq!(parse_duration("0.333333333333s"), Ok(333_333_333));
        for wrong in ["", "5", "1.5s2ms", "1ms2s", "1s1s", "1x", "s", "300000d", "1.5.3s"] {
            assert!(parse_duration(wrong).is_err(), "{wrong}");
        }
    }
}
