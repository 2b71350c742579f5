//! Markdown: its words, and how often its prose addresses the reader.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Serialize;

/// Words of documents.
#[derive(Debug, Clone, Default, Serialize)]
pub(crate) struct DocumentFigures {
    /// A document in the root, a folder in it, or `all`.
    pub(crate) place: String,
    pub(crate) files: usize,
    pub(crate) words: usize,
    /// Words outside of fenced code and tables.
    pub(crate) prose_words: usize,
    /// `you`, `your`, `yours` and `yourself` in prose.
    pub(crate) you: usize,
    pub(crate) you_per_thousand: f64,
}

/// A document, in its parts.
#[derive(Debug)]
pub(crate) struct Markdown {
    words: usize,
    prose: String,
    tables: String,
}

impl Markdown {
    pub(crate) fn new(text: &str) -> Self {
        let mut this = Self { words: 0, prose: String::new(), tables: String::new() };
        let mut open: Option<String> = None;
        for line in text.lines() {
            this.words += line.split_whitespace().count();
            let start = line.trim_start();
            let fence: String = start.chars().take_while(|mark| *mark == '`' || *mark == '~').collect();
            match &open {
                // A longer fence may show a shorter one.
                Some(mark) if start.starts_with(mark.as_str()) => open = None,
                Some(_) => {}
                None if fence.len() >= 3 => open = Some(fence),
                None => {
                    let part = if start.starts_with('|') { &mut this.tables } else { &mut this.prose };
                    part.push_str(line);
                    part.push('\n');
                }
            }
        }
        this
    }

    /// Prose and tables: what is written in sentences.
    pub(crate) fn sentences(&self) -> String {
        format!("{}\n{}", self.prose, self.tables)
    }

    fn figures(&self) -> DocumentFigures {
        let words = self.prose.split(|letter: char| !letter.is_alphabetic()).map(str::to_lowercase);
        let you = words.filter(|word| matches!(word.as_str(), "you" | "your" | "yours" | "yourself")).count();
        let prose_words = self.prose.split_whitespace().count();
        DocumentFigures { files: 1, words: self.words, prose_words, you, ..DocumentFigures::default() }
    }
}

/// Figures by place.
#[derive(Debug, Default)]
pub(crate) struct Places {
    by_place: BTreeMap<String, DocumentFigures>,
    all: DocumentFigures,
}

impl Places {
    /// Adds a document; its path begins at the root.
    pub(crate) fn add(&mut self, path: &Path, markdown: &Markdown) {
        let Some(first) = path.components().next() else { return };
        let place = first.as_os_str().to_string_lossy().into_owned();
        let own = markdown.figures();
        for sum in [self.by_place.entry(place).or_default(), &mut self.all] {
            sum.files += own.files;
            sum.words += own.words;
            sum.prose_words += own.prose_words;
            sum.you += own.you;
        }
    }

    pub(crate) fn figures(self) -> Vec<DocumentFigures> {
        let named = self.by_place.into_iter().chain([("all".to_owned(), self.all)]);
        named.map(|(place, sum)| DocumentFigures { place, you_per_thousand: per_thousand(&sum), ..sum }).collect()
    }
}

/// With one decimal.
fn per_thousand(sum: &DocumentFigures) -> f64 {
    (10_000.0 * sum.you as f64 / sum.prose_words.max(1) as f64).round() / 10.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_reader_is_addressed_in_prose_only() {
        let text = "# You\n\nYour youth, `a`.\n\n| you | b |\n````sh\n```\nyou\n```\nyou\n````\nyourself\n";
        let mut places = Places::default();
        places.add(Path::new("docs/a.md"), &Markdown::new(text));
        places.add(Path::new("README.md"), &Markdown::new("nobody here"));
        let found = places.figures();
        let names: Vec<_> = found.iter().map(|each| each.place.as_str()).collect();
        assert_eq!(names, ["README.md", "docs", "all"]);
        assert_eq!((found[1].prose_words, found[1].you, found[1].you_per_thousand), (6, 3, 500.0));
        assert_eq!(found[2].words, found[0].words + found[1].words);
    }
}
