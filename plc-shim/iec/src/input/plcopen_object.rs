//! What PLCopen XML has for actions, and what CODESYS adds to it in `addData`: methods, properties,
//! interfaces, bases, unions, lists of global variables.

use onescan_xml::{Element, Node};

use super::plcopen::Writer;
use super::plcopen_addition::additions;
use crate::dialect::Feature;

/// The text of an element without markup.
pub fn inner_text(file: &str, element: &Element) -> String {
    let piece = |node: &Node| match node {
        Node::Verbatim(span) => file.get(span.start as usize..span.end as usize).unwrap_or("").to_owned(),
        Node::Reference(character, _) => character.to_string(),
        Node::Element(inner) => inner_text(file, inner),
    };
    element.children.iter().map(piece).collect::<String>().trim().to_owned()
}

impl Writer<'_> {
    /// Units, types, interfaces and lists that CODESYS keeps outside of their places.
    pub(super) fn vendor_objects(&mut self, element: &Element) {
        for pou in additions(element, "pou") {
            self.pou(pou);
        }
        for data_type in additions(element, "datatype") {
            self.data_type(data_type);
        }
        for union in additions(element, "union") {
            self.union(union);
        }
        for interface in additions(element, "interface") {
            self.interface(interface);
        }
        for list in additions(element, "globalvars") {
            self.global_list(list);
        }
        if element.name == "resource" {
            element
                .elements()
                .filter(|inner| self.is_list(inner))
                .collect::<Vec<_>>()
                .into_iter()
                .for_each(|list| self.global_list(list));
        }
        let places = ["instances", "configurations", "configuration", "resource"];
        for inner in element.elements().filter(|inner| places.contains(&inner.name.as_str())) {
            if self.is_left_out(inner) {
                continue;
            }
            self.vendor_objects(inner);
        }
        for application in additions(element, "application") {
            self.vendor_objects(application);
            for resource in application.elements().filter(|inner| inner.name == "resource") {
                self.vendor_objects(resource);
            }
        }
    }

    /// ` EXTENDS a IMPLEMENTS b, c`
    pub(super) fn heritage(&mut self, interface: Option<&Element>) {
        for inheritance in interface.into_iter().flat_map(|interface| additions(interface, "pouinheritance")) {
            for (element, word) in [("Extends", " EXTENDS "), ("Implements", " IMPLEMENTS ")] {
                self.names(inheritance, element, word);
            }
        }
    }

    /// ` EXTENDS a` of a structure
    pub(super) fn type_heritage(&mut self, data_type: &Element) {
        for inheritance in additions(data_type, "datatypeinheritance") {
            self.names(inheritance, "Extends", " EXTENDS ");
        }
    }

    /// `(a := 1, 2)`, what a variable gives to `FB_init` of its type.
    pub(super) fn init_arguments(&mut self, variable: &Element) {
        let given = additions(variable, "inputassignments").flat_map(Element::elements);
        let given: Vec<_> = given.filter(|inner| inner.name == "InputAssignment").collect();
        let Some(first) = given.first() else { return };
        let derived = variable.child("type").and_then(|ty| ty.child("derived")?.attribute("name"));
        // Nothing is made for a reference, `REFERENCE TO F`, that could take them.
        if derived.is_some_and(|name| name.value.contains(' ')) {
            return;
        }
        if derived.is_none() {
            self.taken.unsupported(first.open.clone(), "an argument of `FB_init` for the elements of an array");
            return;
        }
        for (index, assignment) in given.iter().enumerate() {
            self.write(if index == 0 { "(" } else { ", " }, &assignment.open);
            if let Some(name) = assignment.child("Name") {
                self.write(&format!("{} := ", inner_text(self.file, name)), &name.open);
            }
            if let Some(value) = assignment.child("Value") {
                self.write(&inner_text(self.file, value), &value.open);
            }
        }
        self.write(")", &first.close);
    }

    /// `<union name="u">`, whose members are those of a structure.
    fn union(&mut self, union: &Element) {
        self.write("TYPE ", &union.open);
        self.attribute(union, "name");
        self.write(" : UNION\n", &union.open);
        self.fields(union);
        self.write("END_UNION;\nEND_TYPE\n", &union.close);
    }

    fn names(&mut self, holder: &Element, element: &str, word: &str) {
        for (index, name) in holder.elements().filter(|inner| inner.name == element).enumerate() {
            self.write(if index == 0 { word } else { ", " }, &name.open);
            let text = inner_text(self.file, name);
            self.write(&text, &name.open);
        }
    }

    /// `<action name="a">`; a transition is part of a chart. `used` are names of transitions that have been written.
    pub(super) fn actions(&mut self, pou: &Element, used: &mut Vec<String>) {
        let sfc = |element: &Element| element.child("body").is_some_and(|body| body.child("SFC").is_some());
        let lists = || pou.elements().filter(|inner| matches!(inner.name.as_str(), "actions" | "transitions"));
        let has_chart = sfc(pou) || lists().flat_map(Element::elements).any(sfc);
        for inner in lists().flat_map(Element::elements) {
            if inner.name == "transition" && has_chart {
                continue;
            }
            if inner.name != "action" {
                let name = inner.attribute("name").map_or("", |name| name.value.as_str());
                let what = format!("{} `{name}`", inner.name.to_uppercase());
                self.taken.unsupported(inner.open.clone(), &what);
                continue;
            }
            self.action(inner, pou, used);
        }
    }

    /// Actions that are written in the steps of an action's chart stand behind it.
    fn action(&mut self, action: &Element, pou: &Element, used: &mut Vec<String>) {
        self.write("ACTION ", &action.open);
        self.attribute(action, "name");
        self.write(":\n", &action.open);
        let mut inline = Vec::new();
        for body in action.elements().filter(|inner| inner.name == "body") {
            match body.child("SFC") {
                Some(sfc) => inline.extend(self.chart_parts(sfc, pou, used)),
                None => self.body(body),
            }
        }
        self.write("END_ACTION\n", &action.close);
        self.inline_actions(inline);
    }

    fn bodies(&mut self, element: &Element) {
        for body in element.elements().filter(|inner| inner.name == "body") {
            self.body(body);
        }
    }

    /// Methods and properties behind their unit.
    pub(super) fn members(&mut self, pou: &Element) {
        for method in additions(pou, "method") {
            self.method(method);
        }
        for property in additions(pou, "property") {
            self.property(property);
        }
    }

    fn method(&mut self, method: &Element) {
        self.write("METHOD ", &method.open);
        self.member_head(method);
        self.variables(method.child("interface"));
        self.bodies(method);
        self.write("END_METHOD\n", &method.close);
    }

    /// Who may use a unit or member, and what may be derived from it.
    pub(super) fn modifiers(&mut self, element: &Element) {
        for holder in [Some(element), element.child("interface")].into_iter().flatten() {
            for modifiers in additions(holder, "accessmodifiers") {
                for modifier in modifiers.attributes.iter().filter(|found| found.value == "true") {
                    self.write(&format!("{} ", modifier.name.to_uppercase()), &modifier.span);
                }
            }
        }
    }

    /// Access, name and type of a method or property.
    fn member_head(&mut self, member: &Element) {
        let interface = member.child("interface");
        self.modifiers(member);
        self.attribute(member, "name");
        if let Some(result) = interface.and_then(|interface| interface.child("returnType")) {
            self.write(" : ", &result.open);
            self.type_in(result);
        }
        self.write("\n", &member.open);
    }

    fn variables(&mut self, interface: Option<&Element>) {
        for section in interface.into_iter().flat_map(Element::elements) {
            self.interface_section(section);
        }
    }

    fn property(&mut self, property: &Element) {
        self.write("PROPERTY ", &property.open);
        self.member_head(property);
        for (element, begin, end) in [("GetAccessor", "GET\n", "END_GET\n"), ("SetAccessor", "SET\n", "END_SET\n")] {
            if let Some(accessor) = property.child(element) {
                self.write(begin, &accessor.open);
                self.variables(accessor.child("interface"));
                self.bodies(accessor);
                self.write(end, &accessor.close);
            }
        }
        self.write("END_PROPERTY\n", &property.close);
    }

    /// `<Interface name="I"><Methods>..</Methods><Properties>..</Properties></Interface>`
    fn interface(&mut self, interface: &Element) {
        self.write("INTERFACE ", &interface.open);
        self.attribute(interface, "name");
        self.names(interface, "Extends", " EXTENDS ");
        if let Some(inheritance) = interface.child("Inheritance") {
            self.names(inheritance, "Extends", " EXTENDS ");
        }
        self.heritage(Some(interface));
        self.write("\n", &interface.open);
        for list in interface.elements() {
            for member in list.elements() {
                match (list.name.as_str(), member.name.as_str()) {
                    ("Methods", "Method") => self.method(member),
                    ("Properties", "Property") => self.property(member),
                    _ => {}
                }
            }
        }
        self.members(interface);
        self.write("END_INTERFACE\n", &interface.close);
    }

    /// True for a list of global variables, which CODESYS and TwinCAT have in resources, too.
    pub(super) fn is_list(&self, element: &Element) -> bool {
        let has_name = element.attribute("name").is_some_and(|name| !name.value.is_empty());
        element.name == "globalVars" && has_name && self.taken.dialect.has(Feature::StaticSection)
    }

    /// A list's variables are known with and without its name.
    fn global_list(&mut self, list: &Element) {
        if list.attribute("name").is_none() {
            self.section(list);
            return;
        }
        self.write("NAMESPACE OPEN ", &list.open);
        self.attribute(list, "name");
        self.write("\n", &list.open);
        self.section(list);
        self.write("END_NAMESPACE\n", &list.close);
    }
}
