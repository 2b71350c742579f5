//! `{dialect 'twincat'}` at the beginning of program text: its dialect, where the file's name says none;
//! `{dialect 'twincat' 32}`: for a target with registers of 32 bits.

use std::ops::Range;

use super::{Dialect, IntegerWidth, WordSize};

/// What the pragma says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Chosen {
    Nothing,
    Dialect(Dialect, Option<WordSize>),
    /// A name that no dialect has, or a size that no target has: what is wrong, and its place.
    Unknown(String, Range<u32>),
}

impl Chosen {
    /// Looks for the pragma in front of everything but comments.
    pub(crate) fn in_text(text: &str) -> Self {
        let rest = behind_comments(text);
        let Some(inner) = rest.strip_prefix('{').and_then(|rest| rest.split_once('}')).map(|(inner, _)| inner) else {
            return Self::Nothing;
        };
        let mut words = inner.split_whitespace();
        let is_it = words.next().is_some_and(|word| word.eq_ignore_ascii_case("dialect"));
        let Some(name) = words.next().map(|name| name.trim_matches('\'')).filter(|_| is_it) else {
            return Self::Nothing;
        };
        let unknown = |message: String, word: &str| {
            // `word` is a part of `text`.
            let start = (word.as_ptr() as usize - text.as_ptr() as usize) as u32;
            Self::Unknown(message, start..start + word.len() as u32)
        };
        let dialect: Dialect = match name.parse() {
            Ok(dialect) => dialect,
            Err(error) => return unknown(super::UnknownDialect::to_string(&error), name),
        };
        let Some(bits) = words.next() else { return Self::Dialect(dialect, None) };
        match bits.parse::<WordSize>() {
            Ok(_) if dialect.integers() != IntegerWidth::Register => {
                let message =
                    format!("{dialect} computes integers in their own types, whatever the target's word size");
                unknown(message, bits)
            }
            Ok(word_size) => Self::Dialect(dialect, Some(word_size)),
            Err(error) => unknown(error.to_string(), bits),
        }
    }
}

fn behind_comments(text: &str) -> &str {
    let mut rest = text.trim_start_matches('\u{feff}');
    loop {
        rest = rest.trim_start();
        let behind = if let Some(comment) = rest.strip_prefix("//") {
            comment.split_once('\n').map(|(_, behind)| behind)
        } else if let Some(comment) = rest.strip_prefix("(*") {
            comment.split_once("*)").map(|(_, behind)| behind)
        } else {
            return rest;
        };
        match behind {
            Some(behind) => rest = behind,
            None => return "",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pragma_behind_comments_chooses_the_dialect() {
        let chosen = |text| Chosen::in_text(text);
        assert_eq!(chosen("// a\n(* b *) {dialect 'twincat'}\nPROGRAM P"), Chosen::Dialect(Dialect::TwinCat, None));
        assert_eq!(chosen("{DIALECT codesys}"), Chosen::Dialect(Dialect::Codesys, None));
        for text in ["", "{", "(* a", "// a", "{dialect}", "{test 'twincat'}", "PROGRAM P {dialect 'twincat'}"] {
            assert_eq!(chosen(text), Chosen::Nothing, "{text}");
        }
        let small = Chosen::Dialect(Dialect::Codesys, Some(WordSize::Bits32));
        assert_eq!(chosen("{dialect 'codesys' 32}"), small);
        for (text, word, wanted) in [
            ("{dialect 'twinkat'}", "twinkat", 10..17),
            ("{dialect 'codesys' 16}", "`16` is not a word size", 19..21),
            ("{dialect 'iec3' 32}", "iec3 computes integers in their own types", 16..18),
        ] {
            let Chosen::Unknown(message, place) = chosen(text) else { panic!("known") };
            assert_eq!((message.contains(word), place), (true, wanted));
        }
    }
}
