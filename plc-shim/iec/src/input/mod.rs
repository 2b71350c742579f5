//! Files as they are found in the field, to program text.
//!
//! | module | in | out |
//! |---|---|---|
//! | [`encoding`] | bytes | text, and the way back |
//! | [`kind`] | a file's name | what kind of file it is |
//! | [`found`] | a file's bytes | its text, and whether it is PLCopen's |
//! | `foreign` | text | what it is, if it is not a program |
//! | `twincat`, `twincat_task` | TwinCAT's objects | program text |
//! | `plcopen`, `plcopen_instances`, `plcopen_object` | PLCopen XML, and what CODESYS adds to it | program text |
//! | `plcopen_chart`, `plcopen_chart_graph`, `plcopen_condition` | its Sequential Function Charts | program text |
//! | `plcopen_tool` | PLCopen XML | the tool that wrote it |
//! | `plcopen_network` | its networks in LD and FBD | statements |
//! | [`layout`] | PLCopen XML | its drawings as they are laid out, for those who look at them |
//! | `drawing` | bodies that TwinCAT keeps as archives of objects: CFC, LD, FBD and SFC | statements |
//! | `statement` | statements while they are made | program text |
//! | [`project`] | a TwinCAT project | the names of its files |
//!
//! Invariants: no file can make it fail, what is wrong with one is a diagnostic; what is not read is
//! reported; every place in program text leads back into the file that it was taken out of.

mod drawing;
pub mod encoding;
mod foreign;
pub mod found;
pub mod kind;
pub mod layout;
mod needed;
mod plcopen;
mod plcopen_addition;
pub mod plcopen_chart;
pub mod plcopen_chart_graph;
pub mod plcopen_condition;
pub mod plcopen_instances;
mod plcopen_network;
pub mod plcopen_object;
mod plcopen_tool;
pub mod project;
mod statement;
mod twincat;
mod twincat_task;

use std::sync::Arc;

use onescan_xml::{Element, Node, XmlError};

use self::encoding::Encoding;
use self::foreign::Foreign;
use self::found::{Found, NoText};
use self::kind::SourceKind;
pub use self::needed::needed;
use self::project::{Listed, Listing};
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::{Chosen, Dialect, WordSize};
use crate::source::LineColumn;
use crate::source::origin::Extract;
use crate::syntax::{FileId, SourceFile, SourceMap, Span};

/// A file's program text.
#[derive(Debug, Clone)]
pub struct Input {
    file: SourceFile,
    encoding: Option<Encoding>,
    diagnostics: Vec<Diagnostic>,
    owner: Owner,
    /// True if what it declares is used, whether a task says so or not.
    is_used: bool,
}

/// Whose file it is.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Owner {
    Program,
    /// A library, whose names are known by this namespace, too, if it has one.
    Library(Option<String>),
}

impl Input {
    /// Reads the bytes of the file `name`.
    pub fn read(name: &str, kind: SourceKind, bytes: &[u8]) -> Self {
        Self::found(name, Found::decode(kind, bytes))
    }

    /// Takes the file `name` as it was found.
    pub fn found(name: &str, found: Found) -> Self {
        Self::found_in(None, name, found)
    }

    /// Takes the file `name` of a library as it was found. Its names are known with its namespace before them, and
    /// without. Program text says for itself which namespace it is in.
    pub fn of_library(namespace: Option<&str>, name: &str, found: Found) -> Self {
        let owner = Owner::Library(namespace.map(str::to_owned));
        Self { owner, ..Self::found_in(namespace, name, found) }
    }

    fn found_in(namespace: Option<&str>, name: &str, found: Found) -> Self {
        match found.text {
            Ok((text, encoding)) => Self { encoding: Some(encoding), ..Self::taken(namespace, name, found.kind, text) },
            Err(NoText { code, message }) => Self::unreadable(name, code, message),
        }
    }

    /// Takes the text of the file `name`.
    pub fn from_text(name: &str, kind: SourceKind, text: impl Into<Arc<str>>) -> Self {
        Self::taken(None, name, kind, text.into())
    }

    /// A file of the program itself.
    fn of_program(file: SourceFile, diagnostics: Vec<Diagnostic>) -> Self {
        Self { file, encoding: None, diagnostics, owner: Owner::Program, is_used: false }
    }

    fn taken(namespace: Option<&str>, name: &str, kind: SourceKind, text: Arc<str>) -> Self {
        let read = match kind {
            SourceKind::Text => {
                if let Some(foreign) = foreign::recognise(&text) {
                    return Self::holding_no_program(name, &text, foreign);
                }
                let (dialect, word_size, diagnostics) = dialect_of(name, &text);
                let file = SourceFile::new(name, text).in_dialect(dialect).for_words(word_size);
                return Self::of_program(file, diagnostics);
            }
            SourceKind::TwinCat => twincat::extract(&text, namespace),
            SourceKind::PlcOpen => plcopen::extract(&text),
        };
        let taken = read.unwrap_or_else(|error| Taken::malformed(&error));
        let (extracted, origin) = taken.extract.finish(text);
        let file = SourceFile::extracted(name, extracted, origin).in_dialect(taken.dialect);
        Self::of_program(file, taken.diagnostics)
    }

    fn holding_no_program(name: &str, text: &Arc<str>, foreign: Foreign) -> Self {
        let mut taken = Taken::default();
        let start = (text.len() - text.trim_start().len()) as u32;
        let first = text[start as usize..].chars().next().map_or(0, |first| first.len_utf8() as u32);
        taken.report(start..start + first, Code::NotProgramText, &format!("this is {}, not a program", foreign.what));
        for found in &mut taken.diagnostics {
            found.help = foreign.help.map(str::to_owned);
        }
        let (extracted, origin) = taken.extract.finish(text.clone());
        let file = SourceFile::extracted(name, extracted, origin).in_dialect(Dialect::of_file(name));
        Self::of_program(file, taken.diagnostics)
    }

    /// A project that lists files that are not there: each is reported at its place. What is missed of them is an error
    /// where it is used.
    pub fn with_missing_files(name: &str, listing: &Listing, missing: &[&Listed]) -> Self {
        let mut taken = Taken::default();
        for file in missing {
            let message = format!("`{}` is not there", file.path);
            let help = "add the file, or take it out of the project; all others are read";
            taken.warn(file.place.clone(), Code::MissingFile, &message, Some(help));
        }
        let (extracted, origin) = taken.extract.finish(listing.text.clone());
        Self::of_program(SourceFile::extracted(name, extracted, origin), taken.diagnostics)
    }

    /// A file of which nothing is read.
    pub fn unreadable(name: &str, code: Code, message: impl Into<String>) -> Self {
        let found = Diagnostic::error(code, Span::new(UNNUMBERED, 0, 0), message);
        Self::of_program(SourceFile::new(name, ""), vec![found])
    }

    /// The same file, read as `dialect` whatever its name says.
    #[must_use]
    pub fn in_dialect(self, dialect: Dialect) -> Self {
        Self { file: self.file.in_dialect(dialect), ..self }
    }

    /// The same file for a target with registers of this size, whatever its text says.
    #[must_use]
    pub fn for_words(self, word_size: WordSize) -> Self {
        Self { file: self.file.for_words(word_size), ..self }
    }

    /// The same file as a scenario or a command line wants it read; what they leave open is as the file says.
    #[must_use]
    pub fn read_as(self, dialect: Option<Dialect>, word_size: Option<WordSize>) -> Self {
        let file = self.file;
        let dialect = dialect.unwrap_or(file.dialect());
        let word_size = word_size.unwrap_or(file.word_size());
        Self { file: file.in_dialect(dialect).for_words(word_size), ..self }
    }

    /// The same file, read as `other` is.
    #[must_use]
    pub fn read_like(self, other: &SourceFile) -> Self {
        Self { file: self.file.read_like(other), ..self }
    }

    /// Its program text.
    pub fn file(&self) -> &SourceFile {
        &self.file
    }

    /// How the file is written; nothing if it was never bytes.
    pub fn encoding(&self) -> Option<Encoding> {
        self.encoding
    }

    /// Bytes of the program text where `was` begins at a place, as its author sees the file; nothing if it does not stand
    /// there.
    pub fn range_of(&self, place: LineColumn, was: &str) -> Option<std::ops::Range<u32>> {
        let starts = self.file().text().match_indices(was).map(|(start, _)| start as u32);
        let start = starts.into_iter().find(|start| self.file().line_column(*start) == place)?;
        Some(start..start + was.len() as u32)
    }

    /// The same file with another text for a part of its program text.
    pub fn with_replaced(&self, range: std::ops::Range<u32>, text: &str) -> Self {
        Self { file: self.file.with_replaced(range, text), ..self.clone() }
    }

    /// The same, of which a caller uses all, as tests that no task runs: its errors are never left out.
    #[must_use]
    pub fn used(self, is_used: bool) -> Self {
        Self { is_used, ..self }
    }

    /// See [`used`](Self::used).
    pub fn is_used(&self) -> bool {
        self.is_used
    }

    /// Adds the file to `sources`; gives its number there, and what is wrong with it.
    pub fn add_to(self, sources: &mut SourceMap) -> (FileId, Vec<Diagnostic>) {
        let mut diagnostics = self.diagnostics;
        let id = sources.add(self.file);
        for found in &mut diagnostics {
            found.span.file = id;
        }
        (id, diagnostics)
    }
}

/// Stands in a span until its file has a number.
const UNNUMBERED: FileId = FileId(0);

/// Program text while it is taken out of a file, and what is wrong with it.
#[derive(Debug, Default)]
struct Taken {
    extract: Extract,
    dialect: Dialect,
    diagnostics: Vec<Diagnostic>,
}

impl Taken {
    fn malformed(error: &XmlError) -> Self {
        let mut taken = Self::default();
        taken.report(error.at..error.at, Code::MalformedXml, &error.to_string());
        taken
    }

    /// Reports what stands at `place` of the file.
    fn report(&mut self, place: std::ops::Range<u32>, code: Code, message: &str) {
        // A blank stands in the program text for the place that the finding is about.
        let start = self.extract.text().len() as u32;
        self.extract.instead("\n", place);
        let span = Span::new(UNNUMBERED, start, start + 1);
        self.diagnostics.push(Diagnostic::error(code, span, message));
    }

    /// The same of what the program runs without.
    fn warn(&mut self, place: std::ops::Range<u32>, code: Code, message: &str, help: Option<&str>) {
        let start = self.extract.text().len() as u32;
        self.extract.instead("\n", place);
        let span = Span::new(UNNUMBERED, start, start + 1);
        self.diagnostics.push(Diagnostic::warning(code, span, message).with_optional_help(help.map(str::to_owned)));
    }

    fn unsupported(&mut self, place: std::ops::Range<u32>, what: &str) {
        self.report(place, Code::UnsupportedFeature, &format!("{what} is not supported yet"));
    }

    /// Appends the text that an element holds.
    fn text_of(&mut self, file: &str, element: &Element) {
        for node in &element.children {
            match node {
                Node::Verbatim(span) => self.extract.verbatim(file, span.clone()),
                Node::Reference(character, span) => self.extract.instead(&character.to_string(), span.clone()),
                Node::Element(_) => {}
            }
        }
    }
}

/// The dialect that plain text names itself, or else the one of its file's name, and the target's word size.
fn dialect_of(name: &str, text: &str) -> (Dialect, WordSize, Vec<Diagnostic>) {
    let of_name = Dialect::of_file(name);
    match Chosen::in_text(text) {
        // A text that names no size is for the usual target.
        Chosen::Dialect(dialect, word_size) => (dialect, word_size.unwrap_or_default(), Vec::new()),
        Chosen::Nothing => (of_name, WordSize::default(), Vec::new()),
        Chosen::Unknown(message, place) => {
            let span = Span::new(UNNUMBERED, place.start, place.end);
            (of_name, WordSize::default(), vec![Diagnostic::error(Code::WrongDialect, span, message)])
        }
    }
}
