//! Words of our own that the field's words replace, as `tests/house/old_words.txt` lists them.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Serialize;

use super::Place;
use crate::error::TaskError;

/// How often an old word still stands in Rust, tests included, and in the documents.
#[derive(Debug, Serialize)]
pub(crate) struct OldWord {
    /// As it is written, capitals included; with a `*` at its end every word that begins like it.
    pub(crate) old: String,
    pub(crate) new: String,
    pub(crate) code: usize,
    pub(crate) comments: usize,
    pub(crate) texts: usize,
    pub(crate) markdown: usize,
}

/// The words of a list: a line `old -> new` each; `#` begins a comment.
///
/// # Errors
/// A line has another form.
pub(crate) fn listed(path: &Path, text: &str) -> Result<Vec<OldWord>, TaskError> {
    let lines = text.lines().enumerate().map(|(at, line)| (at + 1, line.trim()));
    let entries = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let word = |(number, line): (usize, &str)| match line.split_once(" -> ") {
        Some((old, new)) if !old.trim().is_empty() && !new.trim().is_empty() => Ok(OldWord {
            old: old.trim().to_owned(),
            new: new.trim().to_owned(),
            code: 0,
            comments: 0,
            texts: 0,
            markdown: 0,
        }),
        _ => Err(TaskError::wrong(path, format!("line {number}: write it as `old -> new`"))),
    };
    entries.map(word).collect()
}

/// How often each word stands in each place.
#[derive(Debug, Default)]
pub(super) struct Words {
    counts: BTreeMap<Place, BTreeMap<String, usize>>,
}

impl Words {
    pub(super) fn add(&mut self, place: Place, text: &str) {
        let counts = self.counts.entry(place).or_default();
        for word in text.split(|letter: char| !letter.is_alphanumeric() && letter != '_') {
            match counts.get_mut(word) {
                Some(count) => *count += 1,
                None => drop(counts.insert(word.to_owned(), 1)),
            }
        }
    }

    /// `old` is a word, or with `*` at its end the beginning of words.
    fn count(&self, place: Place, old: &str) -> usize {
        let Some(counts) = self.counts.get(&place) else { return 0 };
        match old.strip_suffix('*') {
            Some(start) => {
                let from = counts.range(start.to_owned()..);
                from.take_while(|(word, _)| word.starts_with(start)).map(|(_, count)| count).sum()
            }
            None => counts.get(old).copied().unwrap_or(0),
        }
    }
}

impl OldWord {
    pub(super) fn count(&mut self, words: &Words) {
        self.code = words.count(Place::Code, &self.old);
        self.comments = words.count(Place::Comment, &self.old) + words.count(Place::Doc, &self.old);
        self.texts = words.count(Place::Text, &self.old);
        self.markdown = words.count(Place::Markdown, &self.old);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_words_are_counted_where_they_stand() {
        let mut words = listed(Path::new("list"), "# why\n\ntold -> detected\ntell_* -> describe\n").unwrap();
        let mut found = Words::default();
        for (place, text) in [(Place::Code, "told"), (Place::Code, "tell_all"), (Place::Markdown, "told, Told; untold")]
        {
            found.add(place, text);
        }
        for word in &mut words {
            word.count(&found);
        }
        assert_eq!((words[0].code, words[0].markdown, words[1].code), (1, 1, 1));
        assert_eq!((words[0].new.as_str(), words[1].old.as_str()), ("detected", "tell_*"));
    }

    #[test]
    fn another_line_is_refused_with_its_number() {
        let error = listed(Path::new("list"), "a -> b\nc => d\n").unwrap_err();
        assert_eq!(error.to_string(), "list: line 2: write it as `old -> new`");
    }
}
