//! Which tool wrote a file in PLCopen XML: its dialect and the order of its networks depend on it.

use onescan_xml::Element;

use crate::dialect::Dialect;

/// How the editor of Beremiz, which OpenPLC's is made of, names the schema once more. It writes no name of its own.
const BEREMIZ_NAMESPACE: &str = "xmlns:ns1=\"http://www.plcopen.org/xml/tc6";

/// `OpenPLC`'s editor from version 4 on declares this schema by a prefix that Beremiz has for another one.
const OPENPLC_4_NAMESPACE: &str = "xmlns:xsd=\"http://www.w3.org/2001/XMLSchema-instance\"";

/// C code in a file can only be for `MatIEC`: it names the block's data so.
const BEREMIZ_C_CODE: &str = "(data__->,";

/// A tool, by its own name or by what no other tool writes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Tool {
    Codesys,
    TwinCat,
    /// Beremiz, and `OpenPLC`'s editor up to version 1, which has the same generator.
    Beremiz,
    /// `OpenPLC`'s editor from version 4 on.
    OpenPlc4,
    Other,
}

impl Tool {
    pub(super) fn of(file: &str, root: &Element) -> Self {
        let header = root.child("fileHeader");
        let product = header.and_then(|header| header.attribute("productName"));
        let product = product.map_or_else(String::new, |name| name.value.to_ascii_uppercase());
        // What it was made with, by whom and what it is.
        let about = header.into_iter().flat_map(|header| &header.attributes);
        let about: String = about.map(|attribute| attribute.value.to_ascii_uppercase() + " ").collect();
        if product.contains("TWINCAT") {
            Self::TwinCat
        } else if product.contains("CODESYS") || file.contains("3s-software.com/plcopenxml/") {
            Self::Codesys
        } else if file.contains(BEREMIZ_NAMESPACE) && file.contains(OPENPLC_4_NAMESPACE) {
            Self::OpenPlc4
        } else if ["BEREMIZ", "OPENPLC"].iter().any(|name| about.contains(name))
            || [BEREMIZ_NAMESPACE, BEREMIZ_C_CODE].iter().any(|mark| file.contains(mark))
        {
            Self::Beremiz
        } else {
            Self::Other
        }
    }

    pub(super) fn dialect(self) -> Dialect {
        match self {
            Self::Codesys => Dialect::Codesys,
            Self::TwinCat => Dialect::TwinCat,
            Self::Beremiz | Self::OpenPlc4 => Dialect::Matiec,
            Self::Other => Dialect::default(),
        }
    }
}

#[cfg(test)]
mod tests {
    use onescan_xml::parse;

    use super::Tool;

    fn tool(attributes: &str, header: &str) -> Tool {
        let file = format!("<project {attributes}><fileHeader {header}/></project>");
        Tool::of(&file, &parse(&file).expect("XML"))
    }

    #[test]
    fn files_name_their_tool_or_show_it() {
        let twice = "xmlns:ns1=\"http://www.plcopen.org/xml/tc6_0201\"";
        let unnamed = "companyName=\"Unknown\" productName=\"Unnamed\"";
        assert_eq!(tool("", "productName=\"CODESYS V3.5\""), Tool::Codesys);
        assert_eq!(tool("", "productName=\"TwinCAT PLC Control\""), Tool::TwinCat);
        assert_eq!(tool("", "companyName=\"Beremiz\""), Tool::Beremiz);
        assert_eq!(tool(&format!("{twice} xmlns:xsd=\"http://www.w3.org/2001/XMLSchema\""), unnamed), Tool::Beremiz);
        let newer = format!("{twice} xmlns:xsd=\"http://www.w3.org/2001/XMLSchema-instance\"");
        assert_eq!(tool(&newer, unnamed), Tool::OpenPlc4);
        assert_eq!(tool("", "productName=\"onescan\""), Tool::Other);
    }
}
