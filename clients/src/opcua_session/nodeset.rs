//! The model as NodeSet2 XML (IEC 62541-6, Annex F).

use std::fmt::Write;

use super::model::{NAMESPACE, ObjectType, PUBLICATION_DATE, TYPES, VERSION, Writer};

/// The document.
pub fn document() -> String {
    let mut text = String::from("<?xml version=\"1.0\" encoding=\"utf-8\"?>\n");
    text += "<UANodeSet xmlns=\"http://opcfoundation.org/UA/2011/03/UANodeSet.xsd\">\n";
    // Writing to a String does not fail.
    let _ = write!(text, "  <NamespaceUris>\n    <Uri>{NAMESPACE}</Uri>\n  </NamespaceUris>\n  <Models>\n");
    let _ = writeln!(
        text,
        "    <Model ModelUri=\"{NAMESPACE}\" Version=\"{VERSION}\" PublicationDate=\"{PUBLICATION_DATE}\">"
    );
    text += "      <RequiredModel ModelUri=\"http://opcfoundation.org/UA/\" />\n    </Model>\n  </Models>\n  <Aliases>\n";
    for (alias, id) in ALIASES {
        let _ = writeln!(text, "    <Alias Alias=\"{alias}\">i={id}</Alias>");
    }
    text += "  </Aliases>\n";
    TYPES.iter().for_each(|object| object_type(object, &mut text));
    text += "</UANodeSet>\n";
    text
}

const ALIASES: [(&str, u32); 9] = [
    ("Boolean", 1),
    ("UInt32", 7),
    ("Int64", 8),
    ("UInt64", 9),
    ("String", 12),
    ("HasModellingRule", 37),
    ("HasTypeDefinition", 40),
    ("HasSubtype", 45),
    ("HasComponent", 47),
];

const BASE_OBJECT_TYPE: u32 = 58;
const FOLDER_TYPE: u32 = 61;
const BASE_DATA_VARIABLE_TYPE: u32 = 63;
const MANDATORY: u32 = 78;

fn object_type(object: &ObjectType, text: &mut String) {
    let ObjectType { name, id, about, variables, methods, folders } = object;
    let head = format!("NodeId=\"ns=1;i={id}\" BrowseName=\"1:{name}\"");
    let subtype = [("HasSubtype\" IsForward=\"false", format!("i={BASE_OBJECT_TYPE}"))];
    node("UAObjectType", &head, name, about, &subtype, text);
    let mut next = id + 1;
    let mut part = |tag: &str, name: &str, about: &str, more: &str, definition: Option<u32>, text: &mut String| {
        let head = format!("NodeId=\"ns=1;i={next}\" BrowseName=\"1:{name}\" ParentNodeId=\"ns=1;i={id}\"{more}");
        next += 1;
        let mut references: Vec<(&str, String)> =
            definition.iter().map(|definition| ("HasTypeDefinition", format!("i={definition}"))).collect();
        references.push(("HasModellingRule", format!("i={MANDATORY}")));
        references.push(("HasComponent\" IsForward=\"false", format!("ns=1;i={id}")));
        node(tag, &head, name, about, &references, text);
    };
    for variable in *variables {
        let access = if variable.writer == Writer::Client { 3 } else { 1 };
        let more = format!(" DataType=\"{}\" AccessLevel=\"{access}\"", variable.data_type.name);
        part("UAVariable", variable.name, variable.about, &more, Some(BASE_DATA_VARIABLE_TYPE), text);
    }
    for method in *methods {
        part("UAMethod", method.name, method.about, "", None, text);
    }
    for folder in *folders {
        part("UAObject", folder.name, folder.about, "", Some(FOLDER_TYPE), text);
    }
}

fn node(tag: &str, head: &str, name: &str, about: &str, references: &[(&str, String)], text: &mut String) {
    let _ = write!(text, "  <{tag} {head}>\n    <DisplayName>{name}</DisplayName>\n    <Description>{about}</Description>\n");
    text.push_str("    <References>\n");
    for (kind, target) in references {
        let _ = writeln!(text, "      <Reference ReferenceType=\"{kind}\">{target}</Reference>");
    }
    let _ = write!(text, "    </References>\n  </{tag}>\n");
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The published file is this table's.
    #[test]
    fn the_published_nodeset_is_this_one() {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/opcua/Onescan.Sdsp.NodeSet2.xml");
        if std::env::var_os("ONESCAN_UPDATE").is_some() {
            std::fs::write(&path, document()).unwrap();
        }
        assert_eq!(std::fs::read_to_string(path).unwrap(), document(), "ONESCAN_UPDATE=1 writes it anew");
    }
}
