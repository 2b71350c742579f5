//! Elements, their attributes, and what is in them.

use std::borrow::Cow;
use std::ops::Range;
use std::slice;

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Element {
    /// Its name without a prefix.
    pub name: String,
    /// Its attributes in their order, the declarations of namespaces among them.
    pub attributes: Vec<Attribute>,
    /// What is in it, in its order. Comments are left out.
    pub children: Vec<Node>,
    pub open: Range<u32>,
    /// Its closing tag; the opening one of an empty element.
    pub close: Range<u32>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Attribute {
    /// Its name with its prefix.
    pub name: String,
    /// What it means: references are resolved.
    pub value: String,
    /// Where the value stands, between its quotes.
    pub span: Range<u32>,
    /// Where the whole attribute stands.
    pub whole: Range<u32>,
}

/// What an element holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Node {
    Element(Box<Element>),
    /// Text that stands in the file as it is meant.
    Verbatim(Range<u32>),
    /// A character that is written otherwise, as in `&lt;`.
    Reference(char, Range<u32>),
}

impl Element {
    /// The elements in it.
    pub fn elements(&self) -> impl Iterator<Item = &Self> {
        self.children.iter().filter_map(Node::element)
    }

    /// The first element of this name in it.
    pub fn child(&self, name: &str) -> Option<&Self> {
        self.elements().find(|element| element.name == name)
    }

    /// The first element of this name in it, without the others.
    pub fn into_child(self, name: &str) -> Option<Self> {
        self.children.into_iter().find_map(|node| match node {
            Node::Element(element) if element.name == name => Some(*element),
            _ => None,
        })
    }

    /// The attribute of this name, which includes its prefix.
    pub fn attribute(&self, name: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|attribute| attribute.name == name)
    }

    /// It and the elements in it, however deep, in their order.
    pub fn tree(&self) -> Tree<'_> {
        Tree { next: Some(self), open: Vec::new() }
    }

    /// The elements that begin before the place and end behind it, from the outside; it is the first.
    pub fn around(&self, at: u32) -> Vec<&Self> {
        let mut around = Vec::new();
        let mut inner = Some(self);
        while let Some(element) = inner.filter(|element| element.open.start < at && at < element.close.end) {
            around.push(element);
            let behind = element.children.partition_point(|node| node.start() < at);
            inner = behind.checked_sub(1).and_then(|last| element.children[last].element());
        }
        around
    }

    /// What stands before the colon of its name in the file's text, if anything does.
    pub fn prefix<'t>(&self, text: &'t str) -> Option<&'t str> {
        let tag = text.get(self.open.start as usize + 1..self.open.end as usize)?;
        let name = tag.split(|letter: char| letter.is_whitespace() || matches!(letter, '/' | '>')).next()?;
        name.split_once(':').map(|(prefix, _)| prefix)
    }

    /// The text that stands in it, of the file that it was read from.
    pub fn text<'t>(&self, file: &'t str) -> Cow<'t, str> {
        let mut text = Cow::Borrowed("");
        for node in &self.children {
            match node {
                Node::Verbatim(span) => {
                    let part = file.get(span.start as usize..span.end as usize).unwrap_or("");
                    if text.is_empty() { text = Cow::Borrowed(part) } else { text.to_mut().push_str(part) }
                }
                Node::Reference(character, _) => text.to_mut().push(*character),
                Node::Element(_) => {}
            }
        }
        text
    }
}

impl Node {
    /// The element, if it is one.
    pub fn element(&self) -> Option<&Element> {
        match self {
            Self::Element(element) => Some(element),
            Self::Verbatim(_) | Self::Reference(..) => None,
        }
    }

    fn start(&self) -> u32 {
        match self {
            Self::Element(element) => element.open.start,
            Self::Verbatim(span) | Self::Reference(_, span) => span.start,
        }
    }
}

/// The elements of a tree, in their order.
#[derive(Clone, Debug)]
pub struct Tree<'e> {
    next: Option<&'e Element>,
    /// What is left of the elements around, the innermost last.
    open: Vec<slice::Iter<'e, Node>>,
}

impl<'e> Iterator for Tree<'e> {
    type Item = &'e Element;

    fn next(&mut self) -> Option<&'e Element> {
        let found = self.next.take().or_else(|| {
            loop {
                match self.open.last_mut()?.find_map(Node::element) {
                    Some(element) => return Some(element),
                    None => drop(self.open.pop()),
                }
            }
        })?;
        self.open.push(found.children.iter());
        Some(found)
    }
}

#[cfg(test)]
mod tests {
    use crate::parse;

    #[test]
    fn a_tree_is_walked_in_the_order_of_the_file() {
        let root = parse("<a><b><c/>x<d/></b><!-- <n/> --><e><f/></e></a>").unwrap();
        assert_eq!(root.tree().map(|element| &*element.name).collect::<String>(), "abcdef");
    }

    #[test]
    fn what_is_around_a_place_is_found() {
        let text = "<a><b/> <c x='1'>t<d>u</d> </c></a>";
        let root = parse(text).unwrap();
        let around = |what: &str| -> String {
            root.around(text.find(what).unwrap() as u32).iter().map(|element| &*element.name).collect()
        };
        assert_eq!(["<a", "<b", "<c", "<d", "u", "</c", "</a"].map(around), ["", "a", "a", "ac", "acd", "ac", "a"]);
    }

    #[test]
    fn text_is_borrowed_where_it_stands_as_it_is_meant() {
        let file = "<a>x<b>no</b>y<![CDATA[<]]>&lt;<e/></a>";
        let root = parse(file).unwrap();
        assert_eq!(root.text(file), "xy<<");
        let b = root.child("b").unwrap();
        assert!(matches!(b.text(file), std::borrow::Cow::Borrowed("no")));
        assert_eq!(root.child("e").unwrap().text(file), "");
        assert_eq!(root.into_child("b").unwrap().name, "b");
    }

    #[test]
    fn prefixes_are_those_of_the_file() {
        let file = "<x:a><b c:d='e'/><y:b\n/></x:a>";
        let root = parse(file).unwrap();
        let prefixes: Vec<_> = root.tree().map(|element| (&*element.name, element.prefix(file))).collect();
        assert_eq!(prefixes, [("a", Some("x")), ("b", None), ("b", Some("y"))]);
    }
}
