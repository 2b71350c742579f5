//! What is said of a declaration around it: comments become its documentation, pragmas as
//! `{attribute 'qualified_only'}` attributes in CODESYS' additions.

use std::ops::Range;

use super::super::page::Page;
use super::markup::{additions, data, documentation, escaped};

/// What is said of a declaration.
#[derive(Debug, Default)]
pub(crate) struct About {
    /// Attributes, as an addition.
    added: String,
    words: String,
}

impl About {
    /// What stands in front of a declaration, and behind it in its line.
    pub(super) fn of(page: &Page<'_>, before: Range<u32>, behind: Range<u32>) -> Self {
        let pragmas = page.pragmas(before.clone());
        let (attributes, others): (Vec<_>, Vec<_>) =
            pragmas.into_iter().partition(|pragma| attribute(pragma).is_some());
        let written: String = attributes.into_iter().filter_map(attribute).collect();
        let added = if written.is_empty() {
            written
        } else {
            data("attributes", &format!("<Attributes>{written}</Attributes>\n"))
        };
        let words = [page.remarks(before), others.join("\n"), page.remarks(behind)];
        let words: Vec<String> = words.into_iter().filter(|words| !words.is_empty()).collect();
        Self { added, words: words.join("\n") }
    }

    /// The same, with more words.
    pub(super) fn with_words(self, words: &str) -> Self {
        Self { words: [&self.words, words].join("\n").trim().to_owned(), ..self }
    }

    /// `<addData>`, `more` being other additions, and `<documentation>`.
    pub(super) fn xml(&self, more: &str) -> String {
        self.additions(more) + &self.documentation()
    }

    /// The additions alone.
    pub(super) fn added(&self) -> &str {
        &self.added
    }

    pub(super) fn documentation(&self) -> String {
        documentation(&self.words)
    }

    fn additions(&self, more: &str) -> String {
        additions(&[more, &self.added].concat())
    }
}

/// `{attribute 'name' := 'value'}` as an element; nothing for any other pragma.
fn attribute(pragma: &str) -> Option<String> {
    let inner = pragma.strip_prefix('{')?.strip_suffix('}')?.trim();
    let (word, rest) = inner.split_at_checked("attribute".len())?;
    let mut parts = rest.trim().split('\'');
    let (before, name) = (parts.next()?, parts.next()?);
    if !word.eq_ignore_ascii_case("attribute") || !before.is_empty() {
        return None;
    }
    let value = match parts.next()?.trim() {
        "" => "",
        ":=" => parts.next()?,
        _ => return None,
    };
    Some(format!("<Attribute Name=\"{}\" Value=\"{}\"/>", escaped(name), escaped(value)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pragmas_are_attributes_or_words() {
        let none = None;
        for (pragma, written) in [
            ("{attribute 'hide'}", Some("<Attribute Name=\"hide\" Value=\"\"/>")),
            ("{ATTRIBUTE 'displaymode' := 'hex' }", Some("<Attribute Name=\"displaymode\" Value=\"hex\"/>")),
            ("{attribute hide}", none),
            ("{warning disable C0195}", none),
            ("{attribute}", none),
        ] {
            assert_eq!(attribute(pragma).as_deref(), written, "{pragma}");
        }
    }
}
