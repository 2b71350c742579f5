//! The elements of a robot. They come from several files, so each element and each attribute knows its file with its
//! place: a macro's body stands in many places of the expanded robot. Text between tags means nothing in URDF, xacro
//! and MJCF, and is left out.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use crate::file_place::{Place, Source};

/// What the prefix `xml` always stands for.
const XML: &str = "http://www.w3.org/XML/1998/namespace";

impl Place {
    /// A fault at this place.
    pub(super) fn wrong(&self, cause: impl Into<String>) -> RobotFault {
        RobotFault { place: self.clone(), cause: cause.into(), hint: None }
    }
}

/// What is wrong with a robot's file, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RobotFault {
    pub place: Place,
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

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Attribute {
    pub(super) key: String,
    pub(super) value: String,
    pub(super) place: Place,
}

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
/// A text that is not XML, or has a prefix without a namespace.
pub(super) fn parse(source: &Arc<Source>) -> Result<Element, RobotFault> {
    let text = &source.text;
    let file = File { source };
    let root = onescan_xml::parse(text).map_err(|error| {
        let at = error.at as usize;
        if error.fault.is_truncation() {
            return file.at(text.len()..text.len()).wrong("the file ends within an element");
        }
        let line_end = text.get(at..).and_then(|rest| rest.find('\n')).map_or(text.len(), |end| at + end);
        file.at(at..line_end).wrong(error.to_string())
    })?;
    file.element(&root, None)
}

/// The namespaces that an element declares, by their prefixes, and those of the elements around it. No prefix is "".
#[derive(Debug)]
struct Namespaces<'x> {
    declared: BTreeMap<&'x str, &'x str>,
    around: Option<&'x Self>,
}

impl<'x> Namespaces<'x> {
    fn of(element: &'x onescan_xml::Element, around: Option<&'x Self>) -> Self {
        let declared = element.attributes.iter().filter_map(|each| Some((declared(&each.name)?, &*each.value)));
        Self { declared: declared.collect(), around }
    }

    fn get(&self, prefix: &str) -> Option<&'x str> {
        let own = self.declared.get(prefix).copied();
        own.or_else(|| self.around?.get(prefix)).or((prefix == "xml").then_some(XML))
    }
}

/// The prefix that an attribute of this name declares, if it declares one.
fn declared(name: &str) -> Option<&str> {
    let rest = name.strip_prefix("xmlns")?;
    if rest.is_empty() { Some("") } else { rest.strip_prefix(':') }
}

struct File<'s> {
    source: &'s Arc<Source>,
}

impl File<'_> {
    fn at(&self, span: Range<usize>) -> Place {
        Place { source: Arc::clone(self.source), span }
    }

    fn place(&self, span: &Range<u32>) -> Place {
        self.at(span.start as usize..span.end as usize)
    }

    fn element(&self, element: &onescan_xml::Element, around: Option<&Namespaces<'_>>) -> Result<Element, RobotFault> {
        // the whole element may be a thousand lines; its first tag is what a reader looks for
        let place = self.place(&element.open);
        let namespaces = Namespaces::of(element, around);
        let namespace = match element.prefix(&self.source.text) {
            Some(prefix) => Some(needed(&namespaces, prefix, &place)?),
            None => namespaces.get(""),
        };
        let mut attributes = Vec::new();
        for attribute in element.attributes.iter().filter(|attribute| declared(&attribute.name).is_none()) {
            let place = self.place(&attribute.whole);
            let key = match attribute.name.split_once(':') {
                Some((prefix, key)) => needed(&namespaces, prefix, &place).map(|_| key)?,
                None => &*attribute.name,
            };
            attributes.push(Attribute { key: key.to_owned(), value: attribute.value.clone(), place });
        }
        let children = element.elements().map(|child| self.element(child, Some(&namespaces)));
        Ok(Element {
            name: element.name.clone(),
            is_xacro: namespace.is_some_and(|namespace| namespace.contains("xacro")),
            attributes,
            children: children.collect::<Result<_, _>>()?,
            place,
        })
    }
}

/// The namespace of a prefix that stands at a place.
fn needed<'x>(namespaces: &Namespaces<'x>, prefix: &str, place: &Place) -> Result<&'x str, RobotFault> {
    namespaces.get(prefix).ok_or_else(|| {
        let hint = format!("declare it in the outermost element: xmlns:{prefix}=\"…\"");
        place.wrong(format!("the prefix `{prefix}:` has no namespace")).hinted(hint)
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

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Element, RobotFault> {
        parse(&Arc::new(Source { file: "r.xacro".to_owned(), text: text.into() }))
    }

    fn reported(text: &str) -> String {
        read(text).expect_err(text).to_string()
    }

    #[test]
    fn namespaces_decide_what_is_xacro() {
        let text = "<robot xmlns:x='http://ros.org/xacro'><x:a/><a xml:lang='en' x:b='1'/>\
            <c xmlns='http://ros.org/xacro'><d/></c><e xmlns:x='urn:other'><x:f/></e></robot>";
        let root = read(text).unwrap();
        let names: Vec<_> = root.children.iter().flat_map(|each| std::iter::once(each).chain(&each.children)).collect();
        let names: String = names.iter().filter(|each| each.is_xacro).map(|each| &*each.name).collect();
        assert_eq!(names, "acd");
        let keys: Vec<_> = root.children[1].attributes.iter().map(|attribute| &*attribute.key).collect();
        assert_eq!((keys, root.attributes.len()), (vec!["lang", "b"], 0));
        assert!(
            reported("<robot>\n<x:a/></robot>").starts_with("line 2: the prefix `x:` has no namespace (declare it")
        );
        assert!(reported("<robot>\n<a\n x:b='1'/></robot>").starts_with("line 3: the prefix `x:` has no namespace"));
    }

    #[test]
    fn what_is_no_xml_has_its_line() {
        let cases = [
            ("<robot>\n<link>\n</robot>", "line 3: ill-formed document: expected `</link>`, but `</robot>` was found"),
            ("<robot>\n<link a='1' a='2'/></robot>", "line 2: the attribute `a` stands there twice"),
            ("<robot>\n&x;</robot>", "line 2: `&x;` is not known"),
            ("\n<!DOCTYPE robot>\n<robot/>", "line 2: a DTD is not read: remove the <!DOCTYPE>"),
            ("<robot>\n<link", "line 2: the file ends within an element"),
            ("", "line 1: the file ends within an element"),
        ];
        for (text, said) in cases {
            assert_eq!(reported(text), said, "{text}");
        }
        assert!(reported(&"<a>".repeat(100_000)).contains("nested deeper than 128 levels"));
    }

    #[test]
    fn a_place_is_that_of_the_first_tag_and_of_the_whole_attribute() {
        let root = read("<robot><link\n name = 'a'><visual/></link></robot>").unwrap();
        let at = |place: &Place| place.source.text[place.span.clone()].to_owned();
        assert_eq!(at(&root.children[0].place), "<link\n name = 'a'>");
        assert_eq!(at(&root.children[0].attributes[0].place), "name = 'a'");
    }
}
