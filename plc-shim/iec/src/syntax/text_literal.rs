//! Character strings as written (2nd ed. 2.2.2, Tables 5 and 6; 3rd ed. 6.3.3).

use super::windows_1252::byte_of;

/// The characters of a literal.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Text {
    /// True for `"..."`, whose characters have 16 bits.
    pub wide: bool,
    /// One number for each character; a wide one beyond 16 bits takes two (UTF-16).
    pub units: Vec<u16>,
}

/// The characters of `'...'` or `"..."`, the quotes included in `text`.
///
/// # Errors
/// A sentence that says what is wrong.
pub fn parse_text(text: &str) -> Result<Text, String> {
    // The first 256 characters of ISO/IEC 10646 (2nd ed. 2.1.1).
    parse_with(text, |character| u8::try_from(u32::from(character)).ok())
}

/// The same, the characters of a STRING those of Windows-1252, as vendors have them.
///
/// # Errors
/// A sentence that says what is wrong.
pub fn parse_windows_text(text: &str) -> Result<Text, String> {
    parse_with(text, byte_of)
}

fn parse_with(text: &str, code: impl Fn(char) -> Option<u8>) -> Result<Text, String> {
    let wide = text.starts_with('"');
    let inner = text.get(1..text.len().saturating_sub(1)).unwrap_or("");
    let mut units = Vec::with_capacity(inner.len());
    let mut rest = inner.chars();
    while let Some(character) = rest.next() {
        if character == '$' {
            units.push(escaped(&mut rest, wide)?);
        } else if wide {
            units.extend_from_slice(character.encode_utf16(&mut [0; 2]));
        } else {
            let missing = || format!("`{character}` needs a \"wide\" string");
            units.push(u16::from(code(character).ok_or_else(missing)?));
        }
    }
    Ok(Text { wide, units })
}

/// What follows a `$` (2nd ed. Table 6). `$N` is a line feed, as `$L` is.
fn escaped(rest: &mut std::str::Chars<'_>, wide: bool) -> Result<u16, String> {
    let digits = if wide { 4 } else { 2 };
    let missing = || format!("`$` wants {digits} hexadecimal digits or one of $ ' \" L N P R T");
    let first = rest.clone().next().ok_or_else(missing)?;
    let single = match first.to_ascii_uppercase() {
        '$' | '\'' | '"' => Some(first as u16),
        'L' | 'N' => Some(0x0a),
        'P' => Some(0x0c),
        'R' => Some(0x0d),
        'T' => Some(0x09),
        _ => None,
    };
    if let Some(unit) = single {
        rest.next();
        return Ok(unit);
    }
    let mut value = 0;
    for _ in 0..digits {
        let digit = rest.next().and_then(|digit| digit.to_digit(16)).ok_or_else(missing)?;
        value = value * 16 + digit as u16;
    }
    Ok(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn narrow(text: &str) -> Result<String, String> {
        parse_text(text).map(|found| found.units.iter().map(|unit| char::from(*unit as u8)).collect())
    }

    #[test]
    fn iec2_2_2_2_table_6_escapes() {
        assert_eq!(narrow("''").as_deref(), Ok(""));
        assert_eq!(narrow("'A'").as_deref(), Ok("A"));
        assert_eq!(narrow("'$''").as_deref(), Ok("'"));
        assert_eq!(narrow("'\"'").as_deref(), Ok("\""));
        assert_eq!(narrow("'$R$L$0D$0A'").as_deref(), Ok("\r\n\r\n"));
        assert_eq!(narrow("'$$1.00 $t$p$n'").as_deref(), Ok("$1.00 \t\u{c}\n"));
        assert_eq!(narrow("'$c4\u{c4}'").as_deref(), Ok("\u{c4}\u{c4}"));
        for wrong in ["'$'", "'$x'", "'$1'", "'$1g'", "'\u{20ac}'"] {
            assert!(narrow(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn vendors_have_the_characters_of_windows_1252() {
        assert_eq!(parse_windows_text("'a€ä'").map(|found| found.units), Ok(vec![0x61, 0x80, 0xe4]));
        assert!(parse_windows_text("'Ω'").is_err());
    }

    #[test]
    fn wide_strings_have_16_bit_characters() {
        let wide = |text| parse_text(text).map(|found| found.units);
        assert_eq!(wide("\"$20ac\u{20ac}$\"'\""), Ok(vec![0x20ac, 0x20ac, 0x22, 0x27]));
        assert_eq!(wide("\"\u{1f600}\"").map(|units| units.len()), Ok(2));
        assert!(wide("\"$20a\"").is_err());
    }
}
