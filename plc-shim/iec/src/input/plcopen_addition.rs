//! What CODESYS adds to PLCopen XML in `addData`.

use onescan_xml::Element;

/// Beginning of the names of CODESYS' additions.
const VENDOR: &str = "http://www.3s-software.com/plcopenxml/";

/// The additions of one kind that an element holds.
pub(super) fn additions<'e>(element: &'e Element, kind: &'static str) -> impl Iterator<Item = &'e Element> {
    let data = element.elements().filter(|inner| inner.name == "addData").flat_map(Element::elements);
    let named = data.filter(move |data| {
        let name = data.attribute("name").and_then(|name| name.value.strip_prefix(VENDOR));
        name.is_some_and(|name| name.eq_ignore_ascii_case(kind))
    });
    named.flat_map(Element::elements)
}

/// The sections of a list that has variables of several kinds, as `VAR_GLOBAL CONSTANT` beside `VAR_GLOBAL`; none if
/// the list itself is the only one.
pub(crate) fn sections_of(list: &Element) -> Vec<&Element> {
    additions(list, "mixedattrsvarlist").flat_map(Element::elements).collect()
}
