//! Text from outside, made fit to be shown: what another program, a PLC or a file says must not steer a terminal, fake a
//! line of a log, or fill a disk.

use std::borrow::Cow;

use serde::{Deserialize, Deserializer};

/// Longest text from outside that is shown or passed on, in characters.
pub const CHARACTERS_MAX: usize = 2_000;

/// Kept free of the text itself where it is cut, for the words that say so.
const CUT_CHARACTERS_MAX: usize = 48;

/// `text` as one line of printable characters, of [`CHARACTERS_MAX`] at most: control characters, ends of lines and what
/// turns the direction of writing are written out as in `\n` and `\u{1b}`. What is one already is left as it is.
///
/// ```
/// use onescan_base::foreign::one_line;
///
/// assert_eq!(one_line("the valve is stuck"), "the valve is stuck");
/// assert_eq!(one_line("\u{1b}[31mRED\u{7}\nerror: none"), r"\u{1b}[31mRED\u{7}\nerror: none");
/// assert!(one_line(&"x".repeat(5_000_000)).ends_with("x … (cut, 5000000 bytes)"));
/// ```
#[must_use]
pub fn one_line(text: &str) -> Cow<'_, str> {
    // A byte for a character at least: most texts are decided by their length.
    let is_short = text.len() <= CHARACTERS_MAX || text.chars().nth(CHARACTERS_MAX).is_none();
    if is_short && !text.chars().any(must_be_written_out) {
        return Cow::Borrowed(text);
    }
    // Where each character of the text ends in what is written of it.
    let (mut shown, mut count, mut cut_at) = (String::new(), 0, 0);
    for character in text.chars() {
        count += write_out(character, &mut shown);
        if count <= CHARACTERS_MAX - CUT_CHARACTERS_MAX {
            cut_at = shown.len();
        }
        if count > CHARACTERS_MAX {
            shown.truncate(cut_at);
            let cut = format!(" … (cut, {} bytes)", text.len());
            shown.push_str(&cut);
            break;
        }
    }
    Cow::Owned(shown)
}

/// `text` of several lines for a terminal, as of a report with a piece of somebody's source in it: as [`one_line`], but
/// ends of lines and tabs stay, and so do colours, which the report has of its own. It is not cut.
#[must_use]
pub fn for_terminal(text: &str) -> Cow<'_, str> {
    let stays = |character: char| matches!(character, '\n' | '\t') || !must_be_written_out(character);
    if text.chars().all(stays) {
        return Cow::Borrowed(text);
    }
    let (mut shown, mut rest) = (String::with_capacity(text.len()), text);
    while let Some(character) = rest.chars().next() {
        let length = match colour_length(rest) {
            Some(length) => {
                shown.push_str(&rest[..length]);
                length
            }
            None if stays(character) => {
                shown.push(character);
                character.len_utf8()
            }
            None => {
                write_out(character, &mut shown);
                character.len_utf8()
            }
        };
        rest = &rest[length..];
    }
    Cow::Owned(shown)
}

/// The bytes of a sequence that sets colours and nothing else, if `text` begins with one.
fn colour_length(text: &str) -> Option<usize> {
    let inside = text.strip_prefix("\u{1b}[")?;
    let end = inside.find(|c: char| !c.is_ascii_digit() && c != ';')?;
    inside[end..].starts_with('m').then_some("\u{1b}[".len() + end + 1)
}

/// A text of a message as it is taken in: [`one_line`] of what was sent.
///
/// # Errors
/// Not a text.
pub fn deserialize_line<'de, D: Deserializer<'de>>(deserializer: D) -> Result<String, D::Error> {
    let text = String::deserialize(deserializer)?;
    Ok(match one_line(&text) {
        Cow::Borrowed(_) => text,
        Cow::Owned(shown) => shown,
    })
}

/// True for what steers a terminal or ends a line, and for what turns or hides the text around it.
fn must_be_written_out(character: char) -> bool {
    let turns =
        matches!(character, '\u{61c}' | '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2060}'..='\u{206f}');
    let ends_line = matches!(character, '\u{2028}' | '\u{2029}');
    let hides = matches!(character, '\u{feff}' | '\u{e0000}'..='\u{e007f}');
    character.is_control() || turns || ends_line || hides
}

/// Writes one character; how many characters it has become.
fn write_out(character: char, shown: &mut String) -> usize {
    if !must_be_written_out(character) {
        shown.push(character);
        return 1;
    }
    let before = shown.len();
    match character {
        '\n' => shown.push_str("\\n"),
        '\r' => shown.push_str("\\r"),
        '\t' => shown.push_str("\\t"),
        other => shown.extend(other.escape_unicode()),
    }
    // What is written out is ASCII.
    shown.len() - before
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_steers_a_terminal_is_written_out() {
        let fault = "\u{1b}[31mRED\u{1b}]0;pwn\u{7}\n\nerror: fake\r\u{9b}2J";
        assert_eq!(one_line(fault), r"\u{1b}[31mRED\u{1b}]0;pwn\u{7}\n\nerror: fake\r\u{9b}2J");
        assert_eq!(one_line("a\u{202e}b\u{2028}c\u{2066}d\u{200b}e"), r"a\u{202e}b\u{2028}c\u{2066}d\u{200b}e");
        assert_eq!(one_line("Ventil öffnet nicht, 弁"), "Ventil öffnet nicht, 弁");
    }

    #[test]
    fn a_long_text_is_cut_and_says_so() {
        for text in ["x".repeat(5_000_000), "\u{1b}".repeat(900_000), "ß".repeat(2_001)] {
            let shown = one_line(&text).into_owned();
            assert!(shown.chars().count() <= CHARACTERS_MAX, "{}", shown.len());
            assert!(shown.ends_with(&format!(" … (cut, {} bytes)", text.len())), "{shown}");
            assert_eq!(one_line(&shown), shown, "cut once");
        }
        let just = "ß".repeat(CHARACTERS_MAX);
        assert_eq!(one_line(&just), just);
    }

    #[test]
    fn nothing_is_written_out_twice() {
        let shown = one_line("a\nb").into_owned();
        assert_eq!(one_line(&shown), shown);
    }

    #[test]
    fn a_report_keeps_its_lines_and_colours_only() {
        assert_eq!(for_terminal("\u{1b}[1;31mError\u{1b}[0m\n\tx := 1;"), "\u{1b}[1;31mError\u{1b}[0m\n\tx := 1;");
        assert_eq!(for_terminal("\u{1b}[2J\u{1b}]0;t\u{7}\u{1b}"), r"\u{1b}[2J\u{1b}]0;t\u{7}\u{1b}");
    }

    #[test]
    fn a_message_is_taken_in_as_a_line() {
        #[derive(Deserialize)]
        struct Said(#[serde(deserialize_with = "deserialize_line")] String);
        let Said(line) = serde_json::from_str(r#""a\nb""#).unwrap();
        assert_eq!(line, r"a\nb");
    }
}
