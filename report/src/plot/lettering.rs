//! How much room a text takes, without asking for a font.
//!
//! The widths are those of Helvetica, a little enlarged; a reader's fallback font may be wider
//! still, so whatever relies on them leaves some air.

/// The typefaces, by preference.
pub const FONT_FAMILY: &str = "Helvetica, Arial, Liberation Sans, DejaVu Sans, sans-serif";
/// The height of the title's letters.
pub const TITLE_PX: i64 = 16;
/// The height of a signal's name and of the legend's letters.
pub const NAME_PX: i64 = 12;
/// The height of a tick's label.
pub(super) const TICK_PX: i64 = 11;

/// About how wide a text is, in pixels.
pub fn width_px(text: &str, size_px: i64) -> i64 {
    let thousandths: i64 = text.chars().map(width_thousandths).sum();
    thousandths.saturating_mul(size_px) / 1000 + 1
}

/// The text, or as much of it as has room, with an ellipsis.
pub fn shortened(text: &str, size_px: i64, room_px: i64) -> String {
    if width_px(text, size_px) <= room_px {
        return text.to_owned();
    }
    let mut kept = String::new();
    let mut left = room_px.saturating_mul(1000) / size_px.max(1) - 1000;
    for letter in text.chars() {
        left -= width_thousandths(letter);
        if left < 0 {
            break;
        }
        kept.push(letter);
    }
    kept.push('\u{2026}');
    kept
}

/// The width of a letter in thousandths of its height.
fn width_thousandths(letter: char) -> i64 {
    match letter {
        'i' | 'j' | 'l' | 'I' | '.' | ',' | ':' | ';' | '\'' | '|' | '!' | ' ' => 300,
        'f' | 't' | 'r' | '(' | ')' | '[' | ']' | '-' | '/' => 380,
        'm' | 'w' | 'M' | 'W' | '%' | '@' => 900,
        'A'..='Z' | '&' => 720,
        _ if letter.is_ascii() => 580,
        '\u{2212}' | '\u{b0}' | '\u{b5}' => 600,
        _ => 1000,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shortened_text_has_room() {
        let long = "signal".repeat(50);
        let short = shortened(&long, NAME_PX, 200);
        assert!(short.ends_with('\u{2026}') && width_px(&short, NAME_PX) <= 200, "{short}");
        assert_eq!(shortened("signal", NAME_PX, 200), "signal");
        assert_eq!(shortened("signal", NAME_PX, 0), "\u{2026}");
    }
}
