//! Pieces of XML: what stands for a character, text in XHTML, what CODESYS adds.

use super::super::page::Wrapper;

/// The namespace of formatted text.
const XHTML: &str = "http://www.w3.org/1999/xhtml";
/// Beginning of the names of CODESYS' additions.
pub(super) const VENDOR: &str = "http://www.3s-software.com/plcopenxml/";

/// A value in an attribute: line ends and tabs would become blanks, so they are written as their numbers.
pub(crate) fn escaped(text: &str) -> String {
    escaped_text(text).replace('"', "&quot;").replace('\n', "&#10;").replace('\r', "&#13;").replace('\t', "&#9;")
}

/// Text in an element.
pub(super) fn escaped_text(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// `<documentation>` of what says something about itself.
pub(super) fn documentation(words: &str) -> String {
    if words.is_empty() {
        String::new()
    } else {
        format!("<documentation>{}</documentation>", Wrapper::Codesys.around(words))
    }
}

impl Wrapper {
    /// Text in its element; lines end with a line feed alone.
    pub(super) fn around(self, text: &str) -> String {
        let text = text.replace("\r\n", "\n");
        match self {
            // What ends the text ends in the one part and begins in the next.
            Self::Paragraph => {
                let text = text.replace("]]>", "]]]]><![CDATA[>");
                format!("<xhtml:p xmlns:xhtml=\"{XHTML}\"><![CDATA[{text}]]></xhtml:p>")
            }
            Self::Codesys => format!("<xhtml xmlns=\"{XHTML}\">{}</xhtml>", escaped_text(&text)),
        }
    }
}

/// `<data>` of one of CODESYS' additions.
pub(super) fn data(kind: &str, xml: &str) -> String {
    format!("<data name=\"{VENDOR}{kind}\" handleUnknown=\"implementation\">\n{xml}</data>\n")
}

/// `<addData>` of what has additions.
pub(super) fn additions(data: &str) -> String {
    if data.is_empty() { String::new() } else { format!("<addData>\n{data}</addData>\n") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_comes_back_as_it_was() {
        let value = "'a\t\"b\"' & x < y > z\n";
        let file = format!("<a v=\"{}\">{}</a>", escaped(value), escaped_text("x <> '&'"));
        let root = onescan_xml::parse(&file).expect("it is XML");
        assert_eq!(root.attribute("v").map(|found| found.value.as_str()), Some(value));
        assert_eq!(onescan_iec::input::plcopen_object::inner_text(&file, &root), "x <> '&'");
        for wrapper in [Wrapper::Paragraph, Wrapper::Codesys] {
            let file = wrapper.around("a[b[1]]>2 & c");
            let root = onescan_xml::parse(&file).expect("it is XML");
            assert_eq!(onescan_iec::input::plcopen_object::inner_text(&file, &root), "a[b[1]]>2 & c");
        }
    }
}
