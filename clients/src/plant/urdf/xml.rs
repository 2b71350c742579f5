//! The elements of a URDF file, with their lines. Text between tags means nothing in URDF.

use quick_xml::Reader;
use quick_xml::XmlVersion;
use quick_xml::events::{BytesStart, Event};

use super::UrdfError;

/// Greatest depth of elements; URDF itself has five levels.
const DEPTH_MAX: usize = 32;

/// An element.
#[derive(Debug, Default)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) line: usize,
    attributes: Vec<(String, String)>,
    children: Vec<Element>,
}

impl Element {
    /// The file's outermost element.
    pub(super) fn parse(text: &str) -> Result<Self, UrdfError> {
        let mut reader = Reader::from_str(text);
        let mut open = vec![Self::default()];
        let line_at = |byte: u64| text.as_bytes().iter().take(byte as usize).filter(|byte| **byte == b'\n').count() + 1;
        loop {
            let line = line_at(reader.buffer_position());
            let wrong = |cause: String| UrdfError { line, cause };
            match reader.read_event().map_err(|error| wrong(error.to_string()))? {
                Event::Start(_) if open.len() > DEPTH_MAX => {
                    return Err(wrong("elements too deep in each other".into()));
                }
                Event::Start(tag) => open.push(Self::of(&tag, line)?),
                Event::Empty(tag) => {
                    let element = Self::of(&tag, line)?;
                    close(&mut open, element);
                }
                Event::End(_) => {
                    if let Some(element) = open.pop() {
                        close(&mut open, element);
                    }
                }
                Event::Eof => break,
                _ => {}
            }
        }
        let unclosed = open.len() > 1;
        let document = open.swap_remove(0);
        let line = line_at(text.len() as u64);
        match document.children.into_iter().next() {
            Some(root) if !unclosed => Ok(root),
            _ => Err(UrdfError { line, cause: "the file ends within an element".to_owned() }),
        }
    }

    fn of(tag: &BytesStart<'_>, line: usize) -> Result<Self, UrdfError> {
        let wrong = |cause: String| UrdfError { line, cause };
        let mut attributes = Vec::new();
        for attribute in tag.attributes() {
            let attribute = attribute.map_err(|error| wrong(error.to_string()))?;
            let value =
                attribute.normalized_value(XmlVersion::Implicit1_0).map_err(|error| wrong(error.to_string()))?;
            let key: &str = attribute.key.as_ref();
            attributes.push((key.to_owned(), value.into_owned()));
        }
        Ok(Self { name: tag.local_name().as_ref().to_owned(), line, attributes, children: Vec::new() })
    }

    /// The elements of this name in it.
    pub(super) fn all<'e>(&'e self, name: &'e str) -> impl Iterator<Item = &'e Self> {
        self.children.iter().filter(move |child| child.name == name)
    }

    /// The first element of this name in it.
    pub(super) fn child(&self, name: &str) -> Option<&Self> {
        self.children.iter().find(|child| child.name == name)
    }

    /// An element that it must have.
    pub(super) fn needed(&self, name: &str) -> Result<&Self, UrdfError> {
        self.child(name).ok_or_else(|| self.wrong(format!("<{}> needs a <{name}>", self.name)))
    }

    /// Its first child of any name.
    pub(super) fn first(&self) -> Option<&Self> {
        self.children.first()
    }

    /// An attribute.
    pub(super) fn attribute(&self, key: &str) -> Option<&str> {
        self.attributes.iter().find(|(known, _)| known == key).map(|(_, value)| value.as_str())
    }

    /// An attribute that it must have.
    pub(super) fn text(&self, key: &str) -> Result<&str, UrdfError> {
        self.attribute(key).ok_or_else(|| self.wrong(format!("<{}> needs `{key}`", self.name)))
    }

    /// A finite number.
    pub(super) fn number(&self, key: &str) -> Result<f64, UrdfError> {
        let text = self.text(key)?;
        let number = text.trim().parse().ok().filter(|number: &f64| number.is_finite());
        number.ok_or_else(|| self.wrong(format!("`{key}` must be a number, not \"{text}\"")))
    }

    /// Three finite numbers, or what they are if nothing is written.
    pub(super) fn triple(&self, key: &str, preset: [f64; 3]) -> Result<[f64; 3], UrdfError> {
        let Some(text) = self.attribute(key) else { return Ok(preset) };
        let numbers: Vec<f64> = text.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        let triple = <[f64; 3]>::try_from(numbers).ok().filter(|triple| triple.iter().all(|number| number.is_finite()));
        triple.ok_or_else(|| self.wrong(format!("`{key}` must be three numbers, not \"{text}\"")))
    }

    /// A fault at this element.
    pub(super) fn wrong(&self, cause: String) -> UrdfError {
        UrdfError { line: self.line, cause }
    }
}

fn close(open: &mut [Element], element: Element) {
    if let Some(parent) = open.last_mut() {
        parent.children.push(element);
    }
}
