//! The statements that one drawn body becomes, while they are made.

use std::ops::Range;

use super::archive::Written;
use crate::diagnostic::Code;
use crate::input::statement::{Line, Text};
use crate::syntax::ast::ExprKind;
use crate::syntax::parser::parse_expression;

/// Something that is wrong with a drawing, and where.
#[derive(Debug)]
pub(super) struct Fault {
    pub(super) place: Range<u32>,
    pub(super) code: Code,
    pub(super) message: String,
}

/// A variable that the user did not declare: it remembers an edge, or a value is composed in it.
#[derive(Debug)]
pub(super) struct Memory {
    pub(super) name: String,
    pub(super) type_name: String,
    pub(super) place: Range<u32>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Edge {
    Rising,
    Falling,
}

/// What comes along a line.
#[derive(Debug, Clone)]
pub(super) enum Signal {
    On,
    Value(Text),
}

impl Signal {
    pub(super) fn text(self, place: &Range<u32>) -> Text {
        match self {
            Self::On => Text::word("TRUE", place),
            Self::Value(text) => text,
        }
    }
}

/// What becomes of a value at its target.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Storing {
    Plain,
    Negated,
    Set,
    Reset,
}

/// How such variables are called, and those that there are.
pub(super) struct Memories {
    /// Nothing where a unit keeps nothing from one call to the next.
    pub(super) prefix: Option<String>,
    pub(super) memory: Vec<Memory>,
}

pub(super) struct Sheet<'s> {
    pub(super) file: &'s str,
    /// Distinguishes the wires of one body from those of another.
    body: usize,
    memories: &'s mut Memories,
    lines: Vec<Line>,
    names: Vec<String>,
    pub(super) faults: Vec<Fault>,
    /// What the program runs with and ought to be known.
    notices: Vec<Fault>,
}

/// The parts of a finished sheet: its statements, the names of their wires, what is wrong, and what ought to be known.
pub(super) type Finished = (Vec<Line>, Vec<String>, Vec<Fault>, Vec<Fault>);

impl<'s> Sheet<'s> {
    pub(super) fn new(file: &'s str, body: usize, memories: &'s mut Memories) -> Self {
        Self { file, body, memories, lines: Vec::new(), names: Vec::new(), faults: Vec::new(), notices: Vec::new() }
    }

    pub(super) fn finish(self) -> Finished {
        (crate::input::statement::folded(self.lines, self.names.len()), self.names, self.faults, self.notices)
    }

    pub(super) fn report(&mut self, place: &Range<u32>, code: Code, message: String) {
        self.faults.push(Fault { place: place.clone(), code, message });
    }

    pub(super) fn notice(&mut self, place: &Range<u32>, code: Code, message: String) {
        self.notices.push(Fault { place: place.clone(), code, message });
    }

    pub(super) fn unsupported(&mut self, place: &Range<u32>, what: &str) {
        self.report(place, Code::UnsupportedFeature, format!("{what} is not supported yet"));
    }

    /// A new wire, named after the element and the output that it begins at.
    pub(super) fn wire(&mut self, id: &str, output: usize) -> usize {
        let id: String = id.chars().filter(char::is_ascii_alphanumeric).collect();
        self.names.push(format!("`{}.{id}.{output}`", self.body));
        self.names.len() - 1
    }

    pub(super) fn define(&mut self, wire: usize, value: Text) {
        self.lines.push(Line::Define(wire, value));
    }

    pub(super) fn line(&mut self, text: Text) {
        self.lines.push(Line::Other(text));
    }

    pub(super) fn word_line(&mut self, words: &str, place: &Range<u32>) {
        self.line(Text::word(words, place));
    }

    /// What a user wrote at an element, if it is an expression.
    pub(super) fn expression(&mut self, written: &Written) -> Option<Text> {
        let plain = &written.plain;
        // How the archive writes these inside of its own quotes is not known: a guess may be a wrong value.
        if let Some(odd) = plain.chars().find(|one| matches!(one, '"' | '\\')) {
            let what = format!("`{odd}` in an expression of a drawing");
            self.unsupported(&written.place, &what);
            return None;
        }
        let Some(parsed) = parse_expression(plain) else {
            let message = format!("`{}` is not an expression", plain.trim());
            self.report(&written.place, Code::UnexpectedToken, message);
            return None;
        };
        let composed = matches!(
            parsed.kind,
            ExprKind::Unary(..) | ExprKind::Binary(..) | ExprKind::Chain(..) | ExprKind::Dereference(_)
        );
        Some(written.text().that_is_atomic(!composed))
    }

    /// Declares a variable of the unit; nothing if it keeps none.
    pub(super) fn remember(&mut self, type_name: &str, place: &Range<u32>) -> Option<String> {
        let name = format!("{}{}", self.memories.prefix.as_ref()?, self.memories.memory.len() + 1);
        let memory = Memory { name: name.clone(), type_name: type_name.to_owned(), place: place.clone() };
        self.memories.memory.push(memory);
        Some(name)
    }

    /// True if an edge was there since the last call.
    pub(super) fn edge(&mut self, edge: Edge, value: Text, place: &Range<u32>) -> Option<Text> {
        let (what, block) = match edge {
            Edge::Rising => ("a rising edge", "R_TRIG"),
            Edge::Falling => ("a falling edge", "F_TRIG"),
        };
        let Some(name) = self.remember(block, place) else {
            let message = format!("{what} needs memory, and a function or method keeps nothing");
            self.report(place, Code::EdgeInFunction, message);
            return None;
        };
        let mut call = Text::word(format!("{name}(CLK := "), place);
        call.append(value);
        call.push(");\n", place);
        self.line(call);
        Some(Text::word(format!("{name}.Q"), place))
    }

    /// `target := value;`, or what else the target does with it.
    pub(super) fn store(&mut self, target: Text, storing: Storing, value: Text, place: &Range<u32>) {
        let mut text = Text::default();
        let kept = match storing {
            Storing::Plain | Storing::Negated => {
                text.append(target);
                text.push(" := ", place);
                text.append(if storing == Storing::Negated { value.negated(place) } else { value });
                text.push(";\n", place);
                return self.line(text);
            }
            Storing::Set => "TRUE",
            Storing::Reset => "FALSE",
        };
        text.push("IF ", place);
        text.append(value);
        text.push(" THEN ", place);
        text.append(target);
        text.push(&format!(" := {kept}; END_IF;\n"), place);
        self.line(text);
    }

    /// A jump or RETURN where the signal is there.
    pub(super) fn control(&mut self, statement: &str, condition: Signal, place: &Range<u32>) {
        let text = match condition {
            Signal::On => Text::word(format!("{statement};\n"), place),
            Signal::Value(value) => {
                let mut text = Text::word("IF ", place);
                text.append(value);
                text.push(&format!(" THEN {statement}; END_IF;\n"), place);
                text
            }
        };
        self.line(text);
    }
}

/// True for a plain name, as those of pins and labels are.
pub(super) fn is_name(text: &str) -> bool {
    let plain = text.chars().all(|one| one.is_ascii_alphanumeric() || one == '_');
    plain && text.starts_with(|one: char| !one.is_ascii_digit())
}
