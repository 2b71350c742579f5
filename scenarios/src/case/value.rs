//! TOML values as those of signals and of PLC variables.

use onescan_base::SignalType;
use onescan_base::duration::plain;
use onescan_base::value::TextFault;
use toml::Value;

/// The bytes of a value of type `ty`.
///
/// # Errors
/// What would be right, where the value is none of the type.
pub fn bytes_of(ty: SignalType, value: &Value) -> Result<Vec<u8>, String> {
    use SignalType as E;
    match (ty, value) {
        (E::BOOL, Value::Boolean(value)) => Ok(vec![u8::from(*value)]),
        (E::REAL, Value::Float(value)) => Ok((*value as f32).to_le_bytes().to_vec()),
        (E::LREAL, Value::Float(value)) => Ok(value.to_le_bytes().to_vec()),
        (E::REAL, Value::Integer(value)) => Ok((*value as f32).to_le_bytes().to_vec()),
        (E::LREAL, Value::Integer(value)) => Ok((*value as f64).to_le_bytes().to_vec()),
        (E::TIME | E::LTIME, Value::String(text)) => {
            plain::parse_signed(text).map(|ns| ns.to_le_bytes().to_vec()).map_err(|_| wanted(ty))
        }
        (E::String(_) | E::Wstring(_), Value::String(text)) => fitting(ty, text),
        (E::BOOL | E::TIME | E::LTIME | E::String(_) | E::Wstring(_) | E::Bytes(_), _) => Err(wanted(ty)),
        (_, Value::Integer(value)) => {
            ty.integer_bytes(i128::from(*value)).ok_or_else(|| format!("a value of {ty}, which {value} is outside of"))
        }
        _ => Err(wanted(ty)),
    }
}

/// What may be written for a type.
fn wanted(ty: SignalType) -> String {
    use SignalType as E;
    match ty {
        E::BOOL => "`true` or `false`".to_owned(),
        E::REAL | E::LREAL => "a number".to_owned(),
        E::TIME | E::LTIME => "a time as text, as in \"500ms\"".to_owned(),
        E::String(_) | E::Wstring(_) => "a text".to_owned(),
        E::Bytes(_) => "anything that can be written here: a line of bytes is disturbed, not set".to_owned(),
        E::Elementary(_) => format!("a whole number of {ty}"),
    }
}

/// What is wrong with a text for a string type, as what would be right.
fn fitting(ty: SignalType, text: &str) -> Result<Vec<u8>, String> {
    ty.text_bytes(text).map_err(|fault| match (fault, ty) {
        (TextFault::Wide, _) => "a text of characters up to U+00FF".to_owned(),
        (TextFault::Long, SignalType::String(capacity) | SignalType::Wstring(capacity)) => {
            format!("a text of at most {capacity} characters")
        }
        (TextFault::Long | TextFault::NoString, _) => wanted(ty),
    })
}

/// A value as a literal of IEC 61131-3; text stands for itself, as in `"T#5s"` or `"Red"`.
pub fn literal_of(value: &Value) -> Option<String> {
    match value {
        Value::Boolean(true) => Some("TRUE".to_owned()),
        Value::Boolean(false) => Some("FALSE".to_owned()),
        Value::Integer(whole) => Some(whole.to_string()),
        Value::Float(number) => {
            let text = format!("{number:?}");
            // `1e-7` is not a real literal of the standard, `1.0e-7` is.
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
        use SignalType as E;
        let whole = |ty, value| bytes_of(ty, &Value::Integer(value));
        assert_eq!(whole(E::INT, -2), Ok(vec![0xfe, 0xff]));
        assert_eq!(whole(E::WORD, 0xffff), Ok(vec![0xff, 0xff]));
        assert!(whole(E::USINT, 256).unwrap_err().starts_with("a value of USINT"));
        assert_eq!(whole(E::LREAL, 2), Ok(2.0_f64.to_le_bytes().to_vec()));
        assert_eq!(bytes_of(E::BOOL, &Value::Integer(1)), Err("`true` or `false`".to_owned()));
        let text = |ty, text: &str| bytes_of(ty, &Value::String(text.to_owned()));
        assert_eq!(text(E::TIME, "-1.5ms"), Ok((-1_500_000_i64).to_le_bytes().to_vec()));
        assert_eq!(text(E::TIME, "0s"), Ok(vec![0; 8]));
        assert_eq!(text(E::LTIME, "0"), Ok(vec![0; 8]));
        for wrong in ["0bananas", "5bananas", "1", ""] {
            assert_eq!(text(E::LTIME, wrong), Err("a time as text, as in \"500ms\"".to_owned()), "{wrong}");
        }
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
