//! Nodes as a `NodeSet2` file (OPC 10000-6 annex F), to be taken in by other servers and tools.

use std::fmt::Write as _;

use super::node::{Argument, Id, Kind, Node, Relation, Rule, Space, TYPES_URI, Value};
use super::types;

/// Version and date of the types; to be changed with them.
const VERSION: &str = "0.1.0";
const DATE: &str = "2026-11-21T00:00:00Z";

/// Names in place of numbers, as the file allows.
const ALIASES: [(&str, u32); 13] = [
    ("Boolean", 1),
    ("Int32", 6),
    ("UInt32", 7),
    ("Int64", 8),
    ("UInt64", 9),
    ("String", 12),
    ("LocalizedText", 21),
    ("Organizes", 35),
    ("HasModellingRule", 37),
    ("HasTypeDefinition", 40),
    ("HasSubtype", 45),
    ("HasProperty", 46),
    ("HasComponent", 47),
];

/// The types of the model as a `NodeSet2` file.
pub fn of_types() -> String {
    let mut xml = head();
    for node in types::nodes() {
        element(&mut xml, &node);
    }
    xml.push_str("</UANodeSet>\n");
    xml
}

fn head() -> String {
    let mut xml = String::from(
        "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n\
         <UANodeSet xmlns=\"http://opcfoundation.org/UA/2011/03/UANodeSet.xsd\">\n",
    );
    push(&mut xml, format_args!("  <NamespaceUris>\n    <Uri>{TYPES_URI}</Uri>\n  </NamespaceUris>\n"));
    push(
        &mut xml,
        format_args!(
            "  <Models>\n    <Model ModelUri=\"{TYPES_URI}\" Version=\"{VERSION}\" PublicationDate=\"{DATE}\">\n      \
         <RequiredModel ModelUri=\"http://opcfoundation.org/UA/\" Version=\"1.05.01\" \
         PublicationDate=\"2022-02-24T00:00:00Z\"/>\n    </Model>\n  </Models>\n",
        ),
    );
    xml.push_str("  <Aliases>\n");
    for (name, number) in ALIASES {
        push(&mut xml, format_args!("    <Alias Alias=\"{name}\">i={number}</Alias>\n"));
    }
    xml.push_str("  </Aliases>\n");
    xml
}

/// Writing to a text cannot fail.
fn push(xml: &mut String, text: std::fmt::Arguments<'_>) {
    let _ = xml.write_fmt(text);
}

fn element(xml: &mut String, node: &Node) {
    let name = match node.kind {
        Kind::ObjectType => "UAObjectType",
        Kind::Enumeration(_) => "UADataType",
        Kind::Object { .. } => "UAObject",
        Kind::Variable { .. } => "UAVariable",
        Kind::Method => "UAMethod",
    };
    let (id, browse) = (id(&node.id), browse_name(node));
    push(xml, format_args!("  <{name} NodeId=\"{id}\" BrowseName=\"{browse}\"{}>\n", attributes(node)));
    push(xml, format_args!("    <DisplayName>{}</DisplayName>\n", escaped(&node.name)));
    if !node.about.is_empty() {
        push(xml, format_args!("    <Description>{}</Description>\n", escaped(&node.about)));
    }
    references(xml, node);
    match &node.kind {
        Kind::Enumeration(fields) => definition(xml, node, fields),
        Kind::Variable { value: Value::Texts(texts), .. } => texts_value(xml, texts),
        Kind::Variable { value: Value::Arguments(arguments), .. } => arguments_value(xml, arguments),
        _ => {}
    }
    push(xml, format_args!("  </{name}>\n"));
}

fn attributes(node: &Node) -> String {
    const READ: u8 = 1;
    const READ_WRITE: u8 = 3;
    let mut text = String::new();
    if matches!(node.relation, Relation::HasComponent | Relation::HasProperty) {
        push(&mut text, format_args!(" ParentNodeId=\"{}\"", id(&node.parent)));
    }
    if let Kind::Variable { data_type, is_array, is_writable, .. } = &node.kind {
        push(&mut text, format_args!(" DataType=\"{}\"", alias(data_type)));
        if *is_array {
            text.push_str(" ValueRank=\"1\" ArrayDimensions=\"0\"");
        }
        let access = if *is_writable { READ_WRITE } else { READ };
        push(&mut text, format_args!(" AccessLevel=\"{access}\" UserAccessLevel=\"{access}\""));
    }
    text
}

fn references(xml: &mut String, node: &Node) {
    let relation = match node.relation {
        Relation::HasSubtype => "HasSubtype",
        Relation::HasComponent => "HasComponent",
        Relation::HasProperty => "HasProperty",
        Relation::Organizes => "Organizes",
    };
    let rule = node.rule.map(|rule| match rule {
        Rule::Mandatory => "i=78",
        Rule::OptionalPlaceholder => "i=11508",
    });
    let definition = match &node.kind {
        Kind::Object { of } => Some(id(of)),
        Kind::Variable { of, .. } => Some(format!("i={of}")),
        Kind::ObjectType | Kind::Enumeration(_) | Kind::Method => None,
    };
    xml.push_str("    <References>\n");
    if let Some(definition) = definition {
        push(xml, format_args!("      <Reference ReferenceType=\"HasTypeDefinition\">{definition}</Reference>\n"));
    }
    if let Some(rule) = rule {
        push(xml, format_args!("      <Reference ReferenceType=\"HasModellingRule\">{rule}</Reference>\n"));
    }
    push(
        xml,
        format_args!(
            "      <Reference ReferenceType=\"{relation}\" IsForward=\"false\">{}</Reference>\n    </References>\n",
            id(&node.parent)
        ),
    );
}

fn definition(xml: &mut String, node: &Node, fields: &[&str]) {
    push(xml, format_args!("    <Definition Name=\"{}\">\n", browse_name(node)));
    for (value, field) in fields.iter().enumerate() {
        push(xml, format_args!("      <Field Name=\"{field}\" Value=\"{value}\"/>\n"));
    }
    xml.push_str("    </Definition>\n");
}

fn texts_value(xml: &mut String, texts: &[&str]) {
    xml.push_str("    <Value>\n      <ListOfLocalizedText xmlns=\"http://opcfoundation.org/UA/2008/02/Types.xsd\">\n");
    for text in texts {
        push(xml, format_args!("        <LocalizedText><Text>{}</Text></LocalizedText>\n", escaped(text)));
    }
    xml.push_str("      </ListOfLocalizedText>\n    </Value>\n");
}

fn arguments_value(xml: &mut String, arguments: &[Argument]) {
    const ARGUMENT_XML: u32 = 297;
    xml.push_str(
        "    <Value>\n      <ListOfExtensionObject xmlns=\"http://opcfoundation.org/UA/2008/02/Types.xsd\">\n",
    );
    for Argument { name, data_type, is_array, about } in arguments {
        let (rank, dimensions) = if *is_array {
            (1, "<ArrayDimensions><UInt32>0</UInt32></ArrayDimensions>")
        } else {
            (-1, "<ArrayDimensions/>")
        };
        push(
            xml,
            format_args!(
                "        <ExtensionObject>\n          \
             <TypeId><Identifier>i={ARGUMENT_XML}</Identifier></TypeId>\n          \
             <Body>\n            <Argument>\n              <Name>{name}</Name>\n              \
             <DataType><Identifier>i={data_type}</Identifier></DataType>\n              \
             <ValueRank>{rank}</ValueRank>\n              {dimensions}\n              \
             <Description><Text>{}</Text></Description>\n            </Argument>\n          </Body>\n        \
             </ExtensionObject>\n",
                escaped(about)
            ),
        );
    }
    xml.push_str("      </ListOfExtensionObject>\n    </Value>\n");
}

fn id(id: &Id) -> String {
    match id {
        Id::Core(number) => format!("i={number}"),
        Id::Type(number) => format!("ns=1;i={number}"),
        Id::Instance(path) => format!("ns=2;s={}", escaped(path)),
    }
}

fn alias(data_type: &Id) -> String {
    let number = match data_type {
        Id::Core(number) => *number,
        other => return id(other),
    };
    ALIASES
        .iter()
        .find(|(_, known)| *known == number)
        .map_or_else(|| format!("i={number}"), |(name, _)| (*name).to_owned())
}

fn browse_name(node: &Node) -> String {
    let name = escaped(&node.name);
    match node.space {
        Space::Core => name,
        Space::Types => format!("1:{name}"),
        Space::Session => format!("2:{name}"),
    }
}

fn escaped(text: &str) -> String {
    quick_xml::escape::escape(text).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use onescan_published::is_published;

    /// Rewritten with `UPDATE_DOCS=1`, like every generated document.
    #[test]
    fn what_is_published_is_what_is_served() {
        is_published("docs/opcua/onescan.lockstep.NodeSet2.xml", &of_types());
    }
}
