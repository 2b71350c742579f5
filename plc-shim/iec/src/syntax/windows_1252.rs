//! Windows-1252, in which most editors of older programming systems write, and the characters of a STRING of CODESYS
//! and TwinCAT.

/// What it has at 80 to 9F (WHATWG encoding standard, index windows-1252).
const ABOVE_ASCII: [char; 32] = [
    '€', '\u{81}', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\u{8d}', 'Ž', '\u{8f}', '\u{90}', '‘', '’',
    '“', '”', '•', '–', '—', '˜', '™', 'š', '›', 'œ', '\u{9d}', 'ž', 'Ÿ',
];

/// The character of a byte.
pub(crate) fn character_of(byte: u8) -> char {
    match byte {
        0x80..=0x9f => ABOVE_ASCII[usize::from(byte - 0x80)],
        _ => char::from(byte),
    }
}

/// The byte of a character; nothing if it has none.
pub(crate) fn byte_of(one: char) -> Option<u8> {
    if let Some(at) = ABOVE_ASCII.iter().position(|other| *other == one) {
        return Some(0x80 + at as u8);
    }
    u8::try_from(u32::from(one)).ok().filter(|byte| !(0x80..=0x9f).contains(byte))
}
