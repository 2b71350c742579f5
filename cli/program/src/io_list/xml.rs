//! The elements of a list in XML, with their lines.

use std::path::Path;

use onescan_iec::input::encoding::decode;
use roxmltree::{Document, Error, Node, ParsingOptions};

use super::error::ListError;

/// More nodes than a project of the largest size that is read can have in earnest.
const NODES_MAX: u32 = 8_000_000;

/// The text of a file.
pub(super) fn text(path: &Path, bytes: &[u8]) -> Result<String, ListError> {
    let not_text = |source| ListError::NotText { file: path.display().to_string(), source };
    decode(bytes).map(|(text, _)| text).map_err(not_text)
}

/// The tree of a file's text. A document type is refused, so there are no entities to expand.
pub(super) fn document<'t>(path: &Path, text: &'t str) -> Result<Document<'t>, ListError> {
    let options = ParsingOptions { allow_dtd: false, nodes_limit: NODES_MAX, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).map_err(|error| {
        let file = path.display().to_string();
        match error {
            // the reader's place is where the element begins; what is missing is missing at the end
            Error::UnclosedRootNode | Error::UnexpectedEndOfStream | Error::NoRootNode => ListError::NotXml {
                file,
                line: text.lines().count().max(1) as u32,
                cause: "the file ends within an element".to_owned(),
            },
            other => ListError::NotXml { file, line: other.pos().row, cause: other.to_string() },
        }
    })
}

/// Where the lines of a text begin; the reader itself would count from the start for every element.
pub(super) struct Lines(Vec<usize>);

impl Lines {
    pub(super) fn of(text: &str) -> Self {
        Self(std::iter::once(0).chain(text.match_indices('\n').map(|(end, _)| end + 1)).collect())
    }
}

/// An element.
#[derive(Clone, Copy, Debug)]
pub(super) struct Element<'d>(Node<'d, 'd>);

impl<'d> Element<'d> {
    pub(super) fn root(document: &'d Document<'_>) -> Self {
        Self(document.root_element())
    }

    /// Its name, without a namespace.
    pub(super) fn name(self) -> &'d str {
        self.0.tag_name().name()
    }

    /// The line it begins in, from 1.
    pub(super) fn line(self, lines: &Lines) -> u32 {
        lines.0.partition_point(|start| *start <= self.0.range().start) as u32
    }

    pub(super) fn children(self) -> impl Iterator<Item = Self> {
        self.0.children().filter(Node::is_element).map(Self)
    }

    /// The elements of this name in it.
    pub(super) fn all(self, name: &'static str) -> impl Iterator<Item = Self> {
        self.children().filter(move |child| child.name() == name)
    }

    /// The first element of this name in it.
    pub(super) fn child(self, name: &str) -> Option<Self> {
        self.children().find(|child| child.name() == name)
    }

    /// The elements of this name in it, however deep, in their order.
    pub(super) fn below(self, name: &'static str) -> impl Iterator<Item = Self> {
        self.0.descendants().filter(move |node| node.is_element() && node.tag_name().name() == name).map(Self)
    }

    /// The elements that it is in, from the inside.
    pub(super) fn around(self) -> impl Iterator<Item = Self> {
        self.0.ancestors().skip(1).filter(Node::is_element).map(Self)
    }

    pub(super) fn attribute(self, name: &str) -> Option<&'d str> {
        self.0.attribute(name)
    }

    /// What is written in it, without what is around.
    pub(super) fn text(self) -> &'d str {
        // A comment in CDATA stands behind white space, which is a text of its own.
        let texts = self.0.children().filter(Node::is_text).filter_map(|node| node.text());
        texts.map(str::trim).find(|text| !text.is_empty()).unwrap_or_default()
    }

    /// What is written in its first element of this name.
    pub(super) fn text_of(self, name: &str) -> Option<&'d str> {
        self.child(name).map(Self::text).filter(|text| !text.is_empty())
    }
}
