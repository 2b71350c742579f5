//! PLCopen XML (TC6 2.01, IEC 61131-10): declarations that are elements, and bodies in ST, to text.
//!
//! Only what is text in the file is taken over as it is; the rest is written as the standard would
//! have it, and every word of it leads back to the element that it stands for.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use onescan_xml::{Element, XmlError, parse};

use super::Taken;
use super::plcopen_addition::{open_array, sections_of};
use super::plcopen_tool::Tool;
use crate::diagnostic::Code;
use crate::dialect::{Dialect, Feature};

/// Program text of a project.
pub(super) fn extract(file: &str) -> Result<Taken, XmlError> {
    let root = parse(file)?;
    let mut writer = Writer::new(file, Tool::of(file, &root), programs(&root));
    writer.strings = strings(&root);
    if root.name != "project" {
        let message = "`<project>` is wanted here: only PLCopen XML is read";
        writer.taken.report(root.open.clone(), Code::MalformedXml, message);
        return Ok(writer.taken);
    }
    if let Some(types) = root.child("types") {
        for data_type in types.child("dataTypes").into_iter().flat_map(Element::elements) {
            writer.data_type(data_type);
        }
        for pou in types.child("pous").into_iter().flat_map(Element::elements) {
            writer.pou(pou);
        }
    }
    let configurations = root.child("instances").and_then(|instances| instances.child("configurations"));
    let configurations: Vec<&Element> = configurations.into_iter().flat_map(Element::elements).collect();
    writer.leave_out_devices(&configurations);
    writer.vendor_objects(&root);
    writer.applications(&root, &configurations);
    for configuration in configurations.into_iter().filter(|each| !writer.is_left_out(each)).collect::<Vec<_>>() {
        writer.configuration(configuration);
    }
    Ok(writer.taken)
}

/// Names of all programs as keys.
fn programs(root: &Element) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut open = vec![root];
    while let Some(element) = open.pop() {
        let program = element.attribute("pouType").is_some_and(|kind| kind.value == "program");
        let name = element.attribute("name").filter(|_| element.name == "pou" && program);
        found.extend(name.map(|name| name.value.to_ascii_uppercase()));
        open.extend(element.elements());
    }
    found
}

/// What values of a string type stand between; nothing for other types.
fn quote(ty: &Element, known: &BTreeMap<String, char>) -> Option<char> {
    match ty.name.as_str() {
        "string" => Some('\''),
        "wstring" => Some('"'),
        "derived" => known.get(&ty.attribute("name")?.value.to_ascii_uppercase()).copied(),
        _ => None,
    }
}

/// Types of strings that the file declares, each behind those that it is made of, and the one that Beremiz gives.
fn strings(root: &Element) -> BTreeMap<String, char> {
    let mut found = BTreeMap::from([("HMI_STRING".to_owned(), '\'')]);
    let types = root.child("types").and_then(|types| types.child("dataTypes"));
    for declared in types.into_iter().flat_map(Element::elements) {
        let base = declared.child("baseType").and_then(|base| base.elements().next());
        if let (Some(name), Some(quote)) = (declared.attribute("name"), base.and_then(|base| quote(base, &found))) {
            found.insert(name.value.to_ascii_uppercase(), quote);
        }
    }
    found
}

pub(super) struct Writer<'a> {
    pub(super) taken: Taken,
    pub(super) file: &'a str,
    /// What wrote it.
    pub(super) tool: Tool,
    /// Names of the file's programs as keys: what is called by such a name keeps its outputs.
    pub(super) programs: BTreeSet<String>,
    /// Instances that remember edges, by where the element begins that sees one.
    pub(super) triggers: BTreeMap<u32, String>,
    /// How many networks have been written.
    pub(super) bodies: u32,
    /// The transition whose body is being written, by its name in the file, and the one it has in the text.
    pub(super) transition: Option<(String, String)>,
    /// The file's own types of strings, as keys, and what their values stand between.
    strings: BTreeMap<String, char>,
    /// Where the configurations begin that are not read.
    pub(super) left_out: BTreeSet<u32>,
}

/// Sections of an interface and their keywords (TC6 2.01, `interface`).
const SECTIONS: [(&str, &str); 7] = [
    ("localVars", "VAR"),
    ("inputVars", "VAR_INPUT"),
    ("outputVars", "VAR_OUTPUT"),
    ("inOutVars", "VAR_IN_OUT"),
    ("tempVars", "VAR_TEMP"),
    ("externalVars", "VAR_EXTERNAL"),
    ("globalVars", "VAR_GLOBAL"),
];

/// What a section may be beside (TC6 2.01, `varList`).
const QUALIFIERS: [(&str, &str); 4] =
    [("constant", " CONSTANT"), ("retain", " RETAIN"), ("nonretain", " NON_RETAIN"), ("persistent", " PERSISTENT")];

impl<'a> Writer<'a> {
    fn new(file: &'a str, tool: Tool, programs: BTreeSet<String>) -> Self {
        let taken = Taken { dialect: tool.dialect(), ..Taken::default() };
        let (triggers, strings, left_out) = (BTreeMap::new(), BTreeMap::new(), BTreeSet::new());
        Self { taken, file, tool, programs, triggers, bodies: 0, transition: None, strings, left_out }
    }
}

impl Writer<'_> {
    pub(super) fn write(&mut self, text: &str, place: &Range<u32>) {
        self.taken.extract.instead(text, place.clone());
    }

    /// Writes an attribute's value; what has none is reported.
    pub(super) fn attribute(&mut self, element: &Element, name: &str) {
        if let Some(found) = element.attribute(name) {
            self.write(&found.value, &found.span);
        } else {
            let message = format!("`<{}>` has no attribute `{name}`", element.name);
            self.taken.report(element.open.clone(), Code::MalformedXml, &message);
        }
    }

    pub(super) fn data_type(&mut self, element: &Element) {
        self.write("TYPE ", &element.open);
        self.attribute(element, "name");
        self.type_heritage(element);
        self.write(" : ", &element.open);
        self.inner_type(element, "baseType");
        self.initial_value(element);
        self.write(";\nEND_TYPE\n", &element.close);
    }

    pub(super) fn pou(&mut self, element: &Element) {
        let (keyword, end) = match element.attribute("pouType").map(|kind| kind.value.as_str()) {
            Some("function") => ("FUNCTION ", "END_FUNCTION\n"),
            Some("functionBlock") => ("FUNCTION_BLOCK ", "END_FUNCTION_BLOCK\n"),
            Some("program") => ("PROGRAM ", "END_PROGRAM\n"),
            _ => {
                let message = "`pouType` is `function`, `functionBlock` or `program`";
                self.taken.report(element.open.clone(), Code::MalformedXml, message);
                return;
            }
        };
        self.write(keyword, &element.open);
        let interface = element.child("interface");
        if keyword == "FUNCTION_BLOCK " {
            self.modifiers(element);
        }
        self.attribute(element, "name");
        self.heritage(interface);
        if let Some(result) = interface.and_then(|interface| interface.child("returnType")) {
            self.write(" : ", &result.open);
            self.type_in(result);
        }
        self.write("\n", &element.open);
        for section in interface.into_iter().flat_map(Element::elements) {
            self.interface_section(section);
        }
        if keyword != "FUNCTION " {
            self.declare_triggers(element);
        }
        let mut used = Vec::new();
        for body in element.elements().filter(|inner| inner.name == "body") {
            match body.child("SFC") {
                Some(sfc) => self.chart(sfc, element, &mut used),
                None => self.body(body),
            }
        }
        self.write(end, &element.close);
        self.actions(element, &mut used);
        self.members(element);
    }

    pub(super) fn body(&mut self, body: &Element) {
        for language in body.elements() {
            match language.name.as_str() {
                "ST" | "IL" => {
                    self.text_below(language);
                    self.write("\n", &language.close);
                }
                "LD" | "FBD" => self.network(language),
                "documentation" | "addData" => {}
                other => self.taken.unsupported(language.open.clone(), &format!("a body in {other}")),
            }
        }
    }

    /// The text of an element and of the XHTML in it, each paragraph a line.
    pub(super) fn text_below(&mut self, element: &Element) {
        self.taken.text_of(self.file, element);
        for inner in element.elements() {
            if inner.name == "br" {
                self.write("\n", &inner.open);
            } else {
                self.text_below(inner);
                self.write(if inner.name == "p" { "\n" } else { " " }, &inner.close);
            }
        }
    }

    pub(super) fn globals(&mut self, element: &Element) {
        for section in element.elements().filter(|inner| inner.name == "globalVars") {
            self.section(section);
        }
    }

    /// A section of a unit. The schema has none for `VAR_STAT`, so CODESYS and TwinCAT write `<globalVars>` there.
    pub(super) fn interface_section(&mut self, element: &Element) {
        let is_static = element.name == "globalVars" && self.taken.dialect.has(Feature::StaticSection);
        self.section_called(element, is_static.then_some("VAR_STAT"));
    }

    pub(super) fn section(&mut self, element: &Element) {
        self.section_called(element, None);
    }

    fn section_called(&mut self, element: &Element, instead: Option<&'static str>) {
        let parts = sections_of(element);
        if !parts.is_empty() {
            // CODESYS: the list has variables of several kinds, and the attributes of the whole are those of some.
            for part in parts {
                self.section_called(part, instead);
            }
            return;
        }
        let name = element.name.as_str();
        let known = SECTIONS.iter().find(|(known, _)| *known == name).map(|(_, keyword)| *keyword);
        let Some(keyword) = instead.or(known) else {
            if !matches!(name, "returnType" | "documentation" | "addData") {
                self.taken.unsupported(element.open.clone(), &format!("`<{name}>`"));
            }
            return;
        };
        self.write(keyword, &element.open);
        for (qualifier, text) in QUALIFIERS {
            let set = element.attribute(qualifier).filter(|found| found.value == "true");
            if let Some(set) = set {
                self.write(text, &set.span);
            }
        }
        self.write("\n", &element.open);
        let mut current = keyword;
        for variable in element.elements().filter(|inner| inner.name == "variable") {
            let open = open_array(variable);
            let wanted = open.as_ref().map_or(keyword, |open| open.section);
            if wanted != std::mem::replace(&mut current, wanted) {
                self.write(&format!("END_VAR\n{wanted}\n"), &variable.open);
            }
            self.write("    ", &variable.open);
            match open {
                Some(open) => self.open_array(variable, open.ty),
                None => self.variable(variable),
            }
        }
        self.write("END_VAR\n", &element.close);
    }

    fn open_array(&mut self, element: &Element, ty: &str) {
        self.attribute(element, "name");
        self.write(&format!(" : {ty};\n"), &element.open);
    }

    /// The members of a structure or union.
    pub(super) fn fields(&mut self, element: &Element) {
        for field in element.elements().filter(|inner| inner.name == "variable") {
            self.variable(field);
        }
    }

    fn variable(&mut self, element: &Element) {
        self.attribute(element, "name");
        self.address_and_type(element);
    }

    /// ` AT %IX0.0 : BOOL := TRUE;`
    pub(super) fn address_and_type(&mut self, element: &Element) {
        if let Some(address) = element.attribute("address").filter(|address| !address.value.is_empty()) {
            self.write(" AT ", &address.span);
            self.write(&address.value, &address.span);
        }
        self.write(" : ", &element.open);
        self.inner_type(element, "type");
        self.init_arguments(element);
        self.initial_value(element);
        self.write(";\n", &element.close);
    }

    /// The type in the child `name`.
    pub(super) fn inner_type(&mut self, element: &Element, name: &str) {
        if let Some(inner) = element.child(name) {
            self.type_in(inner);
        } else {
            let message = format!("`<{}>` has no `<{name}>`", element.name);
            self.taken.report(element.open.clone(), Code::MalformedXml, &message);
        }
    }

    pub(super) fn type_in(&mut self, holder: &Element) {
        let Some(element) = holder.elements().next() else {
            let message = format!("`<{}>` is empty", holder.name);
            self.taken.report(holder.open.clone(), Code::MalformedXml, &message);
            return;
        };
        match element.name.as_str() {
            "derived" => self.attribute(element, "name"),
            "string" | "wstring" => {
                self.write(&element.name.to_uppercase(), &element.open);
                if let Some(length) = element.attribute("length") {
                    self.write(&format!("[{}]", length.value), &length.span);
                }
            }
            "array" => {
                self.write("ARRAY [", &element.open);
                self.ranges(element);
                self.write("] OF ", &element.open);
                self.inner_type(element, "baseType");
            }
            "struct" => {
                self.write("STRUCT\n", &element.open);
                self.fields(element);
                self.write("END_STRUCT", &element.close);
            }
            "enum" => self.enumeration(element),
            "subrangeSigned" | "subrangeUnsigned" => {
                self.inner_type(element, "baseType");
                self.write(" (", &element.open);
                self.ranges(element);
                self.write(")", &element.open);
            }
            "pointer" => {
                self.write("POINTER TO ", &element.open);
                self.inner_type(element, "baseType");
            }
            elementary => self.write(elementary, &element.open),
        }
    }

    /// `1..2, 3..4`
    fn ranges(&mut self, element: &Element) {
        let ranges = element.elements().filter(|inner| matches!(inner.name.as_str(), "dimension" | "range"));
        for (index, range) in ranges.enumerate() {
            if index > 0 {
                self.write(", ", &range.open);
            }
            self.attribute(range, "lower");
            self.write("..", &range.open);
            self.attribute(range, "upper");
        }
    }

    fn enumeration(&mut self, element: &Element) {
        self.write("(", &element.open);
        let values = element.child("values").into_iter().flat_map(Element::elements);
        for (index, value) in values.filter(|inner| inner.name == "value").enumerate() {
            if index > 0 {
                self.write(", ", &value.open);
            }
            self.attribute(value, "name");
            if let Some(number) = value.attribute("value") {
                self.write(" := ", &number.span);
                self.write(&number.value, &number.span);
            }
        }
        self.write(")", &element.close);
        if let Some(base) = element.child("baseType") {
            self.write(" ", &base.open);
            self.type_in(base);
        }
    }

    fn initial_value(&mut self, element: &Element) {
        if let Some(value) = element.child("initialValue") {
            self.write(" := ", &value.open);
            if !self.bare_string(element, value) {
                self.value_in(value);
            }
        }
    }

    /// Beremiz' editor takes strings without quotes, and its generator puts them there. True if it was one.
    fn bare_string(&mut self, element: &Element, value: &Element) -> bool {
        let ty = ["type", "baseType"].iter().find_map(|name| element.child(name)?.elements().next());
        let quote = ty.and_then(|ty| quote(ty, &self.strings)).filter(|_| self.taken.dialect == Dialect::Matiec);
        let text = value.child("simpleValue").and_then(|simple| simple.attribute("value"));
        let (Some(quote), Some(text)) = (quote, text) else { return false };
        if text.value.starts_with(quote) || text.value.ends_with(quote) {
            return false;
        }
        self.write(&format!("{quote}{}{quote}", text.value), &text.span);
        true
    }

    fn value_in(&mut self, holder: &Element) {
        for value in holder.elements() {
            match value.name.as_str() {
                "simpleValue" => self.attribute(value, "value"),
                "arrayValue" => self.list(value, "[", "]"),
                "structValue" => self.list(value, "(", ")"),
                _ => {}
            }
        }
    }

    fn list(&mut self, element: &Element, open: &str, close: &str) {
        self.write(open, &element.open);
        for (index, value) in element.elements().filter(|inner| inner.name == "value").enumerate() {
            if index > 0 {
                self.write(", ", &value.open);
            }
            if let Some(member) = value.attribute("member") {
                self.write(&format!("{} := ", member.value), &member.span);
            }
            match value.attribute("repetitionValue").filter(|times| times.value != "1") {
                Some(times) => {
                    self.write(&format!("{}(", times.value), &times.span);
                    self.value_in(value);
                    self.write(")", &times.span);
                }
                None => self.value_in(value),
            }
        }
        self.write(close, &element.close);
    }
}

#[cfg(test)]
mod tests {
    use crate::input::Input;
    use crate::input::kind::SourceKind;

    const PROJECT: &str = include_str!("../../../tests/inputs/ramp.xml");

    #[test]
    fn elements_become_text() {
        let input = Input::from_text("ramp.xml", SourceKind::PlcOpen, PROJECT);
        insta::assert_snapshot!(input.file().text());
        assert!(input.diagnostics.is_empty(), "{:?}", input.diagnostics);
    }

    #[test]
    fn every_word_leads_back() {
        let input = Input::from_text("ramp.xml", SourceKind::PlcOpen, PROJECT);
        let text = input.file().text();
        for (word, in_the_file) in [("Gain", "Gain"), ("40", "40"), ("<", "&lt;"), ("STRUCT", "<struct>")] {
            let at = text.find(word).expect(word) as u32;
            let place = input.file().shown_range(at, at + word.len() as u32);
            assert_eq!(&PROJECT[place.start as usize..place.end as usize], in_the_file);
        }
    }
}
