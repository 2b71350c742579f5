//! The texts of the files that a scenario is made of, one behind the other, so that a place says of which file it is.

use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::error::{ScenarioError, wrong};

/// Texts of files: the scenario's own first, then those of its bases.
#[derive(Clone, Debug, Default)]
pub(crate) struct Texts {
    all: String,
    parts: Vec<Part>,
}

#[derive(Clone, Debug)]
struct Part {
    path: PathBuf,
    place: Range<usize>,
}

impl Texts {
    /// The text of one file.
    pub(crate) fn of(path: PathBuf, text: String) -> Self {
        Self { parts: vec![Part { path, place: 0..text.len() }], all: text }
    }

    /// Adds a file. Places in it are moved by the number that this returns.
    pub(crate) fn add(&mut self, path: PathBuf, text: &str) -> usize {
        // Lines of two files never become one.
        self.all.push('\n');
        let start = self.all.len();
        self.all.push_str(text);
        self.parts.push(Part { path, place: start..self.all.len() });
        start
    }

    /// All of them. Places of the scenario are places in this text.
    pub(crate) fn text(&self) -> &str {
        &self.all
    }

    /// The text of the file that was added last.
    pub(crate) fn last(&self) -> &str {
        self.parts.last().map_or("", |part| &self.all[part.place.clone()])
    }

    /// The texts with their starts, in the order in which they were added.
    pub(crate) fn parts(&self) -> impl DoubleEndedIterator<Item = (usize, &str)> + ExactSizeIterator {
        self.parts.iter().map(|part| (part.place.start, &self.all[part.place.clone()]))
    }

    /// The files, in the order in which they were added.
    pub(crate) fn paths(&self) -> impl Iterator<Item = &Path> {
        self.parts.iter().map(|part| part.path.as_path())
    }

    /// A place as `FILE:LINE:COLUMN`, in the file where it is; counted from 1, columns in characters.
    pub(crate) fn line_and_column(&self, place: usize) -> String {
        let holds = |part: &&Part| (part.place.start..=part.place.end).contains(&place);
        let Some(part) = self.parts.iter().find(holds) else { return String::new() };
        let before = &self.all[part.place.start..place];
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or("").chars().count() + 1;
        format!("{}:{line}:{column}", part.path.display())
    }

    /// An error at a place, in the file where it is; without a place, in the first.
    pub(crate) fn wrong(&self, message: String, place: Option<Range<usize>>, help: Option<String>) -> ScenarioError {
        let start = place.as_ref().map_or(0, |place| place.start);
        let holds = |part: &&Part| (part.place.start..=part.place.end).contains(&start);
        let Some(part) = self.parts.iter().find(holds) else { return wrong(Path::new(""), "", message, None, help) };
        let text = &self.all[part.place.clone()];
        let within = place.map(|place| {
            let end = place.end.clamp(start, part.place.end);
            start - part.place.start..end - part.place.start
        });
        wrong(&part.path, text, message, within, help)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a person sees of an error: the file and the text at its place.
    fn shown(error: &ScenarioError) -> String {
        let ScenarioError::Wrong { file, place: Some(place), .. } = error else { panic!("{error:?}") };
        format!("{}: {}", file.name(), &file.inner()[place.offset()..place.offset() + place.len()])
    }

    #[test]
    fn a_place_is_in_the_file_that_states_it() {
        let mut texts = Texts::of("own.toml".into(), "a = 1".to_owned());
        let start = texts.add("base.toml".into(), "b = 22\n");
        assert_eq!(shown(&texts.wrong(String::new(), Some(4..5), None)), "own.toml: 1");
        assert_eq!(shown(&texts.wrong(String::new(), Some(start + 4..start + 6), None)), "base.toml: 22");
        assert_eq!(texts.last(), "b = 22\n");
    }
}
