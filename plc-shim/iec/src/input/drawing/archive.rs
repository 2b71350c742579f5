//! Archives of objects, `<XmlArchive>`, which hold what is drawn.
//!
//! | in the file | is |
//! |---|---|
//! | `<o n="Name" t="Type">` | an object |
//! | `<v n="Name">"text"</v>` | a value: text between quotes, or a number, which may end in `L` |
//! | `<n n="Name" />` | nothing |
//! | `<l2 n="Name" cet="Type">`, `<a ..>` | a list; `cet` is the type of each element that names none |

use std::ops::Range;

use onescan_xml::{Element, Node};

use crate::input::statement::{Piece, Text};

/// An object and the type that it or its list names.
#[derive(Debug, Clone, Copy)]
pub(super) struct Object<'e> {
    element: &'e Element,
    pub(super) kind: &'e str,
}

/// A text of the archive without its quotes, as it stands in the file.
#[derive(Debug, Clone)]
pub(super) struct Written {
    pub(super) plain: String,
    pub(super) place: Range<u32>,
    pieces: Vec<Piece>,
}

impl Written {
    fn of(file: &str, element: &Element) -> Self {
        let mut pieces = Vec::new();
        let mut plain = String::new();
        for node in &element.children {
            match node {
                Node::Verbatim(span) => {
                    plain.push_str(file.get(span.start as usize..span.end as usize).unwrap_or(""));
                    pieces.push(Piece::Verbatim(span.clone()));
                }
                Node::Reference(character, span) => {
                    plain.push(*character);
                    pieces.push(Piece::Word(character.to_string(), span.clone()));
                }
                Node::Element(_) => {}
            }
        }
        let mut written = Self { plain, place: element.open.clone(), pieces };
        written.unquote();
        written
    }

    /// Takes off the quotes around it.
    fn unquote(&mut self) {
        let Some(inner) = self.plain.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')) else { return };
        self.plain = inner.to_owned();
        match self.pieces.first_mut() {
            Some(Piece::Verbatim(span)) => span.start += 1,
            _ => drop(self.pieces.drain(..1)),
        }
        match self.pieces.last_mut() {
            Some(Piece::Verbatim(span)) => span.end -= 1,
            _ => drop(self.pieces.pop()),
        }
        self.pieces.retain(|piece| !matches!(piece, Piece::Verbatim(span) if span.start >= span.end));
        let place = |piece: &Piece| match piece {
            Piece::Word(_, place) | Piece::Verbatim(place) | Piece::Wire(_, place, _) => place.clone(),
        };
        if let (Some(first), Some(last)) = (self.pieces.first().map(place), self.pieces.last().map(place)) {
            self.place = first.start..last.end;
        }
    }

    /// The text that an element holds.
    pub(super) fn below(file: &str, element: &Element) -> Self {
        Self::of(file, element)
    }

    /// The same without the semicolon behind an expression.
    pub(super) fn without_end(&self) -> Self {
        let mut text = self.clone();
        let end = text.plain.trim_end_matches([';', ' ', '\t', '\r', '\n']).len();
        let mut surplus = (text.plain.len() - end) as u32;
        text.plain.truncate(end);
        while let Some(Piece::Verbatim(span)) = text.pieces.last_mut().filter(|_| surplus > 0) {
            let taken = surplus.min(span.end - span.start);
            span.end -= taken;
            surplus -= taken;
            if span.start >= span.end {
                text.pieces.pop();
            }
        }
        text
    }

    pub(super) fn is_blank(&self) -> bool {
        self.plain.trim().is_empty()
    }

    /// The text as it stands in the file.
    pub(super) fn text(&self) -> Text {
        Text::of(self.pieces.clone())
    }
}

impl<'e> Object<'e> {
    /// The object of the type `kind` that the archive in `holder` begins with.
    pub(super) fn first(holder: &'e Element, kind: &str) -> Option<Self> {
        let data = holder.child("XmlArchive")?.child("Data")?;
        let objects = data.elements().filter(|inner| inner.name == "o");
        objects.map(|element| Self { element, kind: text_of(element, "t") }).find(|found| found.kind == kind)
    }

    /// Where it begins.
    pub(super) fn place(&self) -> Range<u32> {
        self.element.open.clone()
    }

    fn part(&self, name: &str) -> Option<&'e Element> {
        self.element.elements().find(|inner| text_of(inner, "n") == name)
    }

    pub(super) fn object(&self, name: &str) -> Option<Self> {
        let element = self.part(name).filter(|part| part.name == "o")?;
        Some(Self { element, kind: text_of(element, "t") })
    }

    /// The elements of a list; nothing stands for a place that is empty.
    pub(super) fn list(&self, name: &str) -> Vec<Option<Self>> {
        let Some(list) = self.part(name).filter(|part| matches!(part.name.as_str(), "l2" | "a")) else {
            return Vec::new();
        };
        let of_all = text_of(list, "cet");
        let object = |element: &'e Element| {
            let own = text_of(element, "t");
            (element.name == "o").then_some(Self { element, kind: if own.is_empty() { of_all } else { own } })
        };
        list.elements().map(object).collect()
    }

    /// The objects in `InnerList` of the object `name`.
    pub(super) fn inner(&self, name: &str) -> Vec<Self> {
        self.object(name).map(|holder| holder.list("InnerList").into_iter().flatten().collect()).unwrap_or_default()
    }

    /// The texts of a list.
    pub(super) fn texts(&self, file: &str, name: &str) -> Vec<String> {
        let list = self.part(name).into_iter().flat_map(Element::elements);
        list.map(|element| Written::of(file, element).plain).collect()
    }

    /// A value; nothing if there is none.
    pub(super) fn value(&self, file: &str, name: &str) -> Option<Written> {
        self.part(name).filter(|part| part.name == "v").map(|part| Written::of(file, part))
    }

    /// A value as text, which is empty if there is none.
    pub(super) fn word(&self, file: &str, name: &str) -> String {
        self.value(file, name).map_or_else(String::new, |value| value.plain)
    }

    pub(super) fn is_set(&self, file: &str, name: &str) -> bool {
        self.word(file, name).eq_ignore_ascii_case("true")
    }

    /// What the archive numbers it with.
    pub(super) fn id(&self, file: &str) -> String {
        self.word(file, "Id").trim_end_matches('L').to_owned()
    }
}

/// The text of an attribute; empty where the element does not have it.
fn text_of<'e>(element: &'e Element, name: &str) -> &'e str {
    element.attribute(name).map_or("", |found| found.value.as_str())
}
