//! XML to a tree whose nodes know where they stand in the file.

use std::ops::Range;

use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};

/// Greatest depth of elements.
const MAX_DEPTH: usize = 100;

/// An element.
#[derive(Debug, Default)]
pub struct Element {
    /// Its name without a prefix.
    pub name: String,
    pub(crate) attributes: Vec<Attribute>,
    pub(crate) children: Vec<Node>,
    /// Its opening tag.
    pub open: Range<u32>,
    /// Its closing tag; the opening one of an empty element.
    pub close: Range<u32>,
}

/// `name="value"`
#[derive(Debug)]
pub struct Attribute {
    pub(crate) name: String,
    pub value: String,
    /// Where the value stands.
    pub span: Range<u32>,
}

/// What an element holds.
#[derive(Debug)]
pub(crate) enum Node {
    Element(Element),
    /// Text that stands in the file as it is meant.
    Verbatim(Range<u32>),
    /// A character that is written otherwise, as in `&lt;`.
    Reference(char, Range<u32>),
}

/// Why a file is no XML.
#[derive(Debug)]
pub struct XmlError {
    pub(crate) at: u32,
    pub(crate) message: String,
}

impl Element {
    pub fn elements(&self) -> impl Iterator<Item = &Self> {
        self.children.iter().filter_map(|node| match node {
            Node::Element(element) => Some(element),
            _ => None,
        })
    }

    pub fn child(&self, name: &str) -> Option<&Self> {
        self.elements().find(|element| element.name == name)
    }

    pub fn into_child(self, name: &str) -> Option<Self> {
        self.children.into_iter().find_map(|node| match node {
            Node::Element(element) if element.name == name => Some(element),
            _ => None,
        })
    }

    pub fn attribute(&self, name: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|attribute| attribute.name == name)
    }

    /// The text that stands in it, of the file that it was read from.
    pub(crate) fn text(&self, file: &str) -> String {
        let mut text = String::new();
        for node in &self.children {
            match node {
                Node::Verbatim(span) => text.push_str(file.get(span.start as usize..span.end as usize).unwrap_or("")),
                Node::Reference(character, _) => text.push(*character),
                Node::Element(_) => {}
            }
        }
        text
    }
}

/// The file's outermost element.
pub fn parse(text: &str) -> Result<Element, XmlError> {
    let mut reader = Reader::from_str(text);
    // The innermost open element is the last one.
    let mut open = vec![Element::default()];
    loop {
        let start = reader.buffer_position() as u32;
        let event = reader.read_event();
        let end = reader.buffer_position() as u32;
        match event {
            Err(error) => {
                let at = text.floor_char_boundary(reader.error_position() as usize) as u32;
                return Err(XmlError { at, message: error.to_string() });
            }
            Ok(Event::Start(tag)) => {
                if open.len() > MAX_DEPTH {
                    let message = format!("elements are nested deeper than {MAX_DEPTH} levels");
                    return Err(XmlError { at: start, message });
                }
                open.push(element(text, &tag, start..end)?);
            }
            Ok(Event::Empty(tag)) => {
                let element = element(text, &tag, start..end)?;
                add(&mut open, Node::Element(element));
            }
            Ok(Event::End(_)) => {
                if let Some(mut element) = open.pop() {
                    element.close = start..end;
                    add(&mut open, Node::Element(element));
                }
            }
            Ok(Event::Text(_)) => add(&mut open, Node::Verbatim(start..end)),
            Ok(Event::CData(_)) => add(&mut open, Node::Verbatim(start + 9..end.saturating_sub(3))),
            Ok(Event::GeneralRef(reference)) => {
                let character = character(&reference);
                let unknown = || XmlError { at: start, message: format!("`&{};` is not known", &*reference) };
                add(&mut open, Node::Reference(character.ok_or_else(unknown)?, start..end));
            }
            Ok(Event::Eof) => break,
            Ok(_) => {}
        }
    }
    root(open, text)
}

fn root(mut open: Vec<Element>, text: &str) -> Result<Element, XmlError> {
    let at = text.len() as u32;
    if let [_, .., unclosed] = open.as_slice() {
        return Err(XmlError { at, message: format!("`<{}>` has no end", unclosed.name) });
    }
    let document = open.pop().unwrap_or_default();
    let root = document.children.into_iter().find_map(|node| match node {
        Node::Element(element) => Some(element),
        _ => None,
    });
    root.ok_or_else(|| XmlError { at: 0, message: "there is no element".to_owned() })
}

fn add(open: &mut [Element], node: Node) {
    if let Some(parent) = open.last_mut() {
        parent.children.push(node);
    }
}

fn element(text: &str, tag: &BytesStart<'_>, span: Range<u32>) -> Result<Element, XmlError> {
    let wrong = |message: String| XmlError { at: span.start, message };
    let mut attributes = Vec::new();
    let written = text.get(span.start as usize..span.end as usize).unwrap_or("");
    // Values are looked for in their order, each behind the one before.
    let mut from = 0;
    for attribute in tag.attributes() {
        let attribute = attribute.map_err(|error| wrong(error.to_string()))?;
        let raw: &str = &attribute.value;
        let value =
            attribute.normalized_value(XmlVersion::Implicit1_0).map_err(|error| wrong(error.to_string()))?.into_owned();
        let name: &str = attribute.key.as_ref();
        let key = written.get(from..).and_then(|rest| rest.find(name)).map_or(from, |at| from + at + name.len());
        let at = written.get(key..).and_then(|rest| rest.find(raw)).map_or(key, |at| key + at);
        from = at + raw.len();
        let at = span.start + at as u32;
        let name = name.to_owned();
        attributes.push(Attribute { name, value, span: at..at + raw.len() as u32 });
    }
    let name = tag.local_name().as_ref().to_owned();
    Ok(Element { name, attributes, children: Vec::new(), open: span.clone(), close: span })
}

/// The five that XML has, and numbers.
fn character(reference: &quick_xml::events::BytesRef<'_>) -> Option<char> {
    if let Ok(Some(character)) = reference.resolve_char_ref() {
        return Some(character);
    }
    Some(match &**reference {
        "lt" => '<',
        "gt" => '>',
        "amp" => '&',
        "quot" => '"',
        "apos" => '\'',
        // Editors of XHTML write it where a blank is meant.
        "nbsp" => ' ',
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_know_their_place() {
        let text = r#"<?xml version="1.0"?><a><n:b x="1" name="x&lt;y"><![CDATA[<c>]]>&lt;d</n:b></a>"#;
        let root = parse(text).expect("XML");
        let b = root.child("b").expect("b");
        let name = b.attribute("name").expect("a name");
        assert_eq!(name.value, "x<y");
        assert_eq!(&text[name.span.start as usize..name.span.end as usize], "x&lt;y");
        let parts = b.children.iter().map(|node| match node {
            Node::Verbatim(span) | Node::Reference('<', span) => &text[span.start as usize..span.end as usize],
            other => panic!("{other:?}"),
        });
        assert_eq!(parts.collect::<Vec<_>>(), ["<c>", "&lt;", "d"]);
        assert_eq!(&text[b.close.start as usize..b.close.end as usize], "</n:b>");
    }

    #[test]
    fn what_is_no_xml_is_told() {
        for text in ["", "x", "<a>", "<a></b>", "<a x=1/>", "<a>&unknown;</a>", "<a", &"<a>".repeat(100_000)] {
            let error = parse(text).expect_err(text);
            assert!(!error.message.is_empty() && error.at as usize <= text.len());
        }
    }
}
