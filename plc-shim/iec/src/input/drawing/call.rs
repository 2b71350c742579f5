//! Boxes: calls of instances, functions, operators, methods and actions.

use std::ops::Range;

use super::sheet::{Sheet, Signal, Storing, is_name};
use crate::check::is_standard_function;
use crate::diagnostic::Code;
use crate::input::statement::Text;
use crate::syntax::parser::parse_expression;

/// What a box calls.
#[derive(Debug, Clone)]
pub(super) enum Callee {
    /// What keeps its outputs: an instance of a function block, or a program.
    Instance(String),
    /// What gives a result: a function, an operator or a method.
    Function(String),
}

impl Callee {
    pub(super) fn name(&self) -> &str {
        let (Self::Instance(name) | Self::Function(name)) = self;
        name
    }

    /// A function by the sign or name that a box has.
    pub(super) fn function(name: &str) -> Self {
        let named = match name.trim() {
            "+" => "ADD",
            "-" => "SUB",
            "*" => "MUL",
            "/" => "DIV",
            "=" => "EQ",
            "<>" => "NE",
            "<" => "LT",
            "<=" => "LE",
            ">" => "GT",
            ">=" => "GE",
            other => other,
        };
        Self::Function(named.to_owned())
    }
}

/// An input of a box and what comes to it.
pub(super) struct Argument {
    pub(super) name: String,
    pub(super) value: Option<Text>,
    pub(super) place: Range<u32>,
}

/// Where an output of a box goes.
pub(super) enum Taker {
    Nobody,
    Wire(usize),
    Variable { target: Text, storing: Storing, place: Range<u32> },
}

pub(super) struct Output {
    pub(super) name: String,
    pub(super) taker: Taker,
}

/// A box, ready to be called.
pub(super) struct Block {
    pub(super) place: Range<u32>,
    pub(super) id: String,
    pub(super) callee: Callee,
    /// What comes to EN.
    pub(super) enable: Signal,
    pub(super) arguments: Vec<Argument>,
    /// The result of a function comes first; ENO is none of them.
    pub(super) outputs: Vec<Output>,
}

/// The input of every call that may forbid it (2nd ed. 2.5.1.2).
pub(super) const EN: &str = "EN";

impl Sheet<'_> {
    /// Calls a box where it is enabled, and hands on its outputs.
    pub(super) fn call(&mut self, block: Block) {
        let place = block.place.clone();
        if parse_expression(&format!("{}(1)", block.callee.name())).is_none() {
            let message = format!("`{}` is nothing that could be called", block.callee.name());
            return self.report(&place, Code::MalformedXml, message);
        }
        let Some(arguments) = self.arguments(&block) else { return };
        let is_conditional = matches!(block.enable, Signal::Value(_));
        if let Signal::Value(enable) = block.enable {
            let mut text = Text::word("IF ", &place);
            text.append(enable);
            text.push(" THEN\n", &place);
            self.line(text);
        }
        match &block.callee {
            Callee::Instance(name) => {
                let name = name.clone();
                let mut call = Text::call(&name, arguments, &place);
                call.push(";\n", &place);
                self.line(call);
                for output in block.outputs {
                    let value = Text::word(format!("{name}.{}", output.name), &place);
                    self.hand_on(output.taker, value);
                }
            }
            Callee::Function(name) => self.function(&name.clone(), arguments, block.outputs, &block.id, &place),
        }
        if is_conditional {
            self.word_line("END_IF;\n", &place);
        }
    }

    fn function(&mut self, name: &str, mut arguments: Vec<Text>, outputs: Vec<Output>, id: &str, place: &Range<u32>) {
        let mut outputs = outputs.into_iter();
        let result = outputs.next().map_or(Taker::Nobody, |output| output.taker);
        let mut behind = Vec::new();
        let mut gives_more = false;
        for (index, output) in outputs.enumerate() {
            let wire = match output.taker {
                Taker::Nobody => continue,
                Taker::Wire(wire) => wire,
                Taker::Variable { .. } => {
                    let wire = self.wire(id, index + 1);
                    behind.push((output.taker, wire));
                    wire
                }
            };
            gives_more = true;
            let mut text = Text::word(format!("{} => ", output.name), place);
            text.append(Text::wire(wire, place));
            arguments.push(text);
            if !is_pin(&output.name) {
                let message = format!("`{}` is not the name of an output of `{name}` (id {id})", output.name);
                self.report(place, Code::MalformedXml, message);
            }
        }
        let call = Text::call(name, arguments, place).that_is_atomic(true);
        match result {
            Taker::Nobody => {
                let mut call = call;
                call.push(";\n", place);
                self.line(call);
            }
            taker => self.hand_on(taker, if gives_more { call.that_stays() } else { call }),
        }
        for (taker, wire) in behind {
            self.hand_on(taker, Text::wire(wire, place));
        }
    }

    fn hand_on(&mut self, taker: Taker, value: Text) {
        match taker {
            Taker::Nobody => {}
            Taker::Wire(wire) => self.define(wire, value),
            Taker::Variable { target, storing, place } => self.store(target, storing, value, &place),
        }
    }

    /// What stands between the parentheses; nothing if something is missing, which has been reported.
    fn arguments(&mut self, block: &Block) -> Option<Vec<Text>> {
        let is_instance = matches!(block.callee, Callee::Instance(_));
        let all_named = block.arguments.iter().all(|argument| !argument.name.is_empty());
        let name = block.callee.name();
        let named = is_instance || all_named && !is_standard_function(&name.to_ascii_uppercase());
        let mut sound = true;
        let mut found = Vec::new();
        for (index, argument) in block.arguments.iter().enumerate() {
            let named = named || argument.name == EN;
            let Some(value) = argument.value.clone() else {
                if !named {
                    let message = format!("nothing is connected to input {} of `{name}` (id {})", index + 1, block.id);
                    self.report(&argument.place, Code::Unconnected, message);
                    sound = false;
                }
                continue;
            };
            let mut text = Text::default();
            if named && !is_pin(&argument.name) {
                let message = format!("`{}` is not the name of an input of `{name}` (id {})", argument.name, block.id);
                self.report(&argument.place, Code::MalformedXml, message);
                sound = false;
            }
            if named {
                text.push(&format!("{} := ", argument.name), &argument.place);
            }
            text.append(value);
            found.push(text);
        }
        sound.then_some(found)
    }
}

/// True for the name of a pin, or the number that stands for it.
fn is_pin(name: &str) -> bool {
    let number = |prefix: &str| name.strip_prefix(prefix).and_then(|rest| rest.strip_suffix('`'));
    let numbered = number("`in.").or_else(|| number("`out."));
    is_name(name) || numbered.is_some_and(|rest| rest.chars().all(|one| one.is_ascii_digit() || one == '.'))
}
