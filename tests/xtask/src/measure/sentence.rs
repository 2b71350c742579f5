//! Turns of phrase that a native technical writer does not use.

use serde::Serialize;

use super::Place;

/// How often a phrase stands in the product's texts and in the documents.
#[derive(Debug, Serialize)]
pub(crate) struct Sentence {
    pub(crate) phrase: &'static str,
    pub(crate) better: &'static str,
    pub(crate) texts: usize,
    pub(crate) comments: usize,
    pub(crate) docs: usize,
    pub(crate) markdown: usize,
    #[serde(skip)]
    is_here: fn(&[&str]) -> bool,
}

/// What may follow `is no` in plain English: "is no longer", "is no more than".
const COMPARED: [&str; 4] = ["longer", "more", "less", "fewer"];

impl Sentence {
    /// All phrases, counted nowhere yet.
    pub(crate) fn all() -> Vec<Self> {
        let new =
            |phrase, better, is_here| Self { phrase, better, texts: 0, comments: 0, docs: 0, markdown: 0, is_here };
        vec![
            new("is no X", "is not a X", |words| match words {
                // The word before is the first; in "there is no X" it is an actor that the sentence does not have.
                [before, "is" | "are" | "was" | "were", "no", word, ..] => {
                    *before != "there"
                        && !COMPARED.contains(word)
                        && word.chars().all(|letter| letter.is_ascii_lowercase())
                }
                _ => false,
            }),
            new("but for", "except", |words| matches!(words, [_, "but", "for", ..])),
            new("anew", "again", |words| matches!(words, [_, "anew", ..])),
        ]
    }

    fn add(&mut self, place: Place, found: usize) {
        match place {
            Place::Text => self.texts += found,
            Place::Comment => self.comments += found,
            Place::Doc => self.docs += found,
            Place::Markdown => self.markdown += found,
            // A name is not a sentence.
            Place::Code => {}
        }
    }
}

/// Counts all phrases in a text.
pub(super) fn count(sentences: &mut [Sentence], place: Place, text: &str) {
    let words = words(text);
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    for sentence in sentences {
        let found = (0..words.len()).filter(|at| (sentence.is_here)(&words[*at..])).count();
        sentence.add(place, found);
    }
}

/// The words of a text in small letters, with a mark of its own wherever a phrase cannot continue. The first is such
/// a mark, so that every word has one before it.
fn words(text: &str) -> Vec<String> {
    let mut found = vec![String::from(".")];
    let mut word = String::new();
    for letter in text.chars().chain([' ']) {
        if letter.is_alphanumeric() || letter == '_' || letter == '\'' {
            word.extend(letter.to_lowercase());
            continue;
        }
        if !word.is_empty() {
            found.push(std::mem::take(&mut word));
        }
        if !letter.is_whitespace() && letter != '*' {
            found.push(letter.to_string());
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(text: &str) -> Vec<usize> {
        let mut all = Sentence::all();
        count(&mut all, Place::Doc, text);
        all.iter().map(|sentence| sentence.docs).collect()
    }

    #[test]
    fn foreign_phrases_are_found_across_lines() {
        assert_eq!(counts("`a` is\nno program. These are no programs; it begins anew."), [2, 0, 1]);
        assert_eq!(counts("Is no client, but for one"), [1, 1, 0]);
    }

    #[test]
    fn plain_english_is_not_foreign() {
        assert_eq!(
            counts("There is no program. It is no longer here, is no more than 3. It is. No way; but, for you"),
            [0; 3]
        );
        assert_eq!(counts("renewed, is no `x`"), [0; 3]);
    }
}
