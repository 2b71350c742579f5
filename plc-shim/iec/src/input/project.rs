//! TwinCAT's `.plcproj`: which files make up a PLC project.

use std::ops::Range;
use std::sync::Arc;

use onescan_xml::Element;

use super::encoding::decode;
use crate::syntax::token::TokenKind;
use crate::syntax::tokenize;

/// Why a project cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ProjectError {
    /// It is not text.
    #[error(transparent)]
    Encoding(#[from] super::encoding::EncodingError),
    /// It is not XML.
    #[error("line {line}: {message}")]
    Xml {
        /// The line, from 1.
        line: usize,
        message: String,
    },
}

/// A project's text and the files that it lists.
#[derive(Debug, Clone)]
pub struct Listing {
    /// Its XML, as it stands in the file.
    pub text: Arc<str>,
    /// The files that it compiles, in their order.
    pub files: Vec<Listed>,
    /// The namespace that others know it by when they use it as a library: its default namespace, else its title, else
    /// its name; nothing if that is not the name of a program.
    pub namespace: Option<String>,
}

/// A file that a project compiles.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Listed {
    /// With `/` between folders, relative to the project's folder.
    pub path: String,
    /// Where the project names it.
    pub place: Range<u32>,
}

/// The files that a project compiles, with `/` between folders, relative to the project's folder.
///
/// # Errors
/// It is not a project.
pub fn files(bytes: &[u8]) -> Result<Vec<String>, ProjectError> {
    Ok(listing(bytes)?.files.into_iter().map(|file| file.path).collect())
}

/// The same, with where the project names each.
///
/// # Errors
/// It is not a project.
pub fn listing(bytes: &[u8]) -> Result<Listing, ProjectError> {
    let (text, _) = decode(bytes)?;
    let root = onescan_xml::parse(&text).map_err(|error| {
        let before = text.get(..error.at as usize).unwrap_or("");
        ProjectError::Xml { line: before.lines().count().max(1), message: error.to_string() }
    })?;
    let items = root.elements().filter(|group| group.name == "ItemGroup").flat_map(Element::elements);
    let included = items.filter(|item| item.name == "Compile").filter_map(|item| item.attribute("Include"));
    let listed = included.map(|include| Listed { path: path(&include.value), place: include.span.clone() });
    let files = listed.collect();
    Ok(Listing { files, namespace: namespace(&text, &root), text: text.into() })
}

fn namespace(text: &str, root: &Element) -> Option<String> {
    let properties: Vec<_> =
        root.elements().filter(|group| group.name == "PropertyGroup").flat_map(Element::elements).collect();
    let value = |name: &str| properties.iter().find(|property| property.name == name).map(|found| found.text(text));
    let named = ["DefaultNamespace", "Title", "Name"].iter().filter_map(|name| value(name));
    named.map(|name| name.trim().to_owned()).find(|name| !name.is_empty()).filter(|name| is_identifier(name))
}

fn is_identifier(name: &str) -> bool {
    let tokens = tokenize(name);
    matches!(tokens.as_slice(), [only] if only.kind == TokenKind::Identifier)
}

/// The path that an item names: `MSBuild` escapes characters that mean something to it as `%28`.
fn path(include: &str) -> String {
    let mut bytes = Vec::with_capacity(include.len());
    let mut rest = include;
    while let Some((before, behind)) = rest.split_once('%') {
        bytes.extend_from_slice(before.as_bytes());
        let escaped = behind.get(..2).filter(|digits| digits.bytes().all(|digit| digit.is_ascii_hexdigit()));
        if let Some(byte) = escaped.and_then(|digits| u8::from_str_radix(digits, 16).ok()) {
            bytes.push(byte);
            rest = behind.get(2..).unwrap_or("");
        } else {
            bytes.push(b'%');
            rest = behind;
        }
    }
    bytes.extend_from_slice(rest.as_bytes());
    let decoded = String::from_utf8(bytes).unwrap_or_else(|_| include.to_owned());
    decoded.replace('\\', "/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn compiled_files_are_listed() {
        let text = br#"<?xml version="1.0" encoding="utf-8"?>
<Project xmlns="http://schemas.microsoft.com/developer/msbuild/2003">
  <ItemGroup>
    <Compile Include="POUs\MAIN.TcPOU"><SubType>Code</SubType></Compile>
    <Compile Include="PlcTask.TcTTO"/>
    <Folder Include="POUs"/>
  </ItemGroup>
</Project>"#;
        assert_eq!(files(text).expect("a project"), ["POUs/MAIN.TcPOU", "PlcTask.TcTTO"]);
    }

    #[test]
    fn a_library_is_known_by_its_namespace_its_title_or_its_name() {
        let namespace = |properties: &str| {
            let text = format!("<Project><PropertyGroup>{properties}</PropertyGroup></Project>");
            listing(text.as_bytes()).expect("a project").namespace
        };
        let all = "<Name>Gears_2</Name><Title>Gears</Title>";
        assert_eq!(namespace(&format!("{all}<DefaultNamespace> Gear </DefaultNamespace>")).as_deref(), Some("Gear"));
        assert_eq!(namespace(&format!("{all}<DefaultNamespace></DefaultNamespace>")).as_deref(), Some("Gears"));
        assert_eq!(namespace("<Name>Gears_2</Name>").as_deref(), Some("Gears_2"));
        assert_eq!(namespace("<Title>Gears and more</Title><Name>Gears</Name>"), None);
        assert_eq!(namespace(""), None);
    }

    #[test]
    fn escaped_characters_of_paths_are_what_they_stand_for() {
        assert_eq!(path("XTS %28Base%29\\100%25.TcPOU"), "XTS (Base)/100%.TcPOU");
        assert_eq!(path("50% of it.TcPOU"), "50% of it.TcPOU");
        assert_eq!(path("a%C3%A4%"), "a\u{e4}%");
        assert_eq!(path("%ff"), "%ff");
    }

    #[test]
    fn what_is_no_project_is_reported() {
        assert!(matches!(files(b"<Project>\n<ItemGroup></Project>"), Err(ProjectError::Xml { line: 2, .. })));
        assert!(files(b"\0\0").is_err());
    }
}
