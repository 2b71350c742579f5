//! Names that signals and variables can have, made of those that engineers gave.

use std::collections::BTreeSet;

use onescan_base::SignalType;
use onescan_iec::syntax::token::Keyword;

/// Longest name of a signal; a number may have to follow.
const BYTES_MAX: usize = 120;

/// Names that are taken, regardless of case.
#[derive(Debug, Default)]
pub(super) struct Taken(BTreeSet<String>);

impl Taken {
    /// The name, or the first one with a number behind it that is free.
    fn free(&mut self, name: &str) -> String {
        let numbered = (2_u32..).map(|number| format!("{name}_{number}"));
        let found =
            std::iter::once(name.to_owned()).chain(numbered).find(|name| self.0.insert(name.to_ascii_uppercase()));
        found.unwrap_or_default()
    }

    /// A name for a signal, as near to `name` as can be.
    pub(super) fn signal(&mut self, name: &str) -> String {
        let mut text = String::new();
        for c in name.trim().chars() {
            match c {
                'a'..='z' | 'A'..='Z' | '0'..='9' | '_' | '.' | '-' | '[' | ']' | ',' => text.push(c),
                _ => text.push_str(in_ascii(c)),
            }
        }
        // Many commas and brackets, as in `a[1, 2]`, are indices and stay; blanks in them go.
        let text = text.replace(",_", ",");
        let begins = text.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
        let text = if begins { text } else { format!("_{text}") };
        self.free(&text[..text.len().min(BYTES_MAX)])
    }

    /// A name for the variable of a signal, as near to it as can be.
    pub(super) fn variable(&mut self, signal: &str) -> String {
        let mut text = String::new();
        for c in signal.chars() {
            let c = if c.is_ascii_alphanumeric() { c } else { '_' };
            // Two underlines in a row are not part of a name in the standard.
            if c != '_' || !text.ends_with('_') {
                text.push(c);
            }
        }
        let text = text.trim_end_matches('_');
        let is_word = Keyword::find(text).is_some() || text.parse::<SignalType>().is_ok();
        let begins = text.starts_with(|c: char| c.is_ascii_alphabetic());
        let text = if is_word || !begins { format!("io_{}", text.trim_start_matches('_')) } else { text.to_owned() };
        self.free(text.trim_end_matches('_'))
    }
}

/// A letter that names may have, for one that they may not.
fn in_ascii(c: char) -> &'static str {
    match c {
        'ä' => "ae",
        'ö' => "oe",
        'ü' => "ue",
        'Ä' => "Ae",
        'Ö' => "Oe",
        'Ü' => "Ue",
        'ß' => "ss",
        'à' | 'á' | 'â' | 'å' => "a",
        'é' | 'è' | 'ê' => "e",
        'ç' => "c",
        'ñ' => "n",
        'ø' | 'ó' | 'ô' => "o",
        'ł' => "l",
        '(' | ')' | '{' | '}' | '"' | '\'' => "",
        _ => "_",
    }
}

#[cfg(test)]
mod tests {
    use onescan_server::signal::SignalName;

    use super::*;

    #[test]
    fn names_of_signals_are_legal_and_free() {
        let mut taken = Taken::default();
        for (name, expected) in [
            ("Start", "Start"),
            ("start", "start_2"),
            ("GVL.Axis[3].Pos", "GVL.Axis[3].Pos"),
            ("a[1, 2]", "a[1,2]"),
            ("Motor 1 läuft", "Motor_1_laeuft"),
            ("1M1", "_1M1"),
            ("Term 2 (EL1004).Channel 1.Input", "Term_2_EL1004.Channel_1.Input"),
            ("日本", "__"),
            ("", "_"),
        ] {
            let name = taken.signal(name);
            assert_eq!(name, expected);
            assert!(SignalName::new(name).is_ok(), "{expected}");
        }
        assert!(SignalName::new(taken.signal(&"x".repeat(500))).is_ok());
        assert!(SignalName::new(taken.signal(&"x".repeat(500))).is_ok());
    }

    #[test]
    fn names_of_variables_are_names_of_the_standard() {
        let mut taken = Taken::default();
        for (signal, expected) in [
            ("Start", "Start"),
            ("GVL.Axis[3].Pos", "GVL_Axis_3_Pos"),
            ("GVL_Axis.3.Pos", "GVL_Axis_3_Pos_2"),
            ("If", "io_If"),
            ("Time", "io_Time"),
            ("_1M1", "io_1M1"),
            ("a__b_", "a_b"),
            ("_", "io"),
        ] {
            assert_eq!(taken.variable(signal), expected);
        }
    }
}
