//! Bodies that are drawn, as TwinCAT 3 keeps them: archives of objects in `.TcPOU` files.
//!
//! | module | subject |
//! |---|---|
//! | [`archive`] | the objects of an archive and their values |
//! | [`cfc_element`], [`cfc`] | Continuous Function Charts to statements |
//! | [`network`], [`network_box`] | networks in LD and FBD to statements |
//! | [`call`] | a box to the call that it is |
//! | [`sheet`] | the statements of one body while they are made |
//!
//! Invariants: the order of evaluation is that of the archive; what is not understood is told with its element, and
//! the body gives no other program instead.

mod archive;
mod call;
mod cfc;
mod cfc_element;
mod network;
mod network_box;
mod sheet;

use std::collections::BTreeMap;

use self::archive::Object;
use self::sheet::{Edge, Edges, Fault, Sheet};
use super::Taken;
use super::statement::{self, Line};
use super::xml::Element;
use crate::diagnostic::Code;

/// A drawn body, as statements.
struct Drawn {
    lines: Vec<Line>,
    names: Vec<String>,
    faults: Vec<Fault>,
}

/// The drawn bodies of one object.
pub(super) struct Drawings<'f> {
    file: &'f str,
    /// By where the element of the language begins.
    bodies: BTreeMap<u32, Drawn>,
    edges: Edges,
}

/// What a unit remembers from one call to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Keeps {
    State,
    Nothing,
}

impl<'f> Drawings<'f> {
    /// `unit` is the name of the unit that the bodies belong to.
    pub(super) fn new(file: &'f str, unit: &str) -> Self {
        let plain: String = unit.chars().filter(|one| one.is_ascii_alphanumeric()).collect();
        // A name that the file does not have hides no other.
        let mut prefix = format!("Edge_{plain}_");
        while file.to_ascii_uppercase().contains(&prefix.to_ascii_uppercase()) {
            prefix.push_str("N_");
        }
        Self { file, bodies: BTreeMap::new(), edges: Edges { prefix: Some(prefix), memory: Vec::new() } }
    }

    /// Reads a body if it is drawn; `holder` is the object that it is part of.
    pub(super) fn read(&mut self, holder: &Element, keeps: Keeps) {
        let Some(implementation) = holder.child("Implementation") else { return };
        for language in implementation.elements() {
            let number = self.bodies.len() + 1;
            let prefix = self.edges.prefix.clone();
            if keeps == Keeps::Nothing {
                self.edges.prefix = None;
            }
            let drawn = drawn(self.file, holder, language, number, &mut self.edges);
            self.edges.prefix = prefix;
            if let Some(drawn) = drawn {
                self.bodies.insert(language.open.start, drawn);
            }
        }
    }

    /// Declares what remembers edges.
    pub(super) fn declare_memory(&self, taken: &mut Taken) {
        let Some(first) = self.edges.memory.first() else { return };
        taken.extract.instead("VAR\n", first.place.clone());
        for memory in &self.edges.memory {
            let block = match memory.edge {
                Edge::Rising => "R_TRIG",
                Edge::Falling => "F_TRIG",
            };
            taken.extract.instead(&format!("    {} : {block};\n", memory.name), memory.place.clone());
        }
        taken.extract.instead("END_VAR\n", first.place.clone());
    }

    /// Writes the statements of a body that has been read; `false` if there is none.
    pub(super) fn write(&mut self, language: &Element, taken: &mut Taken) -> bool {
        let Some(drawn) = self.bodies.remove(&language.open.start) else { return false };
        for fault in drawn.faults {
            taken.report(fault.place, fault.code, &fault.message);
        }
        statement::write(drawn.lines, &drawn.names, self.file, &mut taken.extract);
        true
    }
}

fn drawn(file: &str, holder: &Element, language: &Element, number: usize, edges: &mut Edges) -> Option<Drawn> {
    let mut sheet = Sheet::new(file, number, edges);
    let kind = match language.name.as_str() {
        "CFC" => "CFCImplementationObject",
        "NWL" => "NWLImplementationObject",
        _ => return None,
    };
    match Object::first(language, kind) {
        None => {
            let message = format!("`<{}>` has no archive of a `{kind}`", language.name);
            sheet.report(&language.open, Code::MalformedXml, message);
        }
        Some(body) if language.name == "NWL" => network::read(&mut sheet, body),
        Some(body) => {
            if let Some(place) = cfc::ordered_by_data_flow(file, holder) {
                let what = "a chart that TwinCAT orders by the flow of its data (set `Explicit Execution Order` in \
                            its properties, which stores the order)";
                sheet.unsupported(&place, what);
            }
            cfc::read(&mut sheet, body);
        }
    }
    let (lines, names, faults) = sheet.finish();
    Some(Drawn { lines, names, faults })
}
