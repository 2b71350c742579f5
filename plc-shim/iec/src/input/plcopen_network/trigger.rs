//! Memory of edges: an instance of `R_TRIG` or `F_TRIG` for each contact, coil or pin that sees one.

use std::collections::BTreeSet;

use onescan_xml::Element;

use super::element::{Edge, Modifiers};
use crate::input::plcopen::Writer;

/// The edge that the element sees, on either side.
fn edge(element: &Element) -> Option<Edge> {
    const HOLDERS: [&str; 6] = ["contact", "coil", "variable", "inVariable", "outVariable", "inOutVariable"];
    if !HOLDERS.contains(&element.name.as_str()) {
        return None;
    }
    ["", "In", "Out"].iter().find_map(|suffix| Modifiers::of(element, suffix).edge)
}

impl Writer<'_> {
    /// Declares the memory of all edges in the bodies, actions and transitions of a unit.
    pub(in crate::input) fn declare_triggers(&mut self, unit: &Element) {
        let mut found = Vec::new();
        let mut open: Vec<&Element> =
            unit.elements().filter(|inner| matches!(inner.name.as_str(), "body" | "actions" | "transitions")).collect();
        while let Some(element) = open.pop() {
            found.extend(edge(element).map(|edge| (element, edge)));
            open.extend(element.elements());
        }
        found.sort_by_key(|(element, _)| element.open.start);
        let Some((first, _)) = found.first() else { return };
        let place = first.open.clone();
        self.write("VAR\n", &place);
        let taken: BTreeSet<String> = words(self.file).collect();
        for (element, edge) in found {
            let mut number = self.triggers.len() + 1;
            // A name that the file does not have hides no other.
            while taken.contains(&format!("EDGE{number}")) {
                number += taken.len();
            }
            let name = format!("Edge{number}");
            let block = if edge == Edge::Rising { "R_TRIG" } else { "F_TRIG" };
            self.write(&format!("    {name} : {block};\n"), &element.open);
            self.triggers.insert(element.open.start, name);
        }
        self.write("END_VAR\n", &place);
    }
}

/// The words of a text in capitals.
fn words(text: &str) -> impl Iterator<Item = String> {
    let words = text.split(|one: char| !(one.is_ascii_alphanumeric() || one == '_'));
    words.filter(|word| !word.is_empty()).map(str::to_ascii_uppercase)
}
