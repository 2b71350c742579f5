//! Files that are PLCopen XML already: their elements are taken over as they stand there, drawings to the byte.

use onescan_xml::{Attribute, Element, parse};

use super::Document;
use crate::output::Refused;
use onescan_iec::syntax::{FileId, Span};

/// What says how a tool shows a project, not what it is: of several files it would be several.
const ABOUT_THE_TOOL: &str = "projectstructure";

impl Document {
    /// Takes over what is in the file `id`.
    pub(super) fn take(&mut self, id: FileId, file: &str) {
        // What is not XML has been reported when it was read.
        let Ok(root) = parse(file) else { return };
        if let Err(refused) = self.take_prefixes(id, file, &root) {
            return self.refused.push(refused);
        }
        let types = root.child("types");
        let list = |name: &str| types.and_then(|types| types.child(name)).into_iter().flat_map(Element::elements);
        self.types.extend(list("dataTypes").map(|element| text_of(file, element)));
        self.units.extend(list("pous").map(|element| text_of(file, element)));
        let instances = root.child("instances").and_then(|instances| instances.child("configurations"));
        let configurations = instances.into_iter().flat_map(Element::elements);
        self.configurations.extend(configurations.map(|element| text_of(file, element)));
        let added =
            root.child("addData").into_iter().flat_map(Element::elements).filter(|data| !is_about_the_tool(data));
        self.added.extend(added.map(|element| text_of(file, element)));
    }

    /// The prefixes of the file's namespaces, which its elements need.
    fn take_prefixes(&mut self, id: FileId, file: &str, root: &Element) -> Result<(), Refused> {
        if let Some(prefix) = root.prefix(file) {
            let span = Span::new(id, 0, 0);
            return Err(Refused::plcopen(span, &format!("a file whose elements have the prefix `{prefix}`")));
        }
        for Attribute { name, value, .. } in root.attributes.iter().filter(|each| each.name.starts_with("xmlns:")) {
            let known = self.prefixes.entry(name.clone()).or_insert_with(|| value.clone());
            if known != value {
                let prefix = name.trim_start_matches("xmlns:");
                let what = format!("the prefix `{prefix}`, which stands for another namespace in another file,");
                return Err(Refused::plcopen(Span::new(id, 0, 0), &what));
            }
        }
        Ok(())
    }
}

fn is_about_the_tool(data: &Element) -> bool {
    let name = data.attribute("name").map_or("", |name| name.value.as_str());
    name.rsplit('/').next().is_some_and(|kind| kind.eq_ignore_ascii_case(ABOUT_THE_TOOL))
}

fn text_of(file: &str, element: &Element) -> String {
    let text = file.get(element.open.start as usize..element.close.end as usize).unwrap_or("");
    // Other files may end their lines otherwise; a tool reads one kind of line end as another.
    format!("{text}\n")
}
