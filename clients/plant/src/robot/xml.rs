//! XML of robots' files as a tree of its own, in which each element and each attribute knows its place.
//!
//! The tree owns what it has: a macro's body stands in many places of the expanded robot. Text between
//! tags means nothing in URDF, xacro and MJCF, and is left out.

use std::ops::Range;
use std::sync::Arc;

use roxmltree::{Document, Error, Node};

use crate::file_place::{Place, Source};

/// Deepest nesting of elements; robots have a tenth of it.
const DEPTH_MAX: usize = 128;

impl Place {
    /// A fault at this place.
    pub(super) fn wrong(&self, cause: impl Into<String>) -> RobotFault {
        RobotFault { place: self.clone(), cause: cause.into(), hint: None }
    }
}

/// What is wrong with a robot's file, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RobotFault {
    /// Where.
    pub place: Place,
    /// What is wrong.
    pub cause: String,
    /// What could be done.
    pub hint: Option<String>,
}

impl RobotFault {
    /// The fault with what could be done.
    pub(super) fn hinted(self, hint: impl Into<String>) -> Self {
        Self { hint: Some(hint.into()), ..self }
    }
}

impl std::fmt::Display for RobotFault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "line {}: {}", self.place.start().line, self.cause)?;
        self.hint.as_ref().map_or(Ok(()), |hint| write!(f, " ({hint})"))
    }
}

/// An attribute.
#[derive(Clone, Debug, PartialEq)]
pub struct Attribute {
    pub(super) key: String,
    pub(super) value: String,
    pub(super) place: Place,
}

/// An element.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Element {
    /// Its name, without a namespace.
    pub(super) name: String,
    /// True if it is one of xacro's own.
    pub(super) is_xacro: bool,
    pub(super) attributes: Vec<Attribute>,
    pub(super) children: Vec<Self>,
    pub(super) place: Place,
}

/// The outermost element of a file.
///
/// # Errors
/// A text that is not XML.
pub(super) fn parse(source: &Arc<Source>) -> Result<Element, RobotFault> {
    let text = &source.text;
    let at = |span: Range<usize>| Place { source: Arc::clone(source), span };
    let document = Document::parse(text).map_err(|error| match error {
        // the reader's place is where the element begins; what is missing is missing at the end
        Error::UnclosedRootNode | Error::UnexpectedEndOfStream | Error::NoRootNode => {
            at(text.len()..text.len()).wrong("the file ends within an element")
        }
        other => {
            let pos = other.pos();
            let start: usize = text.split_inclusive('\n').take(pos.row as usize - 1).map(str::len).sum();
            let line = text.get(start..).and_then(|rest| rest.lines().next()).unwrap_or_default();
            let column = line.chars().take(pos.col as usize - 1).map(char::len_utf8).sum::<usize>();
            at(start + column..start + line.len().max(column)).wrong(other.to_string())
        }
    })?;
    element(document.root_element(), source, DEPTH_MAX)
}

fn element(node: Node<'_, '_>, source: &Arc<Source>, depth: usize) -> Result<Element, RobotFault> {
    let name = node.tag_name();
    // the whole element may be a thousand lines; its first tag is what a reader looks for
    let range = node.range();
    let head =
        source.text.get(range.clone()).and_then(|whole| whole.find('>')).map_or(range.end, |at| range.start + at + 1);
    let place = Place { source: Arc::clone(source), span: range.start..head };
    if depth == 0 {
        return Err(place.wrong(format!("elements are nested more than {DEPTH_MAX} deep")));
    }
    let attributes = node.attributes().map(|attribute| Attribute {
        key: attribute.name().to_owned(),
        value: attribute.value().to_owned(),
        place: Place { source: Arc::clone(source), span: attribute.range() },
    });
    let inner = node.children().filter(Node::is_element);
    Ok(Element {
        name: name.name().to_owned(),
        is_xacro: name.namespace().is_some_and(|space| space.contains("xacro")),
        attributes: attributes.collect(),
        children: inner.map(|child| element(child, source, depth - 1)).collect::<Result<_, _>>()?,
        place,
    })
}

impl Element {
    /// The elements of this name in it.
    pub(super) fn all<'e>(&'e self, name: &'static str) -> impl Iterator<Item = &'e Self> {
        self.children.iter().filter(move |child| child.name == name)
    }

    /// The first element of this name in it.
    pub(super) fn child(&self, name: &str) -> Option<&Self> {
        self.children.iter().find(|child| child.name == name)
    }

    /// An element that it must have.
    pub(super) fn needed(&self, name: &str) -> Result<&Self, RobotFault> {
        self.child(name).ok_or_else(|| self.wrong(format!("<{}> needs a <{name}>", self.name)))
    }

    /// An attribute.
    pub(super) fn attribute(&self, key: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|attribute| attribute.key == key)
    }

    /// The text of an attribute.
    pub(super) fn get(&self, key: &str) -> Option<&str> {
        self.attribute(key).map(|attribute| attribute.value.as_str())
    }

    /// An attribute that it must have.
    pub(super) fn text(&self, key: &str) -> Result<&str, RobotFault> {
        self.get(key).ok_or_else(|| self.wrong(format!("<{}> needs `{key}`", self.name)))
    }

    /// A finite number.
    pub(super) fn number(&self, key: &str) -> Result<f64, RobotFault> {
        let text = self.text(key)?;
        let number = text.trim().parse().ok().filter(|number: &f64| number.is_finite());
        number.ok_or_else(|| self.wrong_at(key, format!("`{key}` must be a number, not \"{text}\"")))
    }

    /// A finite number, or what it is if nothing is written.
    pub(super) fn number_or(&self, key: &str, preset: f64) -> Result<f64, RobotFault> {
        if self.attribute(key).is_some() { self.number(key) } else { Ok(preset) }
    }

    /// So many finite numbers, if they are written.
    pub(super) fn numbers<const N: usize>(&self, key: &str) -> Result<Option<[f64; N]>, RobotFault> {
        let Some(text) = self.get(key) else { return Ok(None) };
        let numbers: Option<Vec<f64>> = text.split_whitespace().map(|word| word.parse().ok()).collect();
        let numbers = numbers.and_then(|numbers| <[f64; N]>::try_from(numbers).ok());
        let numbers = numbers.filter(|numbers| numbers.iter().all(|number| number.is_finite()));
        let count = ["no number", "one number", "two numbers", "three numbers", "four numbers"];
        let count = count.get(N).map_or_else(|| format!("{N} numbers"), |&count| count.to_owned());
        let wrong = || self.wrong_at(key, format!("`{key}` must be {count}, not \"{text}\""));
        numbers.map(Some).ok_or_else(wrong)
    }

    /// Three finite numbers, or what they are if nothing is written.
    pub(super) fn triple(&self, key: &str, preset: [f64; 3]) -> Result<[f64; 3], RobotFault> {
        Ok(self.numbers(key)?.unwrap_or(preset))
    }

    /// A fault at this element.
    pub(super) fn wrong(&self, cause: impl Into<String>) -> RobotFault {
        self.place.wrong(cause)
    }

    /// A fault at one of its attributes.
    pub(super) fn wrong_at(&self, key: &str, cause: impl Into<String>) -> RobotFault {
        self.attribute(key).map_or(&self.place, |attribute| &attribute.place).wrong(cause)
    }
}
