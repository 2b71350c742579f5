//! Elements in the order of their evaluation, to statements: variables, contacts, coils, jumps.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use onescan_xml::{Element, Node as Content};

use super::element::{Edge, Input, Kind, Link, Modifiers, Node, Storage, attribute};
use crate::diagnostic::Code;
use crate::dialect::Dialect;
use crate::input::plcopen::Writer;
use crate::input::statement::{Line, Piece, Text};
use crate::syntax::ast::ExprKind;
use crate::syntax::parser::parse_expression;

/// What comes to an input.
pub(super) enum Signal {
    /// The left power rail.
    On,
    Value(Text),
}

/// Makes statements of one network's elements.
pub(super) struct Builder<'w, 'f, 'n> {
    pub(super) writer: &'w mut Writer<'f>,
    pub(super) nodes: &'n [Node<'n>],
    /// Distinguishes the wires of one body from those of another.
    body: u32,
    /// Several connections at one input are a wired OR.
    ladder: bool,
    lines: Vec<Line>,
    wires: BTreeMap<(usize, String), usize>,
    names: Vec<String>,
    /// Elements whose value has been taken: what is wrong with them has been reported.
    taken: BTreeSet<usize>,
    is_quiet: bool,
}

/// True for what needs no parentheses as an operand.
fn is_atomic(text: &str) -> bool {
    let atomic = |kind: &ExprKind| {
        !matches!(
            kind,
            ExprKind::Unary(..)
                | ExprKind::Binary(..)
                | ExprKind::Chain(..)
                | ExprKind::Dereference(_)
                | ExprKind::Error
        )
    };
    parse_expression(text).is_some_and(|expr| atomic(&expr.kind))
}

/// True for a constant, which has no place where it is evaluated and no type of its own.
fn is_literal(text: &str) -> bool {
    parse_expression(text).is_some_and(|expr| match expr.kind {
        ExprKind::Literal(_) => true,
        ExprKind::Unary(_, operand) => matches!(operand.kind, ExprKind::Literal(_)),
        _ => false,
    })
}

impl<'w, 'f, 'n> Builder<'w, 'f, 'n> {
    pub(super) fn new(writer: &'w mut Writer<'f>, nodes: &'n [Node<'n>], body: u32, ladder: bool) -> Self {
        let (wires, names, taken) = (BTreeMap::new(), Vec::new(), BTreeSet::new());
        Self { writer, nodes, body, ladder, lines: Vec::new(), wires, names, taken, is_quiet: false }
    }

    /// The statements, and the names of the wires in them.
    pub(super) fn finish(self) -> (Vec<Line>, Vec<String>) {
        (crate::input::statement::folded(self.lines, self.names.len()), self.names)
    }

    pub(super) fn report(&mut self, place: &Range<u32>, code: Code, message: &str) {
        if !self.is_quiet {
            self.writer.taken.report(place.clone(), code, message);
        }
    }

    /// The wire at an output of an element.
    pub(super) fn wire(&mut self, index: usize, pin: &str) -> usize {
        let key = (index, pin.to_ascii_uppercase());
        if let Some(wire) = self.wires.get(&key) {
            return *wire;
        }
        let plain = |text: &str| -> String { text.chars().filter(char::is_ascii_alphanumeric).collect() };
        let id = self.nodes.get(index).map_or_else(String::new, |node| plain(node.id));
        let pin = plain(pin);
        let dot = if pin.is_empty() { "" } else { "." };
        self.names.push(format!("`{}.{id}{dot}{pin}`", self.body));
        let wire = self.names.len() - 1;
        self.wires.insert(key, wire);
        wire
    }

    pub(super) fn define(&mut self, index: usize, pin: &str, value: Text) {
        let wire = self.wire(index, pin);
        self.lines.push(Line::Define(wire, value));
    }

    pub(super) fn line(&mut self, text: Text) {
        self.lines.push(Line::Other(text));
    }

    /// The text of an element's child `name`, trimmed, and whether it needs parentheses.
    pub(super) fn expression(&mut self, holder: &Element, name: &str) -> Option<(Text, String)> {
        let found = holder.child(name);
        let file = self.writer.file;
        let mut text = Text::default();
        let mut plain = String::new();
        for content in found.iter().flat_map(|element| &element.children) {
            match content {
                Content::Verbatim(span) => {
                    let written = file.get(span.start as usize..span.end as usize).unwrap_or("");
                    plain.push_str(written);
                    text.pieces.push(Piece::Verbatim(span.clone()));
                }
                Content::Reference(character, span) => {
                    plain.push(*character);
                    text.push(&character.to_string(), span);
                }
                Content::Element(_) => {}
            }
        }
        if plain.trim().is_empty() {
            let message = format!("`<{}>` has no `<{name}>`", holder.name);
            self.report(&holder.open, Code::MalformedXml, &message);
            return None;
        }
        let atomic = is_atomic(&plain);
        Some((text.that_is_atomic(atomic), plain))
    }

    /// A variable that a value goes to.
    fn target(&mut self, holder: &Element, name: &str) -> Option<Text> {
        let (text, plain) = self.expression(holder, name)?;
        if !is_atomic(&plain) && parse_expression(&plain).is_none() {
            let place = holder.child(name).map_or(holder.open.clone(), |inner| inner.open.clone());
            self.report(&place, Code::UnexpectedToken, &format!("`{}` is not a variable", plain.trim()));
            return None;
        }
        let place = holder.child(name).map_or_else(|| holder.open.clone(), |inner| inner.open.clone());
        Some(self.writer.transition_named(plain.trim()).map_or(text, |instead| Text::word(instead, &place)))
    }

    /// The value of an output.
    fn source(&mut self, link: &Link<'n>) -> Option<Signal> {
        let index = link.source?;
        let node = self.nodes.get(index)?;
        let place = link.element.open.clone();
        match node.kind {
            Kind::LeftRail => Some(Signal::On),
            Kind::Block => self.block_output(index, link).map(Signal::Value),
            Kind::InVariable | Kind::InOutVariable => {
                let (text, plain) = self.expression(node.element, "expression")?;
                let suffix = if node.kind == Kind::InOutVariable { "Out" } else { "" };
                let negated = Modifiers::of(node.element, suffix).negated;
                let text = if negated { text.negated(&node.place()) } else { text };
                let direct = node.kind == Kind::InOutVariable || is_literal(&plain);
                Some(Signal::Value(if direct { text } else { Text::wire(self.wire(index, ""), &place) }))
            }
            Kind::OutVariable | Kind::Label | Kind::Jump | Kind::Return | Kind::RightRail => {
                let message = format!("`<{}>` has no output", node.element.name);
                self.report(&place, Code::DanglingConnection, &message);
                None
            }
            _ => Some(Signal::Value(Text::wire(self.wire(index, ""), &place))),
        }
    }

    /// The variable that is connected to a `VAR_IN_OUT`, itself and not its value.
    pub(super) fn variable(&mut self, input: &Input<'n>) -> Option<Signal> {
        let nodes = self.nodes;
        let variable = match input.links.as_slice() {
            [link] => link.source.and_then(|source| nodes.get(source)),
            _ => None,
        };
        let variable = variable.filter(|node| matches!(node.kind, Kind::InVariable | Kind::InOutVariable));
        match variable {
            Some(node) => self.expression(node.element, "expression").map(|(text, _)| Signal::Value(text)),
            None => self.arriving(input),
        }
    }

    /// What comes to an input before its own modifiers; nothing if it is not connected.
    pub(super) fn arriving(&mut self, input: &Input<'n>) -> Option<Signal> {
        if let (false, [_, second, ..]) = (self.ladder, input.links.as_slice()) {
            let message = "only one connection ends at an input of a function block diagram";
            self.report(&second.element.open.clone(), Code::SeveralConnections, message);
        }
        let mut joined: Option<Text> = None;
        let mut on = false;
        for link in &input.links {
            match self.source(link) {
                Some(Signal::On) => on = true,
                Some(Signal::Value(value)) => {
                    joined = Some(match joined {
                        Some(before) => before.joined("OR", value, &link.element.open).that_is_atomic(false),
                        None => value,
                    });
                }
                // What is wrong with it has been reported; the wire that it stands for has no value.
                None => joined = joined.or(Some(Text::word("`none`", &link.element.open))),
            }
        }
        if on { Some(Signal::On) } else { joined.map(Signal::Value) }
    }

    /// What an input makes of what comes to it.
    pub(super) fn modified(&mut self, signal: Signal, element: &Element, modifiers: Modifiers) -> Signal {
        let place = &element.open;
        if let (Signal::On, None, false) = (&signal, modifiers.edge, modifiers.negated) {
            return signal;
        }
        let mut value = match signal {
            Signal::On => Text::word("TRUE", place),
            Signal::Value(value) => value,
        };
        if modifiers.negated {
            value = value.negated(place);
        }
        match modifiers.edge {
            Some(edge) => Signal::Value(self.edge(edge, value, element)),
            None => Signal::Value(value),
        }
    }

    /// Whether a value has an edge, which a trigger of its own remembers.
    fn edge(&mut self, edge: Edge, value: Text, element: &Element) -> Text {
        let place = &element.open;
        let Some(name) = self.writer.triggers.get(&place.start).cloned() else {
            let what = if edge == Edge::Rising { "a rising edge" } else { "a falling edge" };
            let message = format!("{what} needs memory, and a function or method keeps nothing");
            self.report(place, Code::EdgeInFunction, &message);
            return Text::word("`none`", place);
        };
        let mut call = Text::word(format!("{name}(CLK := "), place);
        call.append(value);
        call.push(");\n", place);
        self.line(call);
        Text::word(format!("{name}.Q"), place)
    }

    /// The only input of an element that needs one.
    fn wanted(&mut self, node: &Node<'n>) -> Option<Signal> {
        let input = node.inputs.first()?;
        let arriving = self.arriving(input);
        if arriving.is_none() {
            let message = format!("nothing is connected to this `<{}>`", node.element.name);
            if node.kind == Kind::OutVariable && self.writer.taken.dialect == Dialect::Matiec {
                self.writer.taken.warn(node.place(), Code::Unconnected, &format!("{message}: it does nothing"), None);
            } else {
                self.report(&node.place(), Code::Unconnected, &message);
            }
        }
        let modifiers = Modifiers { storage: Storage::None, ..input.modifiers };
        Some(self.modified(arriving?, node.element, modifiers))
    }

    pub(super) fn evaluate(&mut self, index: usize) {
        let Some(node) = self.nodes.get(index) else { return };
        let place = node.place();
        match node.kind {
            Kind::InVariable => self.in_variable(index, node),
            Kind::OutVariable => {
                if let (Some(value), Some(target)) = (self.wanted(node), self.target(node.element, "expression")) {
                    self.assign(target, value, node, node.inputs.first().map(|input| input.modifiers.storage));
                }
            }
            Kind::InOutVariable => {
                let Some(input) = node.inputs.first() else { return };
                let Some(arriving) = self.arriving(input) else { return };
                let value = self.modified(arriving, node.element, input.modifiers);
                if let Some(target) = self.target(node.element, "expression") {
                    self.assign(target, value, node, Some(input.modifiers.storage));
                }
            }
            Kind::Block => self.block(index),
            Kind::Connector | Kind::Continuation => {
                if let Some(value) = self.wanted(node) {
                    let text = Self::text_of(value, &place);
                    self.define(index, "", text);
                }
            }
            Kind::Contact => self.contact(index, node),
            Kind::Coil => self.coil(index, node),
            Kind::Jump | Kind::Return => self.control(node),
            Kind::Label => {
                if let Some(name) = self.label(node) {
                    self.line(Text::word(format!("{name}:\n"), &place));
                }
            }
            Kind::LeftRail | Kind::RightRail => {}
        }
    }

    /// Takes the value of an element for those that come next, as it is now.
    pub(super) fn take(&mut self, index: usize) {
        let Some(node) = self.nodes.get(index) else { return };
        let sees_edge = Modifiers::of(node.element, "").edge.is_some();
        if !self.taken.insert(index) {
            // An edge is seen once.
            if sees_edge && node.kind == Kind::Contact {
                return;
            }
            self.is_quiet = true;
        }
        self.wires.remove(&(index, String::new()));
        match node.kind {
            Kind::Coil => {
                if let Some(left) = node.inputs.first().and_then(|input| self.arriving(input)) {
                    self.define(index, "", Self::text_of(left, &node.place()));
                }
            }
            // It is read by its name, or has no value.
            Kind::InOutVariable | Kind::Block | Kind::OutVariable => {}
            _ => self.evaluate(index),
        }
        self.is_quiet = false;
    }

    pub(super) fn text_of(signal: Signal, place: &Range<u32>) -> Text {
        match signal {
            Signal::On => Text::word("TRUE", place),
            Signal::Value(value) => value,
        }
    }

    fn in_variable(&mut self, index: usize, node: &Node<'n>) {
        let Some((text, _)) = self.expression(node.element, "expression") else { return };
        let modifiers = Modifiers::of(node.element, "");
        let value = self.modified(Signal::Value(text), node.element, modifiers);
        let value = Self::text_of(value, &node.place());
        self.define(index, "", value);
    }

    /// 2nd ed. Table 61: the state of the left link and that of the variable.
    fn contact(&mut self, index: usize, node: &Node<'n>) {
        let place = node.place();
        let Some(input) = node.inputs.first() else { return };
        let left = self.arriving(input);
        if left.is_none() {
            self.report(&place, Code::Unconnected, "nothing is connected to the left of this contact");
        }
        let Some((variable, _)) = self.expression(node.element, "variable") else { return };
        let variable = self.modified(Signal::Value(variable), node.element, input.modifiers);
        let variable = Self::text_of(variable, &place);
        let value = match left {
            Some(Signal::Value(left)) => left.joined("AND", variable, &place),
            _ => variable,
        };
        self.define(index, "", value);
    }

    /// 2nd ed. Table 62: the state of the left link goes to the variable and to the right link.
    fn coil(&mut self, index: usize, node: &Node<'n>) {
        let place = node.place();
        let Some(input) = node.inputs.first() else { return };
        let Some(left) = self.arriving(input) else {
            self.report(&place, Code::Unconnected, "nothing is connected to the left of this coil");
            return;
        };
        let left = Self::text_of(left, &place);
        self.define(index, "", left);
        let left = Text::wire(self.wire(index, ""), &place);
        let value = self.modified(Signal::Value(left), node.element, input.modifiers);
        if let Some(target) = self.target(node.element, "variable") {
            self.assign(target, value, node, Some(input.modifiers.storage));
        }
    }

    fn assign(&mut self, target: Text, value: Signal, node: &Node<'n>, storage: Option<Storage>) {
        let place = node.place();
        let value = Self::text_of(value, &place);
        let mut text = Text::default();
        let stored = match storage {
            Some(Storage::Set) => "TRUE",
            Some(Storage::Reset) => "FALSE",
            _ => {
                text.append(target);
                text.push(" := ", &place);
                text.append(value);
                text.push(";\n", &place);
                return self.line(text);
            }
        };
        text.push("IF ", &place);
        text.append(value);
        text.push(" THEN ", &place);
        text.append(target);
        text.push(&format!(" := {stored}; END_IF;\n"), &place);
        self.line(text);
    }

    /// 2nd ed. Table 58: a jump or return is made if the state of its link is 1.
    fn control(&mut self, node: &Node<'n>) {
        let place = node.place();
        let condition = node.inputs.first().and_then(|input| {
            let arriving = self.arriving(input)?;
            Some(self.modified(arriving, node.element, input.modifiers))
        });
        let target = match node.kind {
            Kind::Return => "RETURN".to_owned(),
            _ => match self.label(node) {
                Some(name) => format!("JMP {name}"),
                None => return,
            },
        };
        let text = match condition {
            Some(Signal::Value(value)) => {
                let mut text = Text::word("IF ", &place);
                text.append(value);
                text.push(&format!(" THEN {target}; END_IF;\n"), &place);
                text
            }
            Some(Signal::On) | None => Text::word(format!("{target};\n"), &place),
        };
        self.line(text);
    }

    /// `variable := value` of what is connected to an element.
    pub(super) fn result(&mut self, node: &Node<'n>, variable: &str) {
        let place = node.place();
        let Some(value) = self.wanted(node) else { return };
        let mut text = Text::word(format!("{variable} := "), &place);
        text.append(Self::text_of(value, &place));
        text.push(";\n", &place);
        self.line(text);
    }

    fn label(&mut self, node: &Node<'n>) -> Option<String> {
        let name = attribute(node.element, "label");
        let plain = name.chars().all(|one| one.is_ascii_alphanumeric() || one == '_');
        if plain && name.starts_with(|one: char| !one.is_ascii_digit()) {
            return Some(name.to_owned());
        }
        self.report(&node.place(), Code::MalformedXml, &format!("`{name}` is not the name of a label"));
        None
    }
}
