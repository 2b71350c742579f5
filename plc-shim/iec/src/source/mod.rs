//! Source files and places in them.
//!
//! | module | subject |
//! |---|---|
//! | [`edits`] | changes of a text: all else stays byte for byte |
//! | [`origin`] | parts of a file: the way from program text back into the file |

pub mod edits;
pub mod origin;

use std::ops::Range;
use std::sync::Arc;

use self::origin::Origin;
use crate::dialect::{Dialect, WordSize};

/// Identifies a file within its [`SourceMap`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FileId(pub u32);

/// A range of bytes in a file; `start..end`, half open.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Span {
    pub file: FileId,
    /// Offset of the first byte.
    pub start: u32,
    /// Offset after the last byte.
    pub end: u32,
}

impl Span {
    /// The range `start..end` of `file`.
    pub fn new(file: FileId, start: u32, end: u32) -> Self {
        Self { file, start, end }
    }

    /// The smallest span that covers both; `other` is taken to be in the same file.
    pub fn to(self, other: Self) -> Self {
        Self { file: self.file, start: self.start.min(other.start), end: self.end.max(other.end) }
    }

    /// Length in bytes.
    pub fn len(self) -> u32 {
        self.end.saturating_sub(self.start)
    }

    /// True for a span that marks a place between two bytes.
    pub fn is_empty(self) -> bool {
        self.len() == 0
    }
}

/// One file of program text. Of a file that holds program text among other things it has the
/// program text, and shows places in the file.
#[derive(Debug, Clone)]
pub struct SourceFile {
    name: String,
    text: Arc<str>,
    origin: Option<Origin>,
    dialect: Dialect,
    word_size: WordSize,
    /// Of the text that is shown.
    line_starts: Vec<u32>,
}

impl SourceFile {
    /// Takes the text and notes where its lines begin.
    pub fn new(name: impl Into<String>, text: impl Into<Arc<str>>) -> Self {
        let text = text.into();
        let line_starts = line_starts(&text);
        let (dialect, word_size) = (Dialect::default(), WordSize::default());
        Self { name: name.into(), text, origin: None, dialect, word_size, line_starts }
    }

    /// Takes program text that was taken out of a file.
    pub fn extracted(name: impl Into<String>, text: impl Into<Arc<str>>, origin: Origin) -> Self {
        let line_starts = line_starts(origin.text());
        let (dialect, word_size) = (Dialect::default(), WordSize::default());
        Self { name: name.into(), text: text.into(), origin: Some(origin), dialect, word_size, line_starts }
    }

    /// The same file, read as `dialect`.
    #[must_use]
    pub fn in_dialect(self, dialect: Dialect) -> Self {
        Self { dialect, ..self }
    }

    /// The same file, for a target with registers of this size.
    #[must_use]
    pub fn for_words(self, word_size: WordSize) -> Self {
        Self { word_size, ..self }
    }

    /// The same file in the dialect of `other`, and for its target.
    #[must_use]
    pub fn read_like(self, other: &Self) -> Self {
        self.in_dialect(other.dialect).for_words(other.word_size)
    }

    /// The same with another text for a part of its program text. Of text that was taken out of a file, places behind
    /// that part are shown where they would be without the change.
    pub(crate) fn with_replaced(&self, range: Range<u32>, text: &str) -> Self {
        let mut changed = self.text.to_string();
        let bytes = range.start as usize..range.end as usize;
        if changed.get(bytes.clone()).is_some() {
            changed.replace_range(bytes, text);
        }
        let file = match &self.origin {
            Some(origin) => Self::extracted(self.name.clone(), changed, origin.clone()),
            None => Self::new(self.name.clone(), changed),
        };
        file.read_like(self)
    }

    /// The dialect of its program text.
    pub fn dialect(&self) -> Dialect {
        self.dialect
    }

    /// Bits of the registers of the target that runs it.
    pub fn word_size(&self) -> WordSize {
        self.word_size
    }

    /// The name that diagnostics show.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The whole program text.
    pub fn text(&self) -> &Arc<str> {
        &self.text
    }

    /// The file's text as its author sees it: the program text, unless that was taken out of it.
    pub fn shown_text(&self) -> &Arc<str> {
        self.origin.as_ref().map_or(&self.text, Origin::text)
    }

    /// Where a range of the program text stands in [`Self::shown_text`].
    pub fn shown_range(&self, start: u32, end: u32) -> Range<u32> {
        self.origin.as_ref().map_or(start..end, |origin| origin.place(start..end))
    }

    /// The way back into the file that the program text was taken out of.
    pub fn origin(&self) -> Option<&Origin> {
        self.origin.as_ref()
    }

    /// Line and column of a byte offset of the program text, both counted from 1 in the text that
    /// is shown; columns count characters.
    pub fn line_column(&self, offset: u32) -> LineColumn {
        self.shown_line_column(self.shown_range(offset, offset).start)
    }

    /// Line and column of a byte offset of the text that is shown.
    pub fn shown_line_column(&self, offset: u32) -> LineColumn {
        let text = self.shown_text();
        let line = self.line_starts.partition_point(|start| *start <= offset).saturating_sub(1);
        let start = self.line_starts.get(line).copied().unwrap_or(0) as usize;
        let end = (offset as usize).min(text.len());
        let column = text.get(start..end).map_or(1, |before| before.chars().count() + 1);
        LineColumn { line: line as u32 + 1, column: column as u32 }
    }
}

fn line_starts(text: &str) -> Vec<u32> {
    let breaks = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
    std::iter::once(0).chain(breaks.map(|(at, _)| at as u32 + 1)).collect()
}

/// A place as an editor shows it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct LineColumn {
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
}

/// All files that are compiled together.
#[derive(Debug, Clone, Default)]
pub struct SourceMap {
    files: Vec<SourceFile>,
}

impl SourceMap {
    /// Adds a file.
    pub fn add(&mut self, file: SourceFile) -> FileId {
        self.files.push(file);
        FileId(self.files.len() as u32 - 1)
    }

    /// The file with this id, if the id is of this map.
    pub fn get(&self, id: FileId) -> Option<&SourceFile> {
        self.files.get(id.0 as usize)
    }

    /// All files in the order they were added.
    pub fn iter(&self) -> impl Iterator<Item = (FileId, &SourceFile)> {
        self.files.iter().enumerate().map(|(index, file)| (FileId(index as u32), file))
    }

    /// The text under a span; empty if the span is not of this map.
    pub fn text(&self, span: Span) -> &str {
        self.get(span.file).and_then(|file| file.text.get(span.start as usize..span.end as usize)).unwrap_or("")
    }

    /// File name, line and column of a span's start.
    pub fn locate(&self, span: Span) -> (&str, LineColumn) {
        self.get(span.file)
            .map_or(("", LineColumn { line: 0, column: 0 }), |file| (file.name(), file.line_column(span.start)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_columns_count_from_one_and_columns_count_characters() {
        let file = SourceFile::new("a.st", "x\näöü := 1;\n");
        assert_eq!(file.line_column(0), LineColumn { line: 1, column: 1 });
        assert_eq!(file.line_column(2), LineColumn { line: 2, column: 1 });
        assert_eq!(file.line_column(9), LineColumn { line: 2, column: 5 });
        assert_eq!(file.line_column(999), LineColumn { line: 3, column: 1 });
    }
}
