//! Bodies that are drawn, as TwinCAT 3 keeps them: archives of objects in `.TcPOU` files.
//!
//! | module | subject |
//! |---|---|
//! | [`archive`] | the objects of an archive and their values |
//! | [`cfc_element`], [`cfc`] | Continuous Function Charts to statements |
//! | [`flow`] | the order of a chart that its user did not order |
//! | [`network`], [`network_box`] | networks in LD and FBD to statements |
//! | [`chart_element`], [`chart`] | Sequential Function Charts to steps and transitions |
//! | [`call`] | a box to the call that it is |
//! | [`sheet`] | the statements of one body while they are made |
//!
//! Invariants: the order of evaluation is that of the archive; what is not understood is reported with its element, and
//! the body gives no other program instead.

mod archive;
mod call;
mod cfc;
mod cfc_element;
mod chart;
mod chart_element;
mod flow;
mod network;
mod network_box;
mod sheet;

use std::collections::BTreeMap;

use onescan_xml::Element;

use self::archive::{Object, Written};
use self::sheet::{Fault, Memories, Sheet};
use super::Taken;
use super::statement::{self, Line, Text};
use crate::diagnostic::Code;
use crate::syntax::tokenize;

/// A drawn body, as statements.
struct Drawn {
    lines: Vec<Line>,
    names: Vec<String>,
    faults: Vec<Fault>,
    notices: Vec<Fault>,
    /// Actions behind the unit that a chart needs.
    actions: Vec<Text>,
}

/// The drawn bodies of one object.
pub(super) struct Drawings<'f> {
    file: &'f str,
    /// By where the element of the language begins.
    bodies: BTreeMap<u32, Drawn>,
    memories: Memories,
    /// Actions that the body of the unit needs.
    actions: Vec<Text>,
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
        let plain: String = unit.chars().filter(char::is_ascii_alphanumeric).collect();
        // A name that the file does not have hides no other.
        let mut prefix = format!("Drawn_{plain}_");
        while file.to_ascii_uppercase().contains(&prefix.to_ascii_uppercase()) {
            prefix.push_str("N_");
        }
        let memories = Memories { prefix: Some(prefix), memory: Vec::new() };
        Self { file, bodies: BTreeMap::new(), memories, actions: Vec::new() }
    }

    /// Reads a body if it is drawn; `holder` is the object that it is part of.
    pub(super) fn read(&mut self, holder: &Element, keeps: Keeps) {
        let Some(implementation) = holder.child("Implementation") else { return };
        for language in implementation.elements() {
            let number = self.bodies.len() + 1;
            let prefix = self.memories.prefix.clone();
            if keeps == Keeps::Nothing {
                self.memories.prefix = None;
            }
            let drawn = drawn(self.file, holder, language, number, &mut self.memories);
            self.memories.prefix = prefix;
            if let Some(drawn) = drawn {
                self.bodies.insert(language.open.start, drawn);
            }
        }
    }

    /// Declares what remembers edges, and what composed values are made in.
    pub(super) fn declare_memory(&self, taken: &mut Taken) {
        let Some(first) = self.memories.memory.first() else { return };
        taken.extract.instead("VAR\n", first.place.clone());
        for memory in &self.memories.memory {
            let line = format!("    {} : {};\n", memory.name, memory.type_name);
            taken.extract.instead(&line, memory.place.clone());
        }
        taken.extract.instead("END_VAR\n", first.place.clone());
    }

    /// Writes the statements of a body that has been read; `false` if there is none.
    pub(super) fn write(&mut self, language: &Element, taken: &mut Taken) -> bool {
        let Some(drawn) = self.bodies.remove(&language.open.start) else { return false };
        for fault in drawn.faults {
            taken.report(fault.place, fault.code, &fault.message);
        }
        for notice in drawn.notices {
            taken.warn(notice.place, notice.code, &notice.message, None);
        }
        statement::write(drawn.lines, &drawn.names, self.file, &mut taken.extract);
        self.actions.extend(drawn.actions);
        true
    }

    /// Writes the actions that the unit's own body needs, behind the unit.
    pub(super) fn write_actions(&mut self, taken: &mut Taken) {
        let lines = self.actions.drain(..).map(Line::Other).collect();
        statement::write(lines, &[], self.file, &mut taken.extract);
    }
}

/// The transitions of a unit whose bodies are text.
fn transitions(file: &str, unit: &Element) -> BTreeMap<String, Written> {
    let named = unit.elements().filter(|part| part.name == "Transition");
    let body = |part: &Element| {
        let text = part.child("Implementation")?.child("ST")?;
        Some((part.attribute("Name")?.value.to_ascii_uppercase(), Written::below(file, text)))
    };
    named.filter_map(body).collect()
}

fn drawn(file: &str, holder: &Element, language: &Element, number: usize, memories: &mut Memories) -> Option<Drawn> {
    let mut sheet = Sheet::new(file, number, memories);
    let kind = match language.name.as_str() {
        "CFC" => "CFCImplementationObject",
        "NWL" => "NWLImplementationObject",
        "SFC" if holder.name == "POU" => "SFCImplementationObject",
        _ => return None,
    };
    let mut actions = Vec::new();
    match Object::first(language, kind) {
        None => {
            let message = format!("`<{}>` has no archive of a `{kind}`", language.name);
            sheet.report(&language.open, Code::MalformedXml, message);
        }
        Some(body) if language.name == "NWL" => network::read(&mut sheet, body),
        Some(body) if language.name == "SFC" => {
            report_flags(file, holder, &mut sheet);
            let bodies = transitions(file, holder);
            let bodies = bodies.iter().map(|(name, body)| (name.clone(), body)).collect();
            actions = chart::read(&mut sheet, body, &bodies);
        }
        Some(body) => {
            let flow = cfc::ordered_by_data_flow(file, holder);
            cfc::read(&mut sheet, body, flow.as_ref());
        }
    }
    let (lines, names, faults, notices) = sheet.finish();
    Some(Drawn { lines, names, faults, notices, actions })
}

/// Variables by which TwinCAT lets a unit reset, hold or step its chart.
const CHART_FLAGS: [&str; 11] = [
    "SFCINIT",
    "SFCRESET",
    "SFCERROR",
    "SFCENABLELIMIT",
    "SFCERRORSTEP",
    "SFCERRORPOU",
    "SFCQUITERROR",
    "SFCPAUSE",
    "SFCTRANS",
    "SFCTIP",
    "SFCTIPMODE",
];

/// Reports such variables: a chart that ignores them would do something else.
fn report_flags(file: &str, unit: &Element, sheet: &mut Sheet<'_>) {
    let Some(declaration) = unit.child("Declaration") else { return };
    let text = Written::below(file, declaration).plain;
    let words = tokenize(&text).into_iter().filter(|token| !token.kind.is_trivia());
    let words = words.filter_map(|token| text.get(token.start as usize..token.end as usize));
    for word in words.filter(|word| CHART_FLAGS.contains(&word.to_ascii_uppercase().as_str())) {
        sheet.unsupported(&declaration.open, &format!("the variable `{word}`, which governs a chart,"));
    }
}
