//! Text to a tree.

use std::collections::BTreeSet;
use std::ops::Range;

use quick_xml::events::{BytesRef, BytesStart, Event};
use quick_xml::{Reader, XmlVersion};

use crate::element::{Attribute, Element, Node};
use crate::error::{XmlError, XmlFault, in_tag};

/// Greatest depth of elements, where nothing else is said.
pub const DEPTH_MAX: usize = 128;
/// More elements and texts than a file of the largest size that is read has in earnest.
const NODES_MAX: usize = 8_000_000;

/// The byte order mark.
const MARK: char = '\u{feff}';

/// The outermost element of a text.
///
/// # Errors
/// The text is not XML, or exceeds a limit.
pub fn parse(text: &str) -> Result<Element, XmlError> {
    parse_within(text, DEPTH_MAX)
}

/// The same with another limit of the depth.
///
/// # Errors
/// As [`parse`].
pub fn parse_within(text: &str, depth_max: usize) -> Result<Element, XmlError> {
    parse_limited(text, depth_max, NODES_MAX)
}

fn parse_limited(text: &str, depth_max: usize, nodes_max: usize) -> Result<Element, XmlError> {
    if u32::try_from(text.len()).is_err() {
        return Err(XmlError { at: 0, fault: XmlFault::TooLong });
    }
    // The reader skips a byte order mark, and does not count it.
    let mark = if text.starts_with(MARK) { MARK.len_utf8() as u32 } else { 0 };
    let body = &text[mark as usize..];
    if body.starts_with(MARK) {
        return Err(XmlError { at: mark, fault: XmlFault::TextOutside });
    }
    let mut parser = Parser { text, depth_max, nodes_max, open: Vec::new(), root: None, outside: None, nodes: 0 };
    let mut reader = Reader::from_str(body);
    loop {
        let start = mark + reader.buffer_position() as u32;
        let event = reader.read_event();
        let span = start..mark + reader.buffer_position() as u32;
        match event {
            Err(error) => {
                let at = mark as usize + reader.error_position() as usize;
                return Err(XmlError { at: text.floor_char_boundary(at) as u32, fault: XmlFault::of(&error) });
            }
            Ok(Event::Eof) => return parser.finish(),
            Ok(event) => parser.take(event, span)?,
        }
    }
}

struct Parser<'t> {
    text: &'t str,
    depth_max: usize,
    nodes_max: usize,
    /// The elements around, the innermost last.
    open: Vec<Element>,
    root: Option<Element>,
    /// The first text that is in no element.
    outside: Option<u32>,
    nodes: usize,
}

impl Parser<'_> {
    fn take(&mut self, event: Event<'_>, span: Range<u32>) -> Result<(), XmlError> {
        match event {
            Event::Start(tag) => {
                if self.open.len() >= self.depth_max {
                    return Err(XmlError { at: span.start, fault: XmlFault::TooDeep(self.depth_max) });
                }
                let element = self.element(&tag, span)?;
                self.open.push(element);
                Ok(())
            }
            Event::Empty(tag) => {
                let element = self.element(&tag, span)?;
                self.add_element(element)
            }
            Event::End(_) => match self.open.pop() {
                Some(element) => self.add_element(Element { close: span, ..element }),
                // The reader has compared the names of tags.
                None => Ok(()),
            },
            Event::Text(_) => self.add_text(Node::Verbatim(span.clone()), span),
            Event::CData(_) => {
                // `<![CDATA[` and `]]>`
                self.add_text(Node::Verbatim(span.start + 9..span.end.saturating_sub(3)), span)
            }
            Event::GeneralRef(reference) => {
                let unknown = || XmlError { at: span.start, fault: XmlFault::Entity((*reference).to_owned()) };
                let character = character(&reference).ok_or_else(unknown)?;
                self.add_text(Node::Reference(character, span.clone()), span)
            }
            Event::DocType(_) => Err(XmlError { at: span.start, fault: XmlFault::DocumentType }),
            Event::Decl(_) | Event::Comment(_) | Event::PI(_) | Event::Eof => Ok(()),
        }
    }

    fn add_element(&mut self, element: Element) -> Result<(), XmlError> {
        let at = element.open.start;
        if let Some(parent) = self.open.last_mut() {
            parent.children.push(Node::Element(Box::new(element)));
            return self.count(at);
        }
        if self.root.is_some() {
            return Err(XmlError { at, fault: XmlFault::SecondRoot(element.name) });
        }
        self.root = Some(element);
        Ok(())
    }

    fn add_text(&mut self, node: Node, span: Range<u32>) -> Result<(), XmlError> {
        if let Some(parent) = self.open.last_mut() {
            parent.children.push(node);
            return self.count(span.start);
        }
        let text = self.text.get(span.start as usize..span.end as usize).unwrap_or("");
        if !text.trim().is_empty() {
            self.outside.get_or_insert(span.start);
        }
        Ok(())
    }

    fn count(&mut self, at: u32) -> Result<(), XmlError> {
        self.nodes += 1;
        let fault = XmlFault::TooMany(self.nodes_max);
        if self.nodes > self.nodes_max { Err(XmlError { at, fault }) } else { Ok(()) }
    }

    fn finish(self) -> Result<Element, XmlError> {
        if let Some(unclosed) = self.open.into_iter().next_back() {
            return Err(XmlError { at: self.text.len() as u32, fault: XmlFault::Unclosed(unclosed.name) });
        }
        match (self.root, self.outside) {
            (None, _) => Err(XmlError { at: 0, fault: XmlFault::Empty }),
            (Some(_), Some(at)) => Err(XmlError { at, fault: XmlFault::TextOutside }),
            (Some(root), None) => Ok(root),
        }
    }

    fn element(&self, tag: &BytesStart<'_>, span: Range<u32>) -> Result<Element, XmlError> {
        let written = self.text.get(span.start as usize..span.end as usize).unwrap_or("");
        let wrong = |at: usize, fault: XmlFault| {
            let at = written.floor_char_boundary(at.min(written.len()));
            XmlError { at: span.start + at as u32, fault }
        };
        let name = tag.local_name().as_ref().to_owned();
        if name.is_empty() || name.contains(['<', '&', '"', '\'', '=']) {
            return Err(wrong(0, XmlFault::NotAName(tag.name().as_ref().to_owned())));
        }
        let mut attributes = Vec::new();
        // The reader gives them in their order: each stands behind the one before.
        let mut from = 1 + tag.name().as_ref().len();
        let find = |from: usize, what: &str| written.get(from..).and_then(|rest| rest.find(what)).map(|at| from + at);
        // The reader would compare each with all before it.
        let mut names = BTreeSet::new();
        for attribute in tag.attributes().with_checks(false) {
            let attribute = attribute.map_err(|error| {
                let (behind_bracket, fault) = in_tag(&error);
                wrong(1 + behind_bracket, fault)
            })?;
            let name = attribute.key.into_inner();
            let raw: &str = &attribute.value;
            let whole = find(from, name).unwrap_or(from);
            let key = whole + name.len();
            let quote = written.get(key..).and_then(|rest| rest.find(['"', '\'']));
            let start = quote.map_or(key, |at| key + at + 1);
            let end = start + raw.len();
            if !names.insert(name) {
                return Err(wrong(whole, XmlFault::Malformed(format!("the attribute `{name}` stands there twice"))));
            }
            if let Some(at) = raw.find('<') {
                return Err(wrong(start + at, XmlFault::TagInValue(name.to_owned())));
            }
            let value = attribute.normalized_value(XmlVersion::Implicit1_0);
            let value = value.map_err(|error| wrong(start, XmlFault::Malformed(error.to_string())))?.into_owned();
            from = end + 1;
            let place = |range: Range<usize>| span.start + range.start as u32..span.start + range.end as u32;
            attributes.push(Attribute {
                name: name.to_owned(),
                value,
                span: place(start..end),
                whole: place(whole..end + 1),
            });
        }
        Ok(Element { name, attributes, children: Vec::new(), open: span.clone(), close: span })
    }
}

/// The five that XML has, and numbers.
fn character(reference: &BytesRef<'_>) -> Option<char> {
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
    use proptest::prelude::*;

    fn at<'t>(text: &'t str, span: &Range<u32>) -> &'t str {
        &text[span.start as usize..span.end as usize]
    }

    #[test]
    fn nodes_know_their_place() {
        let text = r#"<?xml version="1.0"?><a><n:b x="1" name="x&lt;y"><![CDATA[<c>]]>&lt;d</n:b></a>"#;
        let root = parse(text).expect("XML");
        let b = root.child("b").expect("b");
        let name = b.attribute("name").expect("a name");
        assert_eq!((&*name.value, at(text, &name.span)), ("x<y", "x&lt;y"));
        assert_eq!(at(text, &name.whole), r#"name="x&lt;y""#);
        let parts = b.children.iter().map(|node| match node {
            Node::Verbatim(span) | Node::Reference('<', span) => at(text, span),
            other => panic!("{other:?}"),
        });
        assert_eq!(parts.collect::<Vec<_>>(), ["<c>", "&lt;", "d"]);
        assert_eq!(at(text, &b.close), "</n:b>");
    }

    #[test]
    fn values_that_look_like_markup_have_their_own_place() {
        let text = "<a a='' b = \"=\" ab='a' c='\"'/>";
        let root = parse(text).expect("XML");
        let values: Vec<_> = root.attributes.iter().map(|each| (at(text, &each.span), at(text, &each.whole))).collect();
        assert_eq!(values, [("", "a=''"), ("=", "b = \"=\""), ("a", "ab='a'"), ("\"", "c='\"'")]);
    }

    #[test]
    fn a_declaration_may_come_late() {
        for text in ["\u{feff}<a/>", "\n<!-- of us -->\n<?xml version='1.0'?>\n<a/>\n<!-- end -->\n", "<?p i?><a></a>"]
        {
            assert_eq!(parse(text).expect(text).name, "a");
        }
    }

    #[test]
    fn what_is_not_xml_has_its_place() {
        let cases = [
            ("", 0, "there is no element"),
            ("x", 0, "there is no element"),
            ("<a>", 3, "`<a>` has no end"),
            ("<a></b>", 3, "ill-formed document: expected `</a>`, but `</b>` was found"),
            ("</a>", 0, "ill-formed document: close tag `</a>` does not match any open tag"),
            ("<a>&unknown;</a>", 3, "`&unknown;` is not known"),
            ("<a>&#0;</a>", 3, "`&#0;` is not known"),
            ("<a b='1' c=2/>", 11, "the value of an attribute lacks its quotes"),
            ("<a b='1' b='2'/>", 9, "the attribute `b` stands there twice"),
            ("<a>\n<b x='<c'/></a>", 10, "a `<` stands in the value of `x`"),
            ("<a>\n<b x='1>\n</a>", 4, "syntax error: attribute value not closed: `'` not found before end of input"),
            ("\u{feff}<a b/>", 7, "an attribute lacks its `=` and its value"),
            ("\u{feff}\u{feff}<a/>", 3, "text stands outside of the outermost element"),
            ("<a<b>", 0, "`a<b` is not a name"),
            ("< a/>", 0, "`` is not a name"),
            ("<a/><b/>", 4, "`<b>` stands behind the outermost element"),
            ("<a/>\ntext", 4, "text stands outside of the outermost element"),
            ("<!DOCTYPE a [<!ENTITY b 'c'>]><a>&b;</a>", 0, "a DTD is not read: remove the <!DOCTYPE>"),
        ];
        for (text, at, said) in cases {
            let error = parse(text).expect_err(text);
            assert_eq!((error.at, &*error.to_string()), (at, said), "{text}");
        }
    }

    #[test]
    fn a_file_that_ends_too_early_is_an_error_wherever_it_ends() {
        let text = "<?xml version='1.0'?><!-- c --><a b='1'>x&lt;<![CDATA[y]]><c/></a>";
        for end in 0..text.len() {
            let error = parse(&text[..end]).expect_err(&text[..end]);
            assert!(error.fault.is_truncation() || error.at as usize + 4 >= end, "{} {error:?}", &text[..end]);
        }
    }

    #[test]
    fn limits_hold() {
        let deep = |levels: usize| "<a>".repeat(levels) + &"</a>".repeat(levels);
        assert!(parse(&deep(DEPTH_MAX)).is_ok() && parse_within(&deep(1000), 1000).is_ok());
        let error = parse(&deep(100_000)).expect_err("deep");
        assert_eq!((error.at as usize, &error.fault), (3 * DEPTH_MAX, &XmlFault::TooDeep(DEPTH_MAX)));
        let wide: String = (0..100_000).map(|k| format!(" a{k}=''")).collect();
        assert_eq!(parse(&format!("<a{wide}/>")).expect("wide").attributes.len(), 100_000);
        let many = |count: usize| format!("<a>{}</a>", "<b/>x".repeat(count));
        assert!(parse_limited(&many(500), DEPTH_MAX, 1000).is_ok());
        assert_eq!(parse_limited(&many(501), DEPTH_MAX, 1000).expect_err("many").fault, XmlFault::TooMany(1000));
    }

    proptest! {
        #[test]
        fn any_text_is_borne(text in r#"[<>/="' &;a:!?\[\]\-ä\u{feff}]{0,40}"#) {
            match parse(&text) {
                Ok(root) => prop_assert!(root.tree().all(|element| text.get(element.open.start as usize..element.close.end as usize).is_some())),
                Err(error) => prop_assert!(text.is_char_boundary(error.at as usize)),
            }
        }
    }
}
