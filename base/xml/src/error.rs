//! Why a text is not XML, and where.

use quick_xml::Error as Reader;
use quick_xml::events::attributes::AttrError;
use thiserror::Error;

/// Why a text is not XML that is read, and where.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{fault}")]
pub struct XmlError {
    /// The byte at which it shows.
    pub at: u32,
    pub fault: XmlFault,
}

/// Why a text is not XML that is read.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum XmlFault {
    /// Its markup is wrong.
    #[error("{0}")]
    Malformed(String),
    /// It ends within a tag, a comment or the like.
    #[error("{0}")]
    Truncated(String),
    /// It ends within an element of this name.
    #[error("`<{0}>` has no end")]
    Unclosed(String),
    /// It has no element.
    #[error("there is no element")]
    Empty,
    /// This stands where an element's name should.
    #[error("`{0}` is not a name")]
    NotAName(String),
    /// A tag begins within the value of an attribute.
    #[error("a `<` stands in the value of `{0}`")]
    TagInValue(String),
    /// An entity is none of XML's own.
    #[error("`&{0};` is not known")]
    Entity(String),
    /// It has a document type, which could declare entities.
    #[error("a DTD is not read: remove the <!DOCTYPE>")]
    DocumentType,
    /// There is more than one outermost element.
    #[error("`<{0}>` stands behind the outermost element")]
    SecondRoot(String),
    /// There is text outside of the outermost element.
    #[error("text stands outside of the outermost element")]
    TextOutside,
    /// Elements are nested too deep.
    #[error("elements are nested deeper than {0} levels")]
    TooDeep(usize),
    /// It has too many elements and texts.
    #[error("there are more than {0} elements and texts")]
    TooMany(usize),
    /// It is too long for places to be numbers.
    #[error("the text is longer than 4 GiB")]
    TooLong,
}

impl XmlFault {
    /// A fault of the reader in what stands between elements and in tags.
    pub(crate) fn of(error: &Reader) -> Self {
        match error {
            Reader::Syntax(_) => Self::Truncated(error.to_string()),
            _ => Self::Malformed(error.to_string()),
        }
    }

    /// True if the rest of the file is missing.
    pub fn is_truncation(&self) -> bool {
        matches!(self, Self::Truncated(_) | Self::Unclosed(_) | Self::Empty)
    }
}

/// What is wrong with an attribute, and where in its tag, in bytes behind the `<`.
pub(crate) fn in_tag(error: &AttrError) -> (usize, XmlFault) {
    let (at, wrong) = match error {
        AttrError::ExpectedEq(at) => (*at, "an attribute lacks its `=` and its value"),
        AttrError::ExpectedValue(at) => (*at, "an attribute lacks its value"),
        AttrError::UnquotedValue(at) => (*at, "the value of an attribute lacks its quotes"),
        AttrError::ExpectedQuote(at, _) => (*at, "the value of an attribute lacks its closing quote"),
        AttrError::Duplicated(at, _) => (*at, "an attribute stands there twice"),
    };
    (at, XmlFault::Malformed(wrong.to_owned()))
}
