//! The text of a part of a bit string (3rd ed. Table 17).

use super::direct_address::Width;

/// `%X3`, `%3` or `3`: width and number; nothing if it is not of that form.
pub fn parse(text: &str) -> Option<(Width, u32)> {
    let behind = text.strip_prefix('%').unwrap_or(text);
    let letter = behind.chars().next().filter(|letter| letter.is_ascii_alphabetic() && behind.len() < text.len());
    let width = letter.map_or(Some(Width::Bit), Width::find)?;
    let digits = behind.get(usize::from(letter.is_some())..)?;
    let plain = !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit());
    let number = if plain { digits.parse().ok() } else { None };
    Some((width, number?))
}
