//! The elements of a list in XML, with their lines.

use std::borrow::Cow;
use std::path::Path;

use onescan_iec::input::encoding::decode;
use onescan_xml::{Lines, parse_within};

use super::error::ListError;

/// Devices are nested as deep as a fieldbus is long.
const DEPTH_MAX: usize = 1024;

/// The text of a file.
pub(super) fn text(path: &Path, bytes: &[u8]) -> Result<String, ListError> {
    let not_text = |source| ListError::NotText { file: path.display().to_string(), source };
    decode(bytes).map(|(text, _)| text).map_err(not_text)
}

/// A file's text as a tree.
pub(super) struct Document<'t> {
    root: onescan_xml::Element,
    text: &'t str,
    lines: Lines,
}

/// The tree of a file's text.
pub(super) fn document<'t>(path: &Path, text: &'t str) -> Result<Document<'t>, ListError> {
    let lines = Lines::of(text);
    match parse_within(text, DEPTH_MAX) {
        Ok(root) => Ok(Document { root, text, lines }),
        Err(error) => {
            let file = path.display().to_string();
            if error.fault.is_truncation() {
                let line = text.lines().count().max(1) as u32;
                return Err(ListError::NotXml { file, line, cause: "the file ends within an element".to_owned() });
            }
            Err(ListError::NotXml { file, line: lines.line(error.at), cause: error.to_string() })
        }
    }
}

#[derive(Clone, Copy)]
pub(super) struct Element<'d> {
    element: &'d onescan_xml::Element,
    document: &'d Document<'d>,
}

impl<'d> Element<'d> {
    pub(super) fn root(document: &'d Document<'d>) -> Self {
        Self { element: &document.root, document }
    }

    fn with(self, element: &'d onescan_xml::Element) -> Self {
        Self { element, ..self }
    }

    /// Its name, without a namespace.
    pub(super) fn name(self) -> &'d str {
        &self.element.name
    }

    /// The line it begins in, from 1.
    pub(super) fn line(self) -> u32 {
        self.document.lines.line(self.element.open.start)
    }

    /// The elements of this name in it.
    pub(super) fn all(self, name: &'static str) -> impl Iterator<Item = Self> {
        self.element.elements().filter(move |child| child.name == name).map(move |child| self.with(child))
    }

    /// The first element of this name in it.
    pub(super) fn child(self, name: &str) -> Option<Self> {
        self.element.child(name).map(|child| self.with(child))
    }

    /// The elements of this name in it, however deep, in their order.
    pub(super) fn below(self, name: &'static str) -> impl Iterator<Item = Self> {
        self.element.tree().filter(move |element| element.name == name).map(move |element| self.with(element))
    }

    /// The elements that it is in, from the inside.
    pub(super) fn around(self) -> impl Iterator<Item = Self> {
        let around = self.document.root.around(self.element.open.start);
        around.into_iter().rev().map(move |element| self.with(element))
    }

    pub(super) fn attribute(self, name: &str) -> Option<&'d str> {
        self.element.attribute(name).map(|attribute| &*attribute.value)
    }

    /// What is written in it, without what is around.
    pub(super) fn text(self) -> Cow<'d, str> {
        match self.element.text(self.document.text) {
            Cow::Borrowed(text) => Cow::Borrowed(text.trim()),
            Cow::Owned(text) => Cow::Owned(text.trim().to_owned()),
        }
    }

    /// What is written in its first element of this name.
    pub(super) fn text_of(self, name: &str) -> Option<Cow<'d, str>> {
        self.child(name).map(Self::text).filter(|text| !text.is_empty())
    }
}
