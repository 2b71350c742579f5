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

/// An `ARRAY [*]` of CODESYS, which PLCopen XML does not have: it stands in the file as a pointer.
pub(crate) struct OpenArray<'e> {
    /// The keyword of the section that it is declared in; the file has it among the inputs.
    pub(crate) section: &'static str,
    /// Its type as declared.
    pub(crate) ty: &'e str,
}

/// What a variable was before it became a pointer.
pub(crate) fn open_array(variable: &Element) -> Option<OpenArray<'_>> {
    let data = variable.child("addData")?.elements();
    let lists = data.filter_map(|data| data.child("Attributes"));
    let all: Vec<&Element> = lists.flat_map(Element::elements).collect();
    let value = |name: &str| {
        let named = all.iter().find(|each| each.attribute("Name").is_some_and(|found| found.value == name))?;
        named.attribute("Value").map(|found| found.value.as_str())
    };
    let section = match value("variable_length_array_original_scope")? {
        "Input" => "VAR_INPUT",
        "Output" => "VAR_OUTPUT",
        "Inout" => "VAR_IN_OUT",
        _ => return None,
    };
    Some(OpenArray { section, ty: value("variable_length_array")? })
}

#[cfg(test)]
mod tests {
    use crate::input::Input;
    use crate::input::kind::SourceKind;

    #[test]
    fn an_array_without_bounds_is_declared_where_its_author_has_it() {
        let variable = |name: &str, more: &str| {
            format!(
                "<variable name=\"{name}\"><type><pointer><baseType><LREAL /></baseType></pointer></type>{more}</variable>"
            )
        };
        let more = "<addData><data name=\"http://www.3s-software.com/plcopenxml/attributes\" handleUnknown=\"implementation\"><Attributes>
            <Attribute Name=\"variable_length_array_original_scope\" Value=\"Inout\" /><Attribute Name=\"variable_length_array\" Value=\"ARRAY[*] OF LREAL\" />
            <Attribute Name=\"Dimensions\" Value=\"1\" /></Attributes></data></addData>";
        let text = format!(
            "<project xmlns=\"http://www.plcopen.org/xml/tc6_0200\"><types><dataTypes /><pous><pou name=\"F\" pouType=\"function\"><interface>
             <returnType><BOOL /></returnType><inputVars>{}{}{}</inputVars></interface><body><ST><xhtml xmlns=\"http://www.w3.org/1999/xhtml\">F := a = 0;</xhtml></ST></body></pou></pous></types></project>",
            variable("a", ""),
            variable("b", more),
            variable("c", "")
        );
        let input = Input::from_text("f.xml", SourceKind::PlcOpen, text);
        insta::assert_snapshot!(input.file().text(), @r"
        FUNCTION F : BOOL
        VAR_INPUT
            a : POINTER TO LREAL;
        END_VAR
        VAR_IN_OUT
            b : ARRAY[*] OF LREAL;
        END_VAR
        VAR_INPUT
            c : POINTER TO LREAL;
        END_VAR
        F := a = 0; 
        END_FUNCTION
        ");
    }
}
