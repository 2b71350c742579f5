//! Values as text to their bytes in an image: the way back from [`ElementaryType::to_text`].

use thiserror::Error;

use super::ElementaryType as T;
use super::elementary::{CANONICAL_NAN_F32, CANONICAL_NAN_F64};

/// A text that is no value of a type.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("`{text}` is no {ty}: {wanted}")]
pub struct BadText {
    /// The text.
    pub text: String,
    /// The type.
    pub ty: T,
    /// What it should be.
    pub wanted: &'static str,
}

impl T {
    /// The bytes of the value in `text`, as a recording writes it; BOOLs also as `TRUE` and `FALSE`,
    /// durations and dates as nanoseconds.
    ///
    /// # Errors
    /// A text that is no value of the type, or out of its range.
    pub fn parse_text(self, text: &str) -> Result<Vec<u8>, BadText> {
        let bad = |wanted| BadText { text: text.to_owned(), ty: self, wanted };
        macro_rules! number {
            ($number:ty, $wanted:literal) => {
                text.trim().parse::<$number>().map(|value| value.to_le_bytes().to_vec()).map_err(|_| bad($wanted))
            };
        }
        match self {
            T::Bool => match text.trim().to_ascii_uppercase().as_str() {
                "1" | "TRUE" => Ok(vec![1]),
                "0" | "FALSE" => Ok(vec![0]),
                _ => Err(bad("write TRUE or FALSE")),
            },
            T::Sint => number!(i8, "write a whole number from -128 to 127"),
            T::Int => number!(i16, "write a whole number from -32768 to 32767"),
            T::Dint => number!(i32, "write a whole number of 32 bits"),
            T::Usint | T::Byte => number!(u8, "write a whole number from 0 to 255"),
            T::Uint | T::Word => number!(u16, "write a whole number from 0 to 65535"),
            T::Udint | T::Dword => number!(u32, "write a whole number of 32 bits, not negative"),
            T::Ulint | T::Lword => number!(u64, "write a whole number of 64 bits, not negative"),
            T::Real => {
                let value: f32 = text.trim().parse().map_err(|_| bad("write a number, as in 1.5 or -2e3"))?;
                Ok(if value.is_nan() { CANONICAL_NAN_F32 } else { value }.to_le_bytes().to_vec())
            }
            T::Lreal => {
                let value: f64 = text.trim().parse().map_err(|_| bad("write a number, as in 1.5 or -2e3"))?;
                Ok(if value.is_nan() { CANONICAL_NAN_F64 } else { value }.to_le_bytes().to_vec())
            }
            T::Char => {
                one(text.chars().map(u8::try_from)).map(|byte| vec![byte]).ok_or_else(|| bad("write a character"))
            }
            T::Wchar => one(text.encode_utf16().map(Ok::<_, std::convert::Infallible>))
                .map(|unit| unit.to_le_bytes().to_vec())
                .ok_or_else(|| bad("write a character")),
            T::String(capacity) => {
                let characters: Result<Vec<u8>, _> = text.chars().map(u8::try_from).collect();
                let characters = characters.map_err(|_| bad("it has characters of more than 8 bits"))?;
                string(characters.len(), capacity, &characters, self.size()).ok_or_else(|| bad("it is too long"))
            }
            T::Wstring(capacity) => {
                let units: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
                string(units.len() / 2, capacity, &units, self.size()).ok_or_else(|| bad("it is too long"))
            }
            _ => number!(i64, "write a whole number; times and dates are nanoseconds"),
        }
    }
}

/// The only item, if there is one and no other.
fn one<V, E>(mut items: impl Iterator<Item = Result<V, E>>) -> Option<V> {
    let first = items.next()?.ok()?;
    items.next().is_none().then_some(first)
}

fn string(count: usize, capacity: u16, characters: &[u8], size: usize) -> Option<Vec<u8>> {
    let used = u16::try_from(count).ok().filter(|used| *used <= capacity)?;
    let mut bytes = used.to_le_bytes().to_vec();
    bytes.extend_from_slice(characters);
    bytes.resize(size, 0);
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_back() {
        let cases = [
            (T::Bool, "1"),
            (T::Int, "-7"),
            (T::Ulint, "18446744073709551615"),
            (T::Lreal, "0.30000000000000004"),
            (T::Real, "NaN"),
            (T::Time, "-1000000"),
            (T::String(4), "a,é"),
            (T::Wstring(3), "日本"),
            (T::Char, "x"),
            (T::Wchar, "é"),
        ];
        for (ty, text) in cases {
            let mut bytes = ty.parse_text(text).unwrap();
            assert_eq!(bytes.len(), ty.size(), "{ty}");
            ty.canonicalise(&mut bytes).unwrap();
            assert_eq!(ty.to_text(&bytes), text, "{ty}");
        }
        assert_eq!(T::Bool.parse_text("true"), Ok(vec![1]));
    }

    #[test]
    fn what_is_no_value_is_told() {
        let bad =
            [(T::Bool, "2"), (T::Sint, "128"), (T::Uint, "-1"), (T::Lreal, ""), (T::String(2), "abc"), (T::Char, "ab")];
        for (ty, text) in bad {
            assert!(ty.parse_text(text).is_err(), "{ty} {text}");
        }
        let error = T::Sint.parse_text("128").unwrap_err().to_string();
        assert_eq!(error, "`128` is no SINT: write a whole number from -128 to 127");
    }
}
