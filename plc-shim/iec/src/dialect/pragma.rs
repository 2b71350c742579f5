//! `{dialect 'twincat'}` at the beginning of program text: its dialect, where the file's name says none.

use std::ops::Range;

use super::{Dialect, UnknownDialect};

/// What the pragma says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Chosen {
    Nothing,
    Dialect(Dialect),
    /// A name that no dialect has, and its place.
    Unknown(UnknownDialect, Range<u32>),
}

impl Chosen {
    /// Looks for the pragma in front of everything but comments.
    pub(crate) fn in_text(text: &str) -> Self {
        let rest = behind_comments(text);
        let Some(inner) = rest.strip_prefix('{').and_then(|rest| rest.split_once('}')).map(|(inner, _)| inner) else {
            return Self::Nothing;
        };
        let mut words = inner.trim().splitn(2, char::is_whitespace);
        let is_it = words.next().is_some_and(|word| word.eq_ignore_ascii_case("dialect"));
        let Some(name) = words.next().map(|name| name.trim().trim_matches('\'')).filter(|_| is_it) else {
            return Self::Nothing;
        };
        match name.parse() {
            Ok(dialect) => Self::Dialect(dialect),
            Err(error) => {
                // `name` is a part of `text`.
                let start = (name.as_ptr() as usize - text.as_ptr() as usize) as u32;
                Self::Unknown(error, start..start + name.len() as u32)
            }
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
        assert_eq!(chosen("// a\n(* b *) {dialect 'twincat'}\nPROGRAM P"), Chosen::Dialect(Dialect::TwinCat));
        assert_eq!(chosen("{DIALECT codesys}"), Chosen::Dialect(Dialect::Codesys));
        for text in ["", "{", "(* a", "// a", "{dialect}", "{test 'twincat'}", "PROGRAM P {dialect 'twincat'}"] {
            assert_eq!(chosen(text), Chosen::Nothing, "{text}");
        }
        let Chosen::Unknown(error, place) = chosen("{dialect 'twinkat'}") else { panic!("known") };
        assert_eq!((error.to_string().contains("twinkat"), place), (true, 10..17));
    }
}
