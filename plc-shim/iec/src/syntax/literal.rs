//! A literal's text to its value (2nd ed. 2.2, 3rd ed. 6.3).

use onescan_base::duration::{IecDuration, IecDurationError};

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
        // of vendors; who reads the text reports it elsewhere
        Some(("10", digits)) => (10, digits),
        Some(("16", digits)) => (16, digits),
        Some((base, _)) => return Err(format!("base {base} is not 2, 8 or 16")),
    };
    let digits = without_underscores(digits)?;
    i128::from_str_radix(&digits, radix).map_err(|error| match error.kind() {
        std::num::IntErrorKind::PosOverflow => "integer is too large".to_owned(),
        _ => format!("`{digits}` is not a number of base {radix}"),
    })
}

/// Value of a real literal's text.
///
/// # Errors
/// A sentence that says what is wrong.
pub fn parse_real(text: &str) -> Result<f64, String> {
    let digits = without_underscores(text)?;
    let value: f64 = digits.parse().map_err(|_| format!("`{text}` is not a real number"))?;
    if value.is_finite() { Ok(value) } else { Err("real number is too large".to_owned()) }
}

/// Value of a literal with a type before its `#`.
///
/// # Errors
/// A sentence that says what is wrong.
pub fn parse_typed(text: &str) -> Result<Literal, String> {
    let (prefix, body) = text.split_once('#').ok_or("`#` is missing")?;
    let body = body.trim_start();
    // `D#Red` is a value of a user's own enumeration.
    let calendar = calendar_prefix(prefix).filter(|_| body.starts_with(|first: char| first.is_ascii_digit()));
    if let Some((kind, long)) = calendar {
        let ns = parse_calendar(kind, body)?;
        return Ok(Literal::Calendar { kind, long, ns, text: text.to_owned() });
    }
    match prefix.to_ascii_uppercase().as_str() {
        "T" | "TIME" => Ok(Literal::Duration { long: false, ns: parse_duration(body)? }),
        "LT" | "LTIME" => long_duration(body),
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

/// A LTIME; whether it may have no sign, the dialect says.
fn long_duration(body: &str) -> Result<Literal, String> {
    let unsigned = IecDuration::unsigned_nanos(body).ok().filter(|ns| i64::try_from(*ns).is_err());
    match unsigned {
        Some(ns) => Ok(Literal::LongDuration(ns)),
        None => Ok(Literal::Duration { long: true, ns: parse_duration(body)? }),
    }
}

/// Nanoseconds of `1d2h3m4s5ms6us7ns`, what follows `T#`.
///
/// # Errors
/// A sentence that says what is wrong.
pub fn parse_duration(body: &str) -> Result<i64, String> {
    body.parse().map(IecDuration::nanos).map_err(|error: IecDurationError| error.to_string())
}

/// What `T#1m30`, a duration that ends without a unit, may have been meant to be.
pub fn missing_unit(text: &str) -> Option<String> {
    let (prefix, body) = text.split_once('#')?;
    let durations = ["T", "TIME", "LT", "LTIME", "S5T", "S5TIME"];
    if !durations.iter().any(|known| known.eq_ignore_ascii_case(prefix))
        || !body.ends_with(|end: char| end.is_ascii_digit())
    {
        return None;
    }
    let before = body.trim_end_matches(|one: char| one.is_ascii_digit() || matches!(one, '.' | '_'));
    let number = &body[before.len()..];
    let unit = match before.trim_start_matches(|one: char| !one.is_ascii_alphabetic()) {
        "" if number.contains('.') => "s",
        "" => "ms",
        _ => {
            let last = before.rfind(|one: char| !one.is_ascii_alphabetic()).map_or(0, |at| at + 1);
            match before[last..].to_ascii_lowercase().as_str() {
                "d" => "h",
                "h" => "m",
                "m" => "s",
                "s" => "ms",
                "ms" => "us",
                "us" => "ns",
                _ => return None,
            }
        }
    };
    Some(format!("write the unit, as in `{text}{unit}`"))
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
    fn a_missing_unit_is_the_one_that_comes_next() {
        let meant =
            ["T#500", "T#1.5", "t#1m30", "TIME#2h_15", "LT#3us4"].map(|text| missing_unit(text).unwrap_or_default());
        let meant = meant.map(|help| help.split('`').nth(1).map(str::to_owned).unwrap_or_default());
        assert_eq!(meant, ["T#500ms", "T#1.5s", "t#1m30s", "TIME#2h_15m", "LT#3us4ns"]);
        assert_eq!([missing_unit("INT#5"), missing_unit("T#5x5"), missing_unit("T#5ms")], [None, None, None]);
    }

    #[test]
    fn integers_of_every_base() {
        assert_eq!(parse_integer("1_000"), Ok(1000));
        assert_eq!(parse_integer("16#ff_FF"), Ok(0xffff));
        assert_eq!(parse_integer("2#1010"), Ok(10));
        assert_eq!(parse_integer("10#30_000"), Ok(30_000));
        assert!(parse_integer("3#1").is_err());
        assert!(parse_integer("2#12").is_err());
        assert!(parse_integer("1__0").is_err());
        assert!(parse_integer(&"9".repeat(60)).is_err());
    }
}
