//! Boxes of networks.
//!
//! A box with EN is called where EN is TRUE; where it is not, its outputs hand on nothing, so that their variables keep
//! their values, and ENO is FALSE.

use std::ops::Range;

use super::archive::{Object, Written};
use super::call::{Argument, Block, Callee, EN, Output, Taker};
use super::network::{Networks, is_given, outputs, stored};
use super::sheet::{Signal, is_name};
use crate::diagnostic::Code;
use crate::input::statement::Text;

/// An output of a box in the archive.
struct Slot<'e> {
    name: String,
    target: Option<Object<'e>>,
}

/// A box as the archive has it.
struct Shape<'e> {
    place: Range<u32>,
    id: String,
    callee: Callee,
    /// True if the first input is EN.
    has_en: bool,
    /// True if the first slot is ENO.
    has_eno: bool,
    slots: Vec<Slot<'e>>,
}

impl Shape<'_> {
    /// The slot that the line to the next element begins at: the one that has no target of its own.
    fn handed_on(&self) -> Option<usize> {
        if self.slots.is_empty() {
            return Some(0);
        }
        self.slots.iter().position(|slot| slot.target.is_none())
    }

    fn result(&self) -> usize {
        usize::from(self.has_eno)
    }
}

impl Networks<'_, '_> {
    /// Calls a box; its value if it is wanted.
    pub(super) fn block(&mut self, tree: Object<'_>, is_wanted: bool) -> Option<Signal> {
        let file = self.sheet.file;
        let (place, id) = (tree.place(), tree.id(file));
        let own = self.flags(tree);
        if own != 0 {
            self.sheet.unsupported(&place, &format!("a box (id {id}) with the flags {own}"));
            return None;
        }
        let snippet = tree.object("STSnippet");
        let shape = if snippet.is_some() { self.shape(tree, "EXECUTE") } else { self.shape_of_call(tree)? };
        let faults = self.sheet.faults.len();
        let (enable, arguments) = self.inputs(tree, &shape);
        if self.sheet.faults.len() > faults {
            return None;
        }
        // It is looked at before the box and reported as ENO behind it.
        let enable = match enable {
            Signal::Value(value) => {
                let wire = self.sheet.wire(&id, 0);
                self.sheet.define(wire, value);
                Signal::Value(Text::wire(wire, &place))
            }
            Signal::On => Signal::On,
        };
        if let Some(snippet) = snippet {
            self.snippet(snippet, enable.clone(), &place);
            return (is_wanted && shape.has_eno).then_some(enable);
        }
        self.call(shape, enable, arguments, is_wanted)
    }

    fn shape_of_call<'e>(&mut self, tree: Object<'e>) -> Option<Shape<'e>> {
        let file = self.sheet.file;
        let type_name = tree.word(file, "BoxType").trim().to_owned();
        let kind = tree.word(file, "CallType");
        let instance = tree.object("Instance").map(|each| each.word(file, "Operand")).unwrap_or_default();
        let instance = instance.trim();
        let has_instance = is_given(instance) && kind != "Method";
        let mut shape = self.shape(tree, if type_name.is_empty() { &kind } else { &type_name });
        shape.callee = match kind.as_str() {
            "FunctionBlock" if !has_instance => {
                let message = format!("the box of `{type_name}` (id {}) has no instance", shape.id);
                self.sheet.report(&shape.place, Code::Unconnected, message);
                return None;
            }
            "Program" | "Action" => Callee::Instance(type_name),
            _ if has_instance => Callee::Instance(instance.to_owned()),
            _ => Callee::function(if type_name.is_empty() { &kind } else { &type_name }),
        };
        Some(shape)
    }

    fn shape<'e>(&self, tree: Object<'e>, type_name: &str) -> Shape<'e> {
        let file = self.sheet.file;
        let names = tree.object("OutputParam").map(|list| list.texts(file, "Names")).unwrap_or_default();
        let targets = outputs(tree);
        let slot = |index: usize| Slot {
            name: names.get(index).cloned().unwrap_or_default(),
            target: targets.get(index).copied().flatten(),
        };
        Shape {
            place: tree.place(),
            id: tree.id(file),
            callee: Callee::function(type_name),
            has_en: tree.is_set(file, "EN"),
            has_eno: tree.is_set(file, "ENO"),
            slots: (0..targets.len().max(names.len())).map(slot).collect(),
        }
    }

    /// What comes to EN, and to the other inputs.
    fn inputs(&mut self, tree: Object<'_>, shape: &Shape<'_>) -> (Signal, Vec<Argument>) {
        let file = self.sheet.file;
        let names = tree.object("InputParam").map(|list| list.texts(file, "Names")).unwrap_or_default();
        let negations = tree.list("InputFlags");
        let faults = self.sheet.faults.len();
        let mut enable = Signal::On;
        let mut arguments = Vec::new();
        let items = tree.list("InputItems");
        if shape.has_en && items.is_empty() {
            let message = format!("the box of `{}` (id {}) has no input EN", shape.callee.name(), shape.id);
            self.sheet.report(&shape.place, Code::MalformedXml, message);
        }
        for (index, item) in items.into_iter().enumerate() {
            let place = item.map_or_else(|| tree.place(), |item| item.place());
            let flags = negations.get(index).copied().flatten();
            let flags = flags.map_or(0, |flags| flags.word(file, "Flags").trim().parse().unwrap_or(u32::MAX));
            let is_enable = shape.has_en && index == 0;
            let signal = item.and_then(|item| self.input(item, is_enable));
            let value = match (signal, flags) {
                (Some(Signal::On), 0) if is_enable => continue,
                (Some(signal), flags) => self.modified(signal.text(&place), flags, &place),
                (None, _) => None,
            };
            match value {
                Some(value) if is_enable => enable = Signal::Value(value),
                None if is_enable && self.sheet.faults.len() > faults => {}
                None if is_enable => {
                    let message = format!("nothing is connected to EN of `{}` (id {})", shape.callee.name(), shape.id);
                    self.sheet.report(&place, Code::Unconnected, message);
                }
                value => {
                    arguments.push(Argument { name: names.get(index).cloned().unwrap_or_default(), value, place });
                }
            }
        }
        (enable, arguments)
    }

    /// The tree at an input. The rail itself comes to EN only: anywhere else it may mean that nothing is drawn.
    fn input(&mut self, item: Object<'_>, is_enable: bool) -> Option<Signal> {
        if item.kind == "BoxTreeTerminator" && !is_enable { None } else { self.tree(item) }
    }

    fn call(
        &mut self,
        shape: Shape<'_>,
        enable: Signal,
        mut arguments: Vec<Argument>,
        is_wanted: bool,
    ) -> Option<Signal> {
        let wanted = if is_wanted { Some(self.wanted(&shape)?) } else { None };
        let is_instance = matches!(shape.callee, Callee::Instance(_));
        let mut value = None;
        let mut taken = Vec::new();
        for (index, slot) in shape.slots.iter().enumerate() {
            if shape.has_eno && index == 0 {
                self.eno(slot, &enable);
                continue;
            }
            let taker = match slot.target {
                Some(target) => self.taker(target),
                None if wanted == Some(index) && !is_instance => {
                    let wire = self.sheet.wire(&shape.id, index);
                    value = Some(Text::wire(wire, &shape.place));
                    Taker::Wire(wire)
                }
                None => Taker::Nobody,
            };
            taken.push(Output { name: slot.name.clone(), taker });
        }
        if shape.slots.is_empty() && wanted.is_some() && !is_instance {
            let wire = self.sheet.wire(&shape.id, 0);
            value = Some(Text::wire(wire, &shape.place));
            taken.push(Output { name: String::new(), taker: Taker::Wire(wire) });
        }
        if is_instance {
            taken.retain(|output| !matches!(output.taker, Taker::Nobody));
        }
        let mut given_always = None;
        let signal = match wanted {
            Some(0) if shape.has_eno => Some(enable.clone()),
            Some(index) => match (&shape.callee, shape.slots.get(index)) {
                (Callee::Instance(name), Some(slot)) if is_name(&slot.name) => {
                    Some(Signal::Value(Text::word(format!("{name}.{}", slot.name), &shape.place)))
                }
                (Callee::Instance(name), _) => {
                    let message = format!("the box of `{name}` (id {}) has no name of its output", shape.id);
                    self.sheet.report(&shape.place, Code::MalformedXml, message);
                    None
                }
                (Callee::Function(name), _) => {
                    if let Signal::Value(condition) = &enable {
                        given_always = Some(condition.clone());
                        let message = format!(
                            "what `{name}` (id {}) hands on while its EN is FALSE is not documented, and is FALSE or 0 here: \
                             connect its EN to the power rail, or give its output a variable",
                            shape.id
                        );
                        self.sheet.notice(&shape.place, Code::UnsupportedFeature, message);
                    }
                    value.map(Signal::Value)
                }
            },
            None => None,
        };
        let Shape { place, id, callee, .. } = shape;
        let enable = match given_always {
            // The call itself takes EN, so that there is a value in any case.
            Some(condition) => {
                arguments.push(Argument { name: EN.to_owned(), value: Some(condition), place: place.clone() });
                Signal::On
            }
            None => enable,
        };
        self.sheet.call(Block { place, id, callee, enable, arguments, outputs: taken });
        signal
    }

    /// The slot that is wanted, if the box has such a one.
    fn wanted(&mut self, shape: &Shape<'_>) -> Option<usize> {
        let found = shape.handed_on().filter(|index| *index <= shape.result());
        let is_instance = matches!(shape.callee, Callee::Instance(_));
        let found = if is_instance { shape.handed_on() } else { found };
        if found.is_none() {
            let message = format!("the box of `{}` (id {}) has no output for this line", shape.callee.name(), shape.id);
            self.sheet.report(&shape.place, Code::DanglingConnection, message);
        }
        found
    }

    /// ENO is as EN was.
    fn eno(&mut self, slot: &Slot<'_>, enable: &Signal) {
        let Some(target) = slot.target else { return };
        if let Taker::Variable { target, storing, place } = self.taker(target) {
            self.sheet.store(target, storing, enable.clone().text(&place), &place);
        }
    }

    /// The variable at an output of a box.
    fn taker(&mut self, target: Object<'_>) -> Taker {
        let file = self.sheet.file;
        let (place, flags) = (target.place(), self.flags(target));
        let Some(written) = target.value(file, "Operand").filter(|written| is_given(&written.plain)) else {
            return Taker::Nobody;
        };
        let Some(storing) = stored(flags) else {
            let what = format!("an output (id {}) with the flags {flags}", target.id(file));
            self.sheet.unsupported(&place, &what);
            return Taker::Nobody;
        };
        match self.sheet.expression(&written) {
            Some(target) => Taker::Variable { target, storing, place },
            None => Taker::Nobody,
        }
    }

    /// The statements of a box EXECUTE.
    fn snippet(&mut self, snippet: Object<'_>, enable: Signal, place: &Range<u32>) {
        let document = snippet.object("STSnippet").and_then(|inner| inner.object("TextDocument"));
        let lines: Vec<Written> = document
            .map(|document| document.list("TextLines"))
            .unwrap_or_default()
            .into_iter()
            .flatten()
            .filter_map(|line| line.value(self.sheet.file, "Text"))
            .collect();
        if let Some(odd) = lines.iter().find(|line| line.plain.contains(['"', '\\'])) {
            return self.sheet.unsupported(&odd.place, "`\"` or `\\` in the statements of a box EXECUTE");
        }
        let is_conditional = matches!(enable, Signal::Value(_));
        if let Signal::Value(enable) = enable {
            let mut text = Text::word("IF ", place);
            text.append(enable);
            text.push(" THEN\n", place);
            self.sheet.line(text);
        }
        for line in lines {
            let mut text = line.text();
            text.push("\n", place);
            self.sheet.line(text);
        }
        if is_conditional {
            self.sheet.word_line("END_IF;\n", place);
        }
    }
}
