//! Blocks: calls of functions, instances and programs.
//!
//! An instance's inputs that are not connected keep their values (2nd ed. 2.5.2.1); a function's get the
//! initial values of their types if it is called with names, and must be there if it is not.

use super::builder::{Builder, Signal};
use super::element::{Input, Link, Node, Output, Storage, attribute};
use crate::check::is_standard_function;
use crate::diagnostic::Code;
use crate::input::statement::Text;
use crate::syntax::parser::parse_expression;

const EN: &str = "EN";
const ENO: &str = "ENO";

/// The output that a function's result leaves by; an additional one has the name of its variable.
fn result<'a, 'n>(node: &'a Node<'n>) -> Option<&'a Output<'n>> {
    node.outputs.iter().find(|output| !output.name.eq_ignore_ascii_case(ENO))
}

impl<'n> Builder<'_, '_, 'n> {
    /// The value at the output of a block where a connection begins.
    pub(super) fn block_output(&mut self, index: usize, link: &Link<'n>) -> Option<Text> {
        let nodes = self.nodes;
        let node = nodes.get(index)?;
        let place = link.element.open.clone();
        let in_out = node.inputs.iter().find(|input| input.in_out && input.name.eq_ignore_ascii_case(link.pin));
        if let Some(input) = in_out.filter(|_| !link.pin.is_empty()) {
            let variable = self.variable(input)?;
            return Some(Self::text_of(variable, &place));
        }
        let named = node.outputs.iter().find(|output| output.name.eq_ignore_ascii_case(link.pin));
        let first = || result(node).filter(|_| link.pin.is_empty());
        let Some(output) = named.or_else(first) else {
            let message = format!("this block has no output `{}`", link.pin);
            self.report(&place, Code::DanglingConnection, &message);
            return None;
        };
        let owner = self.owner(node);
        let value = match owner {
            // EN may be FALSE, which only ENO reports.
            Some(owner) if !output.name.eq_ignore_ascii_case(ENO) => {
                Text::word(format!("{owner}.{}", output.name), &place)
            }
            _ => Text::wire(self.wire(index, output.name), &place),
        };
        Some(if output.modifiers.negated { value.negated(&output.element.open) } else { value })
    }

    /// What keeps the outputs: an instance, or the program that is called.
    fn owner(&self, node: &Node<'n>) -> Option<String> {
        let instance = attribute(node.element, "instanceName");
        if !instance.is_empty() {
            return Some(instance.to_owned());
        }
        let name = attribute(node.element, "typeName");
        let called = self.writer.programs.contains(&name.to_ascii_uppercase());
        called.then(|| name.to_owned())
    }

    pub(super) fn block(&mut self, index: usize) {
        let nodes = self.nodes;
        let Some(node) = nodes.get(index) else { return };
        let place = node.place();
        let owner = self.owner(node);
        let callee = owner.clone().unwrap_or_else(|| attribute(node.element, "typeName").to_owned());
        if callee.is_empty() || parse_expression(&format!("{callee}(1)")).is_none() {
            let message = format!("`{callee}` is nothing that could be called");
            self.report(&place, Code::MalformedXml, &message);
            return;
        }
        for output in node.outputs.iter().filter(|output| output.modifiers.edge.is_some() || is_stored(output)) {
            let message = "an edge or storage at an output is not supported yet";
            self.report(&output.element.open.clone(), Code::UnsupportedFeature, message);
        }
        let named = owner.is_some() || has_names(node, &callee);
        let mut arguments = Vec::new();
        for input in &node.inputs {
            arguments.extend(self.argument(node, input, named));
        }
        let outputs: Vec<&Output<'n>> = node
            .outputs
            .iter()
            .filter(|output| self.is_used(index, output))
            .filter(|output| match &owner {
                Some(_) => output.name.eq_ignore_ascii_case(ENO),
                None => !result(node).is_some_and(|result| std::ptr::eq(result, *output)),
            })
            .collect();
        for output in &outputs {
            let mut text = Text::word(format!("{} => ", output.name), &output.element.open);
            text.append(Text::wire(self.wire(index, output.name), &output.element.open));
            arguments.push(text);
        }
        let call = Text::call(&callee, arguments, &place);
        if let Some(result) = result(node).filter(|result| owner.is_none() && self.is_used(index, result)) {
            let call = if outputs.is_empty() { call } else { call.that_stays() };
            return self.define(index, result.name, call.that_is_atomic(true));
        }
        let mut call = call;
        call.push(";\n", &place);
        self.line(call);
    }

    /// One argument; nothing if the input is not connected and need not be.
    fn argument(&mut self, node: &Node<'n>, input: &Input<'n>, named: bool) -> Option<Text> {
        let place = input.element.open.clone();
        let is_enable = input.name.eq_ignore_ascii_case(EN);
        let arriving = if input.in_out { self.variable(input) } else { self.arriving(input) };
        let Some(arriving) = arriving else {
            if !named && !is_enable {
                let name = if input.name.is_empty() { "an input" } else { input.name };
                let message =
                    format!("nothing is connected to {name} of this `{}`", attribute(node.element, "typeName"));
                self.report(&place, Code::Unconnected, &message);
                return Some(Text::word("`none`", &place));
            }
            return None;
        };
        if input.modifiers.storage != Storage::None {
            let message = "storage at an input of a block is not supported yet";
            self.report(&place, Code::UnsupportedFeature, message);
        }
        let value = match self.modified(arriving, input.element, input.modifiers) {
            // Execution is enabled anyway.
            Signal::On if is_enable => return None,
            signal => Self::text_of(signal, &place),
        };
        if !named && !is_enable {
            return Some(value);
        }
        let mut text = Text::word(format!("{} := ", input.name), &place);
        text.append(value);
        Some(text)
    }

    /// True if a connection begins at the output.
    fn is_used(&self, index: usize, output: &Output<'n>) -> bool {
        let Some(node) = self.nodes.get(index) else { return false };
        let links = self.nodes.iter().flat_map(|node| &node.inputs).flat_map(|input| &input.links);
        let mut mine = links.filter(|link| link.source == Some(index));
        let first = result(node).is_some_and(|result| std::ptr::eq(result, output));
        mine.any(|link| link.pin.eq_ignore_ascii_case(output.name) || link.pin.is_empty() && first)
    }
}

fn is_stored(output: &Output<'_>) -> bool {
    output.modifiers.storage != Storage::None
}

/// True if the arguments of a function are given by name: those of the standard's own are not, as tools name
/// them each in its way.
fn has_names(node: &Node<'_>, callee: &str) -> bool {
    node.inputs.iter().all(|input| !input.name.is_empty()) && !is_standard_function(&callee.to_ascii_uppercase())
}
