//! Values as text, one spelling for each, and back.

use onescan_base::duration::plain;
use onescan_server::signal::SignalType;

use SignalType as E;

/// The text of a value.
pub fn show(ty: SignalType, bytes: &[u8]) -> String {
    match ty {
        E::BOOL => if bytes == [0] { "FALSE" } else { "TRUE" }.to_owned(),
        E::BYTE | E::WORD | E::DWORD | E::LWORD => format!("16#{:0width$X}", unsigned(bytes), width = 2 * bytes.len()),
        E::USINT | E::UINT | E::UDINT | E::ULINT => unsigned(bytes).to_string(),
        E::REAL => format!("{:?}", f32::from_bits(unsigned(bytes) as u32)),
        E::LREAL => format!("{:?}", f64::from_bits(unsigned(bytes))),
        E::TIME | E::LTIME => seconds(signed(bytes)),
        E::CHAR | E::WCHAR => quoted(&[unsigned(bytes) as u16]),
        E::String(_) => quoted(&used(bytes, 1)),
        E::Wstring(_) => quoted(&used(bytes, 2)),
        E::Bytes(_) => ty.to_text(bytes),
        // Signed integers; dates as nanoseconds since 1970 or midnight.
        E::Elementary(_) => signed(bytes).to_string(),
    }
}

/// The bytes of a text that [`show`] gives; nothing for any other.
pub fn read(ty: SignalType, text: &str) -> Option<Vec<u8>> {
    let bytes = parse(ty, text)?;
    // One value has one spelling: whatever else might be read is not what was written.
    (show(ty, &bytes) == text).then_some(bytes)
}

fn parse(ty: SignalType, text: &str) -> Option<Vec<u8>> {
    let size = ty.size();
    let least = |value: u64| value.to_le_bytes().get(..size).map(<[u8]>::to_vec);
    match ty {
        E::BOOL => ["FALSE", "TRUE"].iter().position(|word| *word == text).map(|value| vec![value as u8]),
        E::BYTE | E::WORD | E::DWORD | E::LWORD => least(u64::from_str_radix(text.strip_prefix("16#")?, 16).ok()?),
        E::USINT | E::UINT | E::UDINT | E::ULINT => least(text.parse().ok()?),
        E::REAL => least(u64::from(text.parse::<f32>().ok()?.to_bits())),
        E::LREAL => least(text.parse::<f64>().ok()?.to_bits()),
        E::TIME | E::LTIME => least(plain::parse_signed(text).ok()? as u64),
        E::CHAR | E::WCHAR => match units(text)?[..] {
            [unit] => least(u64::from(unit)),
            _ => None,
        },
        E::String(_) => padded(units(text)?, 1, size),
        E::Wstring(_) => padded(units(text)?, 2, size),
        E::Bytes(_) => ty.parse_text(text).ok(),
        E::Elementary(_) => least(text.parse::<i64>().ok()? as u64),
    }
}

fn unsigned(bytes: &[u8]) -> u64 {
    bytes.iter().rev().fold(0, |value, byte| value << 8 | u64::from(*byte))
}

fn signed(bytes: &[u8]) -> i64 {
    let unused = 64 - 8 * bytes.len().clamp(1, 8) as u32;
    (unsigned(bytes) << unused) as i64 >> unused
}

/// Nanoseconds as seconds with all decimals they need.
fn seconds(ns: i64) -> String {
    format!("{}{}s", if ns < 0 { "-" } else { "" }, plain::seconds(ns.unsigned_abs(), 0))
}

/// The characters in use of a string in an image.
fn used(bytes: &[u8], width: usize) -> Vec<u16> {
    let count = usize::from(u16::from_le_bytes([bytes[0], bytes[1]]));
    bytes[2..].chunks_exact(width).take(count).map(|unit| unsigned(unit) as u16).collect()
}

fn padded(units: Vec<u16>, width: usize, size: usize) -> Option<Vec<u8>> {
    let mut bytes = u16::try_from(units.len()).ok()?.to_le_bytes().to_vec();
    for unit in units {
        if width == 1 && unit > 0xff {
            return None;
        }
        bytes.extend_from_slice(&unit.to_le_bytes()[..width]);
    }
    (bytes.len() <= size).then(|| {
        bytes.resize(size, 0);
        bytes
    })
}

/// Code units between quotation marks, on one line.
fn quoted(units: &[u16]) -> String {
    let mut text = String::from("\"");
    for unit in units {
        match u8::try_from(*unit) {
            Ok(byte) if (byte == b' ' || byte.is_ascii_graphic()) && !b"\"\\".contains(&byte) => {
                text.push(char::from(byte));
            }
            _ => text.extend(["\\{", &format!("{unit:x}"), "}"]),
        }
    }
    text.push('"');
    text
}

fn units(text: &str) -> Option<Vec<u16>> {
    let mut rest = text.strip_prefix('"')?.strip_suffix('"')?;
    let mut units = Vec::new();
    while let Some(letter) = rest.chars().next() {
        if let Some(escape) = rest.strip_prefix("\\{") {
            let (hex, after) = escape.split_once('}')?;
            units.push(u16::from_str_radix(hex, 16).ok()?);
            rest = after;
        } else {
            units.push(u16::from(u8::try_from(letter).ok().filter(|byte| !b"\"\\".contains(byte))?));
            rest = &rest[letter.len_utf8()..];
        }
    }
    Some(units)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn values_read_well() {
        assert_eq!(show(E::WORD, &[0xcd, 0xab]), "16#ABCD");
        assert_eq!(show(E::INT, &(-3_i16).to_le_bytes()), "-3");
        assert_eq!(show(E::TIME, &(-1_500_000_000_i64).to_le_bytes()), "-1.5s");
        assert_eq!(show(E::LREAL, &0.1_f64.to_le_bytes()), "0.1");
        assert_eq!(show(E::String(4), b"\x02\x00a\"\0\0"), "\"a\\{22}\"");
        assert_eq!(read(E::USINT, "256"), None);
        assert_eq!(read(E::BOOL, "true"), None);
        assert_eq!(read(E::LREAL, "0.10"), None);
    }

    fn types() -> impl Strategy<Value = SignalType> {
        let simple = "BOOL BYTE WORD DWORD LWORD SINT INT DINT LINT USINT UINT UDINT ULINT REAL LREAL TIME LTIME DATE TOD DT \
                      CHAR WCHAR STRING[7] WSTRING[5]";
        let all: Vec<SignalType> = simple.split_whitespace().map(|name| name.parse().unwrap()).collect();
        prop::sample::select(all)
    }

    proptest! {
        #[test]
        fn what_is_shown_reads_back(ty in types(), seed in prop::collection::vec(any::<u8>(), 16)) {
            let mut bytes: Vec<u8> = seed.iter().copied().cycle().take(ty.size()).collect();
            match ty {
                E::BOOL => bytes[0] &= 1,
                E::String(_) | E::Wstring(_) => (bytes[0], bytes[1]) = (bytes[0] % 6, 0),
                E::Elementary(_) | E::Bytes(_) => {}
            }
            prop_assume!(ty.canonicalise(&mut bytes).is_ok());
            prop_assert_eq!(read(ty, &show(ty, &bytes)), Some(bytes));
        }

        #[test]
        fn no_text_makes_reading_panic(ty in types(), text in ".{0,12}") {
            let _ = read(ty, &text);
        }
    }
}
