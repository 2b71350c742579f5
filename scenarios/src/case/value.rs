//! TOML values as those of signals and of PLC variables.

use onescan_server::signal::ElementaryType;
use onescan_server::time::TimeSpan;
use toml::Value;

/// The bytes of a value of type `ty`.
///
/// # Errors
/// What would be right, where the value is none of the type.
pub fn bytes_of(ty: ElementaryType, value: &Value) -> Result<Vec<u8>, String> {
    use ElementaryType as E;
    match (ty, value) {
        (E::Bool, Value::Boolean(value)) => Ok(vec![u8::from(*value)]),
        (E::Real, Value::Float(value)) => Ok((*value as f32).to_le_bytes().to_vec()),
        (E::Lreal, Value::Float(value)) => Ok(value.to_le_bytes().to_vec()),
        (E::Real, Value::Integer(value)) => Ok((*value as f32).to_le_bytes().to_vec()),
        (E::Lreal, Value::Integer(value)) => Ok((*value as f64).to_le_bytes().to_vec()),
        (E::Time | E::Ltime, Value::String(text)) => duration_ns(text).map(|ns| ns.to_le_bytes().to_vec()),
        (E::String(capacity), Value::String(text)) => characters(text, capacity),
        (E::Wstring(capacity), Value::String(text)) => {
            let units: Vec<u16> = text.encode_utf16().collect();
            let count = fitting(units.len(), capacity)?;
            let mut bytes = count.to_le_bytes().to_vec();
            bytes.extend(units.iter().flat_map(|unit| unit.to_le_bytes()));
            bytes.resize(ty.size(), 0);
            Ok(bytes)
        }
        (E::Bool | E::Time | E::Ltime | E::String(_) | E::Wstring(_), _) => Err(wanted(ty)),
        (_, Value::Integer(value)) => {
            whole(ty, *value).ok_or_else(|| format!("a value of {ty}, which {value} is outside of"))
        }
        _ => Err(wanted(ty)),
    }
}

/// What may be written for a type.
fn wanted(ty: ElementaryType) -> String {
    use ElementaryType as E;
    match ty {
        E::Bool => "`true` or `false`".to_owned(),
        E::Real | E::Lreal => "a number".to_owned(),
        E::Time | E::Ltime => "a time as text, as in \"500ms\"".to_owned(),
        E::String(_) | E::Wstring(_) => "a text".to_owned(),
        _ => format!("a whole number of {ty}"),
    }
}

fn duration_ns(text: &str) -> Result<i64, String> {
    let text = text.trim();
    let (sign, rest) = text.strip_prefix('-').map_or((1, text), |rest| (-1, rest));
    if rest.starts_with('0') && rest.trim_start_matches(['0', '.']).chars().all(char::is_alphabetic) {
        return Ok(0);
    }
    let span: TimeSpan = rest.parse().map_err(|_| wanted(ElementaryType::Time))?;
    i64::try_from(span.as_nanos()).map(|ns| sign * ns).map_err(|_| wanted(ElementaryType::Time))
}

fn fitting(count: usize, capacity: u16) -> Result<u16, String> {
    let count = u16::try_from(count).ok().filter(|count| *count <= capacity);
    count.ok_or_else(|| format!("a text of at most {capacity} characters"))
}

/// A STRING has 8-bit characters.
fn characters(text: &str, capacity: u16) -> Result<Vec<u8>, String> {
    let characters: Option<Vec<u8>> = text.chars().map(|letter| u8::try_from(u32::from(letter)).ok()).collect();
    let characters = characters.ok_or("a text of characters up to U+00FF")?;
    let mut bytes = fitting(characters.len(), capacity)?.to_le_bytes().to_vec();
    bytes.extend(characters);
    bytes.resize(2 + usize::from(capacity), 0);
    Ok(bytes)
}

/// The bytes of a whole number, if the type has it. Dates are nanoseconds since 1970-01-01.
fn whole(ty: ElementaryType, value: i64) -> Option<Vec<u8>> {
    use ElementaryType as E;
    let signed = |bits: u32| (-(1_i128 << (bits - 1))..1_i128 << (bits - 1)).contains(&i128::from(value));
    let unsigned = |bits: u32| (0..1_i128 << bits).contains(&i128::from(value));
    let size = ty.size();
    let fits = match ty {
        E::Byte | E::Usint | E::Char | E::Word | E::Uint | E::Wchar | E::Dword | E::Udint | E::Lword | E::Ulint => {
            unsigned(8 * size as u32)
        }
        E::Sint | E::Int | E::Dint | E::Lint => signed(8 * size as u32),
        E::Date | E::Ldate | E::Tod | E::Ltod | E::Dt | E::Ldt => true,
        _ => false,
    };
    fits.then(|| value.to_le_bytes()[..size].to_vec())
}

/// A value as a literal of IEC 61131-3; text stands for itself, as in `"T#5s"` or `"Red"`.
pub fn literal_of(value: &Value) -> Option<String> {
    match value {
        Value::Boolean(true) => Some("TRUE".to_owned()),
        Value::Boolean(false) => Some("FALSE".to_owned()),
        Value::Integer(whole) => Some(whole.to_string()),
        Value::Float(number) => {
            let text = format!("{number:?}");
            // `1e-7` is no real literal of the standard, `1.0e-7` is.
            Some(match text.split_once('e') {
                Some((mantissa, exponent)) if !mantissa.contains('.') => format!("{mantissa}.0E{exponent}"),
                _ => text,
            })
        }
        Value::String(text) => Some(text.clone()),
        _ => None,
    }
}

/// A text as a literal of STRING (`'`) or WSTRING (`"`).
pub fn quoted(text: &str, quote: char) -> String {
    let escaped: String = text
        .chars()
        .flat_map(|letter| if letter == quote || letter == '$' { vec!['$', letter] } else { vec![letter] })
        .collect();
    format!("{quote}{escaped}{quote}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_fit_their_type() {
        use ElementaryType as E;
        let whole = |ty, value| bytes_of(ty, &Value::Integer(value));
        assert_eq!(whole(E::Int, -2), Ok(vec![0xfe, 0xff]));
        assert_eq!(whole(E::Word, 0xffff), Ok(vec![0xff, 0xff]));
        assert!(whole(E::Usint, 256).unwrap_err().starts_with("a value of USINT"));
        assert_eq!(whole(E::Lreal, 2), Ok(2.0_f64.to_le_bytes().to_vec()));
        assert_eq!(bytes_of(E::Bool, &Value::Integer(1)), Err("`true` or `false`".to_owned()));
        let text = |ty, text: &str| bytes_of(ty, &Value::String(text.to_owned()));
        assert_eq!(text(E::Time, "-1.5ms"), Ok((-1_500_000_i64).to_le_bytes().to_vec()));
        assert_eq!(text(E::Time, "0s"), Ok(vec![0; 8]));
        assert_eq!(text(E::String(4), "ab"), Ok(vec![2, 0, b'a', b'b', 0, 0]));
        assert!(text(E::String(1), "ab").is_err());
        assert_eq!(text(E::Wstring(1), "ä"), Ok(vec![1, 0, 0xe4, 0]));
    }

    #[test]
    fn literals_are_those_of_the_standard() {
        assert_eq!(literal_of(&Value::Float(1e-7)).as_deref(), Some("1.0E-7"));
        assert_eq!(literal_of(&Value::Float(5.0)).as_deref(), Some("5.0"));
        assert_eq!(quoted("it's $1", '\''), "'it$'s $$1'");
    }
}
