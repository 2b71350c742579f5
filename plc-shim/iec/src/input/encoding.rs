//! Bytes of a file to text, and back without loss.
//!
//! A byte order mark decides first, then what an XML declaration says, then whether the bytes are
//! UTF-8; what is left is Windows-1252, in which most editors of older programming systems write.
//! Line ends stay in the text as they are.

use std::fmt;

use crate::syntax::windows_1252::{byte_of, character_of};

/// How a file's text is written in bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Encoding {
    /// How characters are written.
    pub charset: Charset,
    /// True if the file begins with a byte order mark.
    pub mark: bool,
}

/// How characters are written in bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Charset {
    Utf8,
    /// UTF-16, low byte first.
    Utf16Le,
    /// UTF-16, high byte first.
    Utf16Be,
    /// Windows-1252; the five bytes it leaves out are the control characters of the same number.
    Windows1252,
}

impl fmt::Display for Charset {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Utf8 => "UTF-8",
            Self::Utf16Le => "UTF-16LE",
            Self::Utf16Be => "UTF-16BE",
            Self::Windows1252 => "Windows-1252",
        })
    }
}

/// Why bytes are not text.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum EncodingError {
    /// Byte order mark or declaration promise an encoding, and the bytes are not in it.
    #[error("the file says that it is {0}, and byte {1} is not")]
    Malformed(Charset, usize),
    /// An XML declaration names an encoding that is not read.
    #[error("the encoding `{0}` is not read")]
    Unknown(String),
    /// There is a zero character.
    #[error("this is not text: there are zero characters in it")]
    Binary,
    /// A character that the file's encoding has not.
    #[error("`{0}` cannot be written in {1}")]
    Unencodable(char, Charset),
}

/// The text of a file.
///
/// # Errors
/// The bytes are not text, or not the text they are said to be.
pub fn decode(bytes: &[u8]) -> Result<(String, Encoding), EncodingError> {
    let (encoding, rest) = detect(bytes)?;
    let skipped = bytes.len() - rest.len();
    let text = match encoding.charset {
        Charset::Utf8 => match std::str::from_utf8(rest) {
            Ok(text) => text.to_owned(),
            Err(error) => return Err(EncodingError::Malformed(Charset::Utf8, skipped + error.valid_up_to())),
        },
        Charset::Utf16Le => utf16(rest, skipped, Charset::Utf16Le, u16::from_le_bytes)?,
        Charset::Utf16Be => utf16(rest, skipped, Charset::Utf16Be, u16::from_be_bytes)?,
        Charset::Windows1252 => rest.iter().map(|byte| character_of(*byte)).collect(),
    };
    if text.contains('\0') { Err(EncodingError::Binary) } else { Ok((text, encoding)) }
}

/// The bytes of a text; of what [`decode`] gave, the very same bytes.
///
/// # Errors
/// The encoding lacks a character.
pub fn encode(text: &str, encoding: Encoding) -> Result<Vec<u8>, EncodingError> {
    let marked = if encoding.mark { format!("\u{feff}{text}") } else { text.to_owned() };
    match encoding.charset {
        Charset::Utf8 => Ok(marked.into_bytes()),
        Charset::Utf16Le => Ok(marked.encode_utf16().flat_map(u16::to_le_bytes).collect()),
        Charset::Utf16Be => Ok(marked.encode_utf16().flat_map(u16::to_be_bytes).collect()),
        Charset::Windows1252 => {
            text.chars().map(|one| byte_of(one).ok_or(EncodingError::Unencodable(one, encoding.charset))).collect()
        }
    }
}

/// The encoding, and the bytes behind the mark.
fn detect(bytes: &[u8]) -> Result<(Encoding, &[u8]), EncodingError> {
    let marks: [(&[u8], Charset); 3] =
        [(b"\xef\xbb\xbf", Charset::Utf8), (b"\xff\xfe", Charset::Utf16Le), (b"\xfe\xff", Charset::Utf16Be)];
    for (mark, charset) in marks {
        if let Some(rest) = bytes.strip_prefix(mark) {
            return Ok((Encoding { charset, mark: true }, rest));
        }
    }
    let charset = match bytes {
        [b'<', 0, ..] => Charset::Utf16Le,
        [0, b'<', ..] => Charset::Utf16Be,
        _ => match declared(bytes) {
            Some(name) => named(&name)?,
            None if std::str::from_utf8(bytes).is_ok() => Charset::Utf8,
            None => Charset::Windows1252,
        },
    };
    Ok((Encoding { charset, mark: false }, bytes))
}

/// What an XML declaration says of the encoding.
fn declared(bytes: &[u8]) -> Option<String> {
    let head = bytes.strip_prefix(b"<?xml")?;
    let end = head.iter().take(200).position(|byte| *byte == b'>')?;
    let head = std::str::from_utf8(&head[..end]).ok()?;
    let (_, value) = head.split_once("encoding")?;
    let value = value.trim_start().strip_prefix('=')?.trim_start();
    let quote = value.chars().next().filter(|first| matches!(first, '"' | '\''))?;
    value[1..].split(quote).next().map(str::to_owned)
}

fn named(name: &str) -> Result<Charset, EncodingError> {
    match name.to_ascii_lowercase().as_str() {
        // UTF-16 is said by programs that write another encoding than they declare: it would have shown.
        "utf-8" | "utf8" | "us-ascii" | "utf-16" | "unicode" => Ok(Charset::Utf8),
        "windows-1252" | "cp1252" | "iso-8859-1" | "latin1" => Ok(Charset::Windows1252),
        _ => Err(EncodingError::Unknown(name.to_owned())),
    }
}

fn utf16(bytes: &[u8], skipped: usize, charset: Charset, unit: fn([u8; 2]) -> u16) -> Result<String, EncodingError> {
    let (pairs, odd) = bytes.as_chunks::<2>();
    if !odd.is_empty() {
        return Err(EncodingError::Malformed(charset, skipped + bytes.len() - 1));
    }
    let mut text = String::with_capacity(pairs.len());
    for decoded in char::decode_utf16(pairs.iter().map(|pair| unit(*pair))) {
        let Ok(one) = decoded else {
            let units = text.encode_utf16().count();
            return Err(EncodingError::Malformed(charset, skipped + 2 * units));
        };
        text.push(one);
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn read(bytes: &[u8]) -> (String, Charset, bool) {
        let (text, encoding) = decode(bytes).expect("text");
        assert_eq!(encode(&text, encoding).expect("bytes"), bytes);
        (text, encoding.charset, encoding.mark)
    }

    #[test]
    fn marks_decide() {
        assert_eq!(read(b"\xef\xbb\xbfx := \xc3\xa4;\r\n"), ("x := ä;\r\n".to_owned(), Charset::Utf8, true));
        assert_eq!(read(b"\xff\xfex\0\xac\x20"), ("x€".to_owned(), Charset::Utf16Le, true));
        assert_eq!(read(b"\xfe\xff\0x\x20\xac"), ("x€".to_owned(), Charset::Utf16Be, true));
    }

    #[test]
    fn what_is_not_utf_8_is_character_of() {
        assert_eq!(read(b"(* 5 \x80, 3 \xb5m *)"), ("(* 5 €, 3 µm *)".to_owned(), Charset::Windows1252, false));
        assert_eq!(read("(* 5 €, 3 µm *)".as_bytes()).1, Charset::Utf8);
        assert_eq!(read(b"").1, Charset::Utf8);
    }

    #[test]
    fn xml_says_its_encoding() {
        let text = b"<?xml version=\"1.0\" encoding='ISO-8859-1'?><a>\xc3\xa4</a>";
        assert_eq!(read(text).0.chars().filter(|one| !one.is_ascii()).count(), 2);
        assert_eq!(read(b"<\0a\0/\0>\0"), ("<a/>".to_owned(), Charset::Utf16Le, false));
        assert_eq!(read(b"\0<\0a\0/\0>"), ("<a/>".to_owned(), Charset::Utf16Be, false));
        let koi = decode(b"<?xml version=\"1.0\" encoding=\"koi8-r\"?><a/>");
        assert_eq!(koi, Err(EncodingError::Unknown("koi8-r".to_owned())));
    }

    #[test]
    fn what_is_no_text_is_reported() {
        assert_eq!(decode(b"\x7fELF\x02\0\0"), Err(EncodingError::Binary));
        assert_eq!(decode(b"\xff\xfex\0y"), Err(EncodingError::Malformed(Charset::Utf16Le, 4)));
        assert_eq!(decode(b"\xff\xfex\0\0\xd8"), Err(EncodingError::Malformed(Charset::Utf16Le, 4)));
        assert_eq!(decode(b"\xef\xbb\xbfx\xff"), Err(EncodingError::Malformed(Charset::Utf8, 4)));
    }

    proptest! {
        #[test]
        fn no_byte_is_lost(bytes in proptest::collection::vec(any::<u8>(), 0..40)) {
            if let Ok((text, encoding)) = decode(&bytes) {
                prop_assert_eq!(encode(&text, encoding), Ok(bytes));
            }
        }
    }
}
