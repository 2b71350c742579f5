//! The code that computed a state: sources as the compiler reads them, the standard library, constants set
//! from outside.
//!
//! Comments and white space are not part of it, nor is the case of names: a state stays valid when they change.

use std::fmt;

use super::bytes::{Reader, Writer};
use super::{Digest, digest};
use onescan_iec::WordSize;
use onescan_iec::syntax::token::TokenKind;
use onescan_iec::syntax::{FileId, SourceFile, SourceMap, tokenize_in};

/// What an application was compiled from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Code {
    /// The project's files in their order, by name.
    files: Vec<(String, Digest)>,
    library: Digest,
    /// Constants set from outside: path and literal, by path.
    constants: Vec<(String, String)>,
}

/// In what the sources of a saved state differ from those of the program.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct CodeDifference {
    /// Files that both have, with other contents.
    pub changed: Vec<String>,
    /// Files of the program that the state does not know.
    pub added: Vec<String>,
    /// Files of the state that the program does not have.
    pub removed: Vec<String>,
    /// The standard library is that of another version.
    pub library: bool,
    /// Constants with other values: path, value in the state, value in the program; nothing for the value that
    /// the sources give.
    pub constants: Vec<(String, Option<String>, Option<String>)>,
}

impl Code {
    /// `is_library` identifies the files of the standard library; files that it says nothing of are left out.
    pub(in crate::application) fn new(
        sources: &SourceMap,
        is_library: impl Fn(FileId) -> Option<bool>,
        mut constants: Vec<(String, String)>,
    ) -> Self {
        let (mut files, mut library) = (Vec::new(), blake3::Hasher::new());
        for (id, file) in sources.iter() {
            match is_library(id) {
                // It comes with the program, so there is nothing to forgive.
                Some(true) => {
                    library.update(&digest(file.text().as_bytes()));
                }
                Some(false) => files.push((file.name().to_owned(), of_file(file))),
                None => {}
            }
        }
        constants.sort();
        Self { files, library: library.finalize().into(), constants }
    }

    /// Equal for equal code, whatever its files are called.
    pub(crate) fn digest(&self) -> Digest {
        let mut writer = Writer::default();
        writer.count(self.files.len());
        self.files.iter().for_each(|(_, contents)| writer.raw(contents));
        writer.raw(&self.library);
        self.constants.iter().for_each(|(path, literal)| {
            writer.text(path);
            writer.text(literal);
        });
        digest(&writer.finish())
    }

    pub(crate) fn encode(&self) -> Vec<u8> {
        let mut writer = Writer::default();
        writer.count(self.files.len());
        for (name, contents) in &self.files {
            writer.text(name);
            writer.raw(contents);
        }
        writer.raw(&self.library);
        writer.count(self.constants.len());
        for (path, literal) in &self.constants {
            writer.text(path);
            writer.text(literal);
        }
        writer.finish()
    }

    /// Nothing unless the bytes are those of a code.
    pub(crate) fn decode(bytes: &[u8]) -> Option<Self> {
        let mut reader = Reader::new(bytes);
        let files = reader.list(|reader| Some((reader.text()?, reader.array()?)))?;
        let library = reader.array()?;
        let constants = reader.list(|reader| Some((reader.text()?, reader.text()?)))?;
        reader.is_at_end().then_some(Self { files, library, constants })
    }

    /// In what the code of a state is another.
    pub(crate) fn difference(&self, saved: &Self) -> CodeDifference {
        let mut found = CodeDifference { library: self.library != saved.library, ..CodeDifference::default() };
        for (name, contents) in &self.files {
            match saved.files.iter().find(|(other, _)| other == name) {
                Some((_, before)) if before == contents => {}
                Some(_) => found.changed.push(name.clone()),
                None => found.added.push(name.clone()),
            }
        }
        let is_gone = |(name, _): &&(String, Digest)| !self.files.iter().any(|(other, _)| other == name);
        found.removed.extend(saved.files.iter().filter(is_gone).map(|(name, _)| name.clone()));
        let value_in = |code: &Self, path: &str| {
            code.constants.iter().find(|(other, _)| other == path).map(|(_, literal)| literal.clone())
        };
        let mut paths: Vec<&String> = self.constants.iter().chain(&saved.constants).map(|(path, _)| path).collect();
        paths.sort();
        paths.dedup();
        for path in paths {
            let (before, now) = (value_in(saved, path), value_in(self, path));
            if before != now {
                found.constants.push((path.clone(), before, now));
            }
        }
        found
    }
}

/// A digest of what a file says to the compiler.
fn of_file(file: &SourceFile) -> Digest {
    let mut hasher = blake3::Hasher::new();
    hasher.update(file.dialect().name().as_bytes());
    if file.word_size() != WordSize::default() {
        hasher.update(&file.word_size().bits().to_le_bytes());
    }
    for token in tokenize_in(file.dialect(), file.text()) {
        let text = file.text().get(token.start as usize..token.end as usize).unwrap_or_default();
        match token.kind {
            TokenKind::Whitespace | TokenKind::BlockComment | TokenKind::LineComment => continue,
            TokenKind::Identifier | TokenKind::Keyword(_) => hasher.update(text.to_ascii_uppercase().as_bytes()),
            // Strings keep their case, and so do pragmas, which may decide what is compiled.
            _ => hasher.update(text.as_bytes()),
        };
        // Else `a b` would be `ab`.
        hasher.update(&[0]);
    }
    hasher.finalize().into()
}

/// `shear.st has changed, drive.st is new`
impl fmt::Display for CodeDifference {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { changed, added, removed, library, constants } = self;
        let files = [(changed, "has changed"), (added, "is new"), (removed, "is gone")];
        let mut said: Vec<String> =
            files.iter().flat_map(|(names, what)| names.iter().map(move |name| format!("{name} {what}"))).collect();
        said.extend(constants.iter().map(|(path, before, now)| {
            let shown = |value: &Option<String>| value.clone().unwrap_or_else(|| "as declared".to_owned());
            format!("constant `{path}` was {} and is {}", shown(before), shown(now))
        }));
        if *library {
            said.push("the standard library is of another version".to_owned());
        }
        if said.is_empty() {
            said.push("the order of the files has changed".to_owned());
        }
        formatter.write_str(&said.join(", "))
    }
}
