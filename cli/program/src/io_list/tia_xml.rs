//! A tag table of TIA Portal as `SimaticML`, as Openness and the Version Control Interface write it; and the short form
//! `<Tagtable><Tag type= addr=>` of TIA's own XML export.

use std::path::Path;

use super::collect::Collected;
use super::error::ListError;
use super::tia::Tag;
use super::xml::{Element, document, text};
use super::{IoList, ListKind};

/// Reads the tags.
///
/// # Errors
/// It is not a tag table.
pub fn read(path: &Path, bytes: &[u8]) -> Result<IoList, ListError> {
    let text = text(path, bytes)?;
    let document = document(path, &text)?;
    let root = Element::root(&document);
    let mut collected = Collected::of(path);
    match root.name() {
        "Document" if root.below("SW.Tags.PlcTagTable").next().is_some() => {
            for element in root.below("SW.Tags.PlcTag") {
                openness(element, &mut collected)?;
            }
        }
        "Tagtable" => {
            for element in root.below("Tag") {
                let attribute = |name| element.attribute(name).unwrap_or_default();
                let name = element.text();
                let tag = Tag {
                    name: &name,
                    ty: attribute("type"),
                    address: attribute("addr"),
                    comment: attribute("remark"),
                    line: Some(element.line()),
                };
                tag.into_list(&mut collected)?;
            }
        }
        other => {
            let what = format!("<{other}> holds no tag table (`SW.Tags.PlcTagTable`)");
            let help = Some("export the tag table itself, not blocks or types".to_owned());
            return Err(ListError::Other { file: path.display().to_string(), what, help });
        }
    }
    Ok(collected.list(ListKind::TiaXml))
}

/// A tag of Openness: its attributes in one element, its comment in one for each language.
fn openness(element: Element, collected: &mut Collected) -> Result<(), ListError> {
    let attributes = element.child("AttributeList");
    let attribute = |name| attributes.and_then(|list| list.text_of(name)).unwrap_or_default();
    let comments =
        element.below("MultilingualText").filter(|text| text.attribute("CompositionName") == Some("Comment"));
    let mut comments = comments.flat_map(|text| text.below("Text")).map(Element::text);
    let tag = Tag {
        name: &attribute("Name"),
        ty: &attribute("DataTypeName"),
        address: &attribute("LogicalAddress"),
        comment: &comments.find(|text| !text.is_empty()).unwrap_or_default(),
        line: Some(element.line()),
    };
    tag.into_list(collected)
}
