//! The elements of a URDF file, with their lines. Text between tags means nothing in URDF.

use roxmltree::{Document, Error, Node};

use super::UrdfError;

/// The tree of a file's text.
///
/// # Errors
/// A text that is not XML.
pub(super) fn document(text: &str) -> Result<Document<'_>, UrdfError> {
    Document::parse(text).map_err(|error| match error {
        // the reader's place is where the element begins; what is missing is missing at the end
        Error::UnclosedRootNode | Error::UnexpectedEndOfStream | Error::NoRootNode => {
            UrdfError { line: text.lines().count() + 1, cause: "the file ends within an element".to_owned() }
        }
        other => UrdfError { line: other.pos().row as usize, cause: other.to_string() },
    })
}

/// An element.
#[derive(Clone, Copy, Debug)]
pub(super) struct Element<'d>(Node<'d, 'd>);

impl<'d> Element<'d> {
    /// The file's outermost element.
    pub(super) fn root(document: &'d Document<'_>) -> Self {
        Self(document.root_element())
    }

    /// Its name, without a namespace.
    pub(super) fn name(self) -> &'d str {
        self.0.tag_name().name()
    }

    /// The line it begins in, from 1.
    pub(super) fn line(self) -> usize {
        self.0.document().text_pos_at(self.0.range().start).row as usize
    }

    fn children(self) -> impl Iterator<Item = Self> {
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

    /// An element that it must have.
    pub(super) fn needed(self, name: &str) -> Result<Self, UrdfError> {
        self.child(name).ok_or_else(|| self.wrong(format!("<{}> needs a <{name}>", self.name())))
    }

    /// Its first child of any name.
    pub(super) fn first(self) -> Option<Self> {
        self.children().next()
    }

    /// An attribute.
    pub(super) fn attribute(self, key: &str) -> Option<&'d str> {
        self.0.attribute(key)
    }

    /// An attribute that it must have.
    pub(super) fn text(self, key: &str) -> Result<&'d str, UrdfError> {
        self.attribute(key).ok_or_else(|| self.wrong(format!("<{}> needs `{key}`", self.name())))
    }

    /// A finite number.
    pub(super) fn number(self, key: &str) -> Result<f64, UrdfError> {
        let text = self.text(key)?;
        let number = text.trim().parse().ok().filter(|number: &f64| number.is_finite());
        number.ok_or_else(|| self.wrong(format!("`{key}` must be a number, not \"{text}\"")))
    }

    /// Three finite numbers, or what they are if nothing is written.
    pub(super) fn triple(self, key: &str, preset: [f64; 3]) -> Result<[f64; 3], UrdfError> {
        let Some(text) = self.attribute(key) else { return Ok(preset) };
        let numbers: Vec<f64> = text.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        let triple = <[f64; 3]>::try_from(numbers).ok().filter(|triple| triple.iter().all(|number| number.is_finite()));
        triple.ok_or_else(|| self.wrong(format!("`{key}` must be three numbers, not \"{text}\"")))
    }

    /// A fault at this element.
    pub(super) fn wrong(self, cause: String) -> UrdfError {
        UrdfError { line: self.line(), cause }
    }
}
