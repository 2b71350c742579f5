//! Networks in LD and FBD, which are trees of boxes, to statements.
//!
//! Networks are evaluated in their order, the trees of a network in theirs, and what a box needs before the box. What
//! stands in parallel or in series in LD is a box OR or AND in the archive.

use std::collections::BTreeMap;
use std::ops::Range;

use super::archive::Object;
use super::sheet::{Edge, Sheet, Signal, Storing, is_name};
use crate::diagnostic::Code;
use crate::input::statement::Text;

/// The bits that change a value or say what happens at a target.
pub(super) mod flag {
    pub(in super::super) const NEGATION: u32 = 1;
    pub(in super::super) const SET: u32 = 2;
    pub(in super::super) const JUMP: u32 = 4;
    pub(in super::super) const RETURN: u32 = 8;
    pub(in super::super) const RISING: u32 = 16;
    pub(in super::super) const FALLING: u32 = 32;
}

/// Appends the statements of all networks.
pub(super) fn read(sheet: &mut Sheet<'_>, body: Object<'_>) {
    let mut networks = Networks { sheet, lines: BTreeMap::new() };
    for (index, network) in body.list("NetworkList").into_iter().flatten().enumerate() {
        networks.network(index + 1, network);
    }
}

pub(super) struct Networks<'n, 's> {
    pub(super) sheet: &'n mut Sheet<'s>,
    /// Lines that branch, by their number.
    lines: BTreeMap<String, Signal>,
}

impl Networks<'_, '_> {
    fn network(&mut self, number: usize, network: Object<'_>) {
        let file = self.sheet.file;
        let place = network.place();
        let label = network.word(file, "Label");
        // Editors accept any text as the label of a network that nothing jumps to.
        if is_name(label.trim()) {
            self.sheet.word_line(&format!("{}:\n", label.trim()), &place);
        }
        if network.is_set(file, "OutCommented") {
            return;
        }
        let items = network.list("NetworkItems");
        if items.is_empty() && !network.list("ILLines").is_empty() || network.is_set(file, "ILActive") {
            self.sheet.unsupported(&place, &format!("Instruction List in network {number}"));
            return;
        }
        for item in items.into_iter().flatten() {
            self.item(item);
        }
    }

    fn item(&mut self, item: Object<'_>) {
        match item.kind {
            "BoxTreeAssign" => drop(self.assign(item, false)),
            "BoxTreeBox" => drop(self.block(item, false)),
            _ => drop(self.tree(item)),
        }
    }

    /// The value of a tree; nothing if nothing is connected, or if something is wrong with it, which has been reported.
    pub(super) fn tree(&mut self, tree: Object<'_>) -> Option<Signal> {
        match tree.kind {
            "BoxTreeOperand" => self.operand(tree),
            "BoxTreeBox" => self.block(tree, true),
            "BoxTreeAssign" => self.assign(tree, true),
            "BoxTreeDemux" => self.branch(tree),
            "BoxTreeTerminator" => Some(Signal::On),
            other => {
                let what = format!("element {} of a network (`{other}`)", tree.id(self.sheet.file));
                self.sheet.unsupported(&tree.place(), &what);
                None
            }
        }
    }

    fn operand(&mut self, tree: Object<'_>) -> Option<Signal> {
        let operand = tree.object("Operand")?;
        let written = operand.value(self.sheet.file, "Operand").filter(|written| is_given(&written.plain))?;
        let value = self.sheet.expression(&written)?;
        let flags = self.flags(operand);
        self.modified(value, flags, &operand.place()).map(Signal::Value)
    }

    /// What the flags of a value make of it.
    pub(super) fn modified(&mut self, value: Text, flags: u32, place: &Range<u32>) -> Option<Text> {
        match flags {
            0 => Some(value),
            flag::NEGATION => Some(value.negated(place)),
            flag::RISING => self.sheet.edge(Edge::Rising, value, place),
            flag::FALLING => self.sheet.edge(Edge::Falling, value, place),
            _ => {
                self.sheet.unsupported(place, &format!("a value with the flags {flags}"));
                None
            }
        }
    }

    /// The flags of an object, in itself or in its part.
    pub(super) fn flags(&self, object: Object<'_>) -> u32 {
        let file = self.sheet.file;
        let part = object.object("Flags");
        part.map_or(0, |part| part.word(file, "Flags").trim().parse().unwrap_or(u32::MAX))
    }

    /// A line that branches: it gets its value where the archive has its beginning.
    fn branch(&mut self, tree: Object<'_>) -> Option<Signal> {
        let number = tree.word(self.sheet.file, "VarId");
        let Some(input) = tree.object("Input") else {
            if let Some(found) = self.lines.get(&number) {
                return Some(found.clone());
            }
            let message = format!("there is no beginning of the line {number} before it is used");
            self.sheet.report(&tree.place(), Code::DanglingConnection, message);
            return None;
        };
        let faults = self.sheet.faults.len();
        let signal = match self.tree(input) {
            Some(Signal::On) => Signal::On,
            Some(Signal::Value(value)) => Signal::Value(self.kept(value, tree)),
            // What is wrong with it has been reported, once for all that the line leads to.
            None if self.sheet.faults.len() > faults => Signal::Value(Text::word("`none`", &tree.place())),
            None => {
                let message = format!("nothing is connected to the line {number}");
                self.sheet.report(&tree.place(), Code::Unconnected, message);
                Signal::Value(Text::word("`none`", &tree.place()))
            }
        };
        self.lines.insert(number, signal.clone());
        Some(signal)
    }

    /// A value that is used more than once is evaluated only once.
    fn kept(&mut self, value: Text, object: Object<'_>) -> Text {
        let wire = self.sheet.wire(&object.id(self.sheet.file), 0);
        self.sheet.define(wire, value);
        Text::wire(wire, &object.place())
    }

    fn assign(&mut self, assign: Object<'_>, is_wanted: bool) -> Option<Signal> {
        let (file, place) = (self.sheet.file, assign.place());
        let own = self.flags(assign);
        if own & !(flag::JUMP | flag::RETURN) != 0 {
            let what = format!("an assignment (id {}) with the flags {own}", assign.id(file));
            self.sheet.unsupported(&place, &what);
        }
        let faults = self.sheet.faults.len();
        let value = assign.object("RValue").filter(|value| value.kind != "BoxTreeTerminator");
        let Some(signal) = value.and_then(|value| self.tree(value)) else {
            if self.sheet.faults.len() == faults {
                let message = format!("nothing is connected to this assignment (id {})", assign.id(file));
                self.sheet.report(&place, Code::Unconnected, message);
            }
            return None;
        };
        let targets: Vec<Object<'_>> = outputs(assign).into_iter().flatten().collect();
        let signal = match signal {
            Signal::Value(value) if targets.len() + usize::from(is_wanted) > 1 => {
                Signal::Value(self.kept(value, assign))
            }
            signal => signal,
        };
        for target in targets {
            self.target(target, own, signal.clone());
        }
        Some(signal)
    }

    /// Gives a value to a target, which may be a jump or a return.
    fn target(&mut self, target: Object<'_>, own: u32, signal: Signal) {
        let (file, place) = (self.sheet.file, target.place());
        let flags = own | self.flags(target);
        let written = target.value(file, "Operand");
        let plain = written.as_ref().map_or("", |written| written.plain.trim());
        match flags {
            flag::RETURN => self.sheet.control("RETURN", signal, &place),
            flag::JUMP if is_name(plain) => self.sheet.control(&format!("JMP {plain}"), signal, &place),
            flag::JUMP => {
                let message = format!("`{plain}` is not the name of a label (id {})", target.id(file));
                self.sheet.report(&place, Code::MalformedXml, message);
            }
            _ if !is_given(plain) => {
                let message = format!("this assignment has no variable (id {})", target.id(file));
                self.sheet.report(&place, Code::Unconnected, message);
            }
            _ => {
                let Some(storing) = stored(flags) else {
                    let what = format!("a target (id {}) with the flags {flags}", target.id(file));
                    return self.sheet.unsupported(&place, &what);
                };
                if let Some(variable) = written.and_then(|written| self.sheet.expression(&written)) {
                    self.sheet.store(variable, storing, signal.text(&place), &place);
                }
            }
        }
    }
}

/// The places for what an assignment or a box hands on.
pub(super) fn outputs(object: Object<'_>) -> Vec<Option<Object<'_>>> {
    object.object("OutputItems").map(|list| list.list("OutputItems")).unwrap_or_default()
}

/// False for what editors write where the user has written nothing.
pub(super) fn is_given(text: &str) -> bool {
    !matches!(text.trim(), "" | "???")
}

/// What the flags of a target say: negation and set together are a reset.
pub(super) fn stored(flags: u32) -> Option<Storing> {
    const RESET: u32 = flag::NEGATION | flag::SET;
    Some(match flags {
        0 => Storing::Plain,
        flag::NEGATION => Storing::Negated,
        flag::SET => Storing::Set,
        RESET => Storing::Reset,
        _ => return None,
    })
}
