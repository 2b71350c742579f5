//! Figures about the sources and documents: how large, how much explained, in which words.
//!
//! | module | subject |
//! |---|---|
//! | `package` | the sources of one package |
//! | `document` | Markdown: its words, and how often it addresses its reader |
//! | `sentence` | turns of phrase that a native writer does not use |
//! | `old_word` | words of our own that the field's words replace |
//! | `table` | all of it for people |

mod document;
mod old_word;
mod package;
mod sentence;
pub(crate) mod table;

use std::path::Path;

use serde::Serialize;

use crate::error::TaskError;
use crate::rust::doc::{blocks, comments};
use crate::rust::package::package as files_of;
use crate::rust::token::{Kind, Token};
use crate::workspace::{files, members, read, sources};

use document::{DocumentFigures, Markdown};
use old_word::{OldWord, Words};
use package::{PackageFigures, Tally};
use sentence::Sentence;

/// The list of old words, from the root of the repository.
const OLD_WORDS: &str = "tests/house/old_words.txt";

/// Everything that is measured.
#[derive(Debug, Serialize)]
pub(crate) struct Measured {
    /// Per member of the workspace, in its order.
    pub(crate) packages: Vec<PackageFigures>,
    pub(crate) whole: PackageFigures,
    /// Per document of the root and per folder of it, then all.
    pub(crate) documents: Vec<DocumentFigures>,
    pub(crate) sentences: Vec<Sentence>,
    pub(crate) old_words: Vec<OldWord>,
}

/// Where a text stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Place {
    /// A name in code.
    Code,
    Comment,
    Doc,
    /// A string in code.
    Text,
    Markdown,
}

/// Measures the repository at `root`.
///
/// # Errors
/// A file cannot be read.
pub(crate) fn measure(root: &Path) -> Result<Measured, TaskError> {
    let mut sentences = Sentence::all();
    let list = root.join(OLD_WORDS);
    let mut old_words = old_word::listed(&list, &read(&list)?)?;
    let mut words = Words::default();
    let (mut packages, mut whole) = (Vec::new(), Tally::default());
    for (member, paths) in sources(root, &members(root)?)? {
        let mut own = Tally::default();
        for file in files_of(root, &member, &paths)? {
            own.add(&file);
            let product: &[Token] = if file.is_test { &[] } else { &file.source.tokens };
            for (place, text) in texts(product) {
                sentence::count(&mut sentences, place, &text);
            }
            for (place, text) in texts(&file.source.whole).chain(names(&file.source.whole)) {
                words.add(place, &text);
            }
        }
        whole.merge(&own);
        packages.push(own.figures(&member.name));
    }
    let mut documents = document::Places::default();
    for path in files(root, "md")? {
        let markdown = Markdown::new(&read(&path)?);
        documents.add(path.strip_prefix(root).unwrap_or(&path), &markdown);
        let text = markdown.sentences();
        sentence::count(&mut sentences, Place::Markdown, &text);
        words.add(Place::Markdown, &text);
    }
    for word in &mut old_words {
        word.count(&words);
    }
    let whole = whole.figures("all");
    Ok(Measured { packages, whole, documents: documents.figures(), sentences, old_words })
}

/// Comments, docs and strings; a sentence may continue from one line of a block of comments on the next.
fn texts(tokens: &[Token]) -> impl Iterator<Item = (Place, String)> {
    let strings = tokens.iter().filter_map(|token| match &token.kind {
        Kind::Text(text) => Some((Place::Text, text.clone())),
        _ => None,
    });
    let comments = comments(tokens).into_iter().map(|text| (Place::Comment, text));
    comments.chain(blocks(tokens).into_iter().map(|text| (Place::Doc, text))).chain(strings)
}

fn names(tokens: &[Token]) -> impl Iterator<Item = (Place, String)> {
    tokens.iter().filter_map(|token| match &token.kind {
        Kind::Word(word) => Some((Place::Code, word.clone())),
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workspace::root;

    #[test]
    fn this_repository_is_measured() {
        let measured = measure(&root()).unwrap();
        assert_eq!(measured.packages.len(), members(&root()).unwrap().len());
        assert!(measured.whole.source_lines > 100_000 && measured.whole.test_lines > 10_000);
        assert!(measured.documents.last().unwrap().words > 10_000);
        let own = measured.packages.iter().find(|own| own.name == "onescan-xtask").unwrap();
        assert_eq!((own.files, own.source_lines), (0, 0), "all of it counts as tests");
        assert!(serde_json::to_string(&measured).unwrap().contains("\"old_words\""));
        assert!(table::markdown(&measured).contains(&format!("| {} |", measured.packages[0].name)));
    }
}
