//! A file as it is found: decoded once, so that every question about it is answered from the same text.

use std::sync::Arc;

use super::encoding::{Encoding, decode};
use super::kind::SourceKind;
use crate::diagnostic::Code;

/// Greatest size of a file in bytes.
const MAX_SIZE: usize = 256 << 20;

/// A name that all PLCopen XML has in it: the namespace of its project.
const PLCOPEN: &str = "plcopen.org";

/// A file whose bytes have been read.
#[derive(Debug, Clone)]
pub struct Found {
    pub(super) kind: SourceKind,
    pub(super) text: Result<(Arc<str>, Encoding), NoText>,
}

/// Why a file has no text.
#[derive(Debug, Clone)]
pub(super) struct NoText {
    pub(super) code: Code,
    pub(super) message: String,
}

impl Found {
    /// Decodes the bytes of a file whose name says that it is of this kind.
    pub fn decode(kind: SourceKind, bytes: &[u8]) -> Self {
        let text = if bytes.len() > MAX_SIZE {
            Err(NoText { code: Code::TooLarge, message: format!("the file is larger than {MAX_SIZE} bytes") })
        } else {
            let not_text =
                |error: super::encoding::EncodingError| NoText { code: Code::NotText, message: error.to_string() };
            decode(bytes).map(|(text, encoding)| (text.into(), encoding)).map_err(not_text)
        };
        Self { kind, text }
    }

    /// Its text; nothing if it has none.
    pub fn text(&self) -> Option<&str> {
        self.text.as_ref().ok().map(|(text, _)| &**text)
    }

    /// True for XML that is known not to be PLCopen's. Folders hold much of it.
    pub fn is_other_xml(&self) -> bool {
        self.kind == SourceKind::PlcOpen && self.text().is_some_and(|text| !text.contains(PLCOPEN))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PROJECT: &str = "<project xmlns=\"http://www.plcopen.org/xml/tc6_0201\"/>";

    fn is_other_xml(bytes: &[u8]) -> bool {
        Found::decode(SourceKind::PlcOpen, bytes).is_other_xml()
    }

    #[test]
    fn plcopen_xml_is_known_in_every_encoding() {
        let marked = format!("\u{feff}{PROJECT}");
        let low: Vec<u8> = marked.encode_utf16().flat_map(u16::to_le_bytes).collect();
        let high: Vec<u8> = PROJECT.encode_utf16().flat_map(u16::to_be_bytes).collect();
        for bytes in [PROJECT.as_bytes(), &low, &high] {
            assert!(!is_other_xml(bytes));
        }
    }

    #[test]
    fn other_xml_is_text_without_the_name() {
        assert!(is_other_xml(b"<html/>") && is_other_xml(b"\xff\xfe<\0a\0/\0>\0"));
        assert!(!Found::decode(SourceKind::Text, b"<html/>").is_other_xml());
    }

    #[test]
    fn nothing_is_known_of_what_is_no_text() {
        let found = Found::decode(SourceKind::PlcOpen, b"<?xml version=\"1.0\" encoding=\"koi8-r\"?><a/>");
        assert!(found.text().is_none() && !found.is_other_xml());
    }
}
