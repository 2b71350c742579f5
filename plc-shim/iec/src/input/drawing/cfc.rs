//! Continuous Function Charts to statements.
//!
//! Boxes, outputs, jumps and returns are evaluated in the order in which the archive has them, which is the one that
//! the user numbered them in, or in that of [`super::flow`]. An input is read where its line ends. An output of an instance is read when it is wanted:
//! before the instance is called it is the one of the cycle before.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use super::archive::Object;
use super::call::{Argument, Block, Callee, Output, Taker};
use super::cfc_element::{BoxKind, Element, Elements, Kind, Pin};
use super::flow;
use super::sheet::{Sheet, Signal, Storing, is_name};
use crate::diagnostic::Code;
use crate::input::statement::Text;

/// Appends the statements of a chart; `flow` is where it says that its user did not order it.
pub(super) fn read(sheet: &mut Sheet<'_>, chart: Object<'_>, flow: Option<&Range<u32>>) {
    let read = Elements::read(sheet.file, chart);
    let as_stored = || (0..read.elements.len()).collect();
    let order = match flow {
        None => as_stored(),
        Some(place) => flow::order(&read).unwrap_or_else(|| {
            let what = "a chart with a loop or a jump that TwinCAT orders by the flow of its data (set `Explicit \
                        Execution Order` in its properties, which stores the order)";
            sheet.unsupported(place, what);
            as_stored()
        }),
    };
    let mut owners = BTreeMap::new();
    for (index, element) in read.elements.iter().enumerate() {
        for (output, pin) in element.outputs.iter().enumerate() {
            if owners.insert(pin.id.as_str(), (index, output)).is_some() {
                let message = format!("there is a pin with the id {} already", pin.id);
                sheet.report(&pin.place, Code::DuplicateElement, message);
            }
        }
    }
    let used: BTreeSet<&str> = read.sources.values().flatten().map(String::as_str).collect();
    let mut chart =
        Chart { sheet, read: &read, owners, used, wires: BTreeMap::new(), composed: BTreeMap::new(), depth: 0 };
    for index in order {
        chart.evaluate(index, &read.elements[index]);
    }
}

struct Chart<'c, 's, 'e> {
    sheet: &'c mut Sheet<'s>,
    read: &'e Elements<'e>,
    /// By the id of a pin at which lines begin: its element, and which of its outputs it is.
    owners: BTreeMap<&'e str, (usize, usize)>,
    /// Pins at which lines begin.
    used: BTreeSet<&'e str>,
    /// The outputs that have a value already.
    wires: BTreeMap<(usize, usize), usize>,
    /// The variables that composers make their values in.
    composed: BTreeMap<usize, String>,
    /// How many composers and selectors one behind the other are being read.
    depth: usize,
}

/// Most composers and selectors one behind the other.
const MAX_DEPTH: usize = 50;

/// What a pin of a box is called in the text; one without a name is known by its number.
fn name_of(pin: &Pin, direction: &str, index: usize, count: usize) -> String {
    if pin.name.is_empty() { format!("`{direction}.{}.{count}`", index + 1) } else { pin.name.clone() }
}

impl Chart<'_, '_, '_> {
    fn evaluate(&mut self, index: usize, element: &Element<'_>) {
        for pin in element.inputs.iter().chain(&element.outputs) {
            if let Some(oddity) = pin.oddity {
                self.sheet.unsupported(&pin.place, &format!("{oddity} (element {})", element.id));
            }
        }
        match &element.kind {
            // They have no number of their own: each is evaluated where its value is wanted.
            Kind::Input | Kind::Comment | Kind::Composer { .. } | Kind::Selector => {}
            Kind::Box { .. } => self.call(index, element),
            Kind::Output => self.output(element),
            Kind::Return => self.control(element, "RETURN"),
            Kind::Jump => {
                if let Some(label) = self.label(element) {
                    self.control(element, &format!("JMP {label}"));
                }
            }
            Kind::Label => {
                if let Some(label) = self.label(element) {
                    self.sheet.word_line(&format!("{label}:\n"), &element.place);
                }
            }
            Kind::Unknown => {
                let what = format!("element {} of a chart (`{}`)", element.id, element.type_in_archive);
                self.sheet.unsupported(&element.place, &what);
            }
        }
    }

    /// What a line brings to a pin, before the pin changes it; nothing if there is no line.
    fn arriving(&mut self, pin: &Pin) -> Option<Text> {
        let source = match self.read.sources.get(&pin.id).map(Vec::as_slice) {
            None | Some([]) => return None,
            Some([source]) => source,
            Some(_) => {
                let message = format!("several lines end at the pin {}", pin.id);
                self.sheet.report(&pin.place, Code::SeveralConnections, message);
                return Some(Text::word("`none`", &pin.place));
            }
        };
        let Some(&(index, output)) = self.owners.get(source.as_str()) else {
            let message = match source.as_str() {
                "" => format!("the connection to pin {} has no source", pin.id),
                _ => format!("there is no pin {source}, which the line to the pin {} begins at", pin.id),
            };
            self.sheet.report(&pin.place, Code::DanglingConnection, message);
            return Some(Text::word("`none`", &pin.place));
        };
        // What is wrong with the source has been reported.
        Some(self.source(index, output, pin).unwrap_or_else(|| Text::word("`none`", &pin.place)))
    }

    fn source(&mut self, index: usize, output: usize, wanted: &Pin) -> Option<Text> {
        let read = self.read;
        let element = read.elements.get(index)?;
        let pin = element.outputs.get(output)?;
        let value = match &element.kind {
            Kind::Input => self.sheet.expression(element.text.as_ref()?)?,
            Kind::Box { kind: BoxKind::Instance, instance, .. } => {
                Text::word(format!("{instance}.{}", name_of(pin, "out", output, element.outputs.len())), &wanted.place)
            }
            Kind::Box { kind: BoxKind::Program, type_name, .. } => {
                Text::word(format!("{type_name}.{}", name_of(pin, "out", output, element.outputs.len())), &wanted.place)
            }
            Kind::Box { type_name, .. } => {
                let Some(wire) = self.wires.get(&(index, output)) else {
                    let message = format!(
                        "the value of `{type_name}` (element {}) is wanted before it is there: nothing keeps it from \
                         one cycle to the next; change the order, or let the line go through a variable",
                        element.id
                    );
                    self.sheet.report(&wanted.place, Code::FeedbackWithoutVariable, message);
                    return None;
                };
                Text::wire(*wire, &wanted.place)
            }
            Kind::Composer { type_name } => self.composed(index, element, type_name)?,
            Kind::Selector => self.selected(element, pin)?,
            // It has been reported, or has no output.
            _ => return None,
        };
        Some(if pin.negated { value.negated(&pin.place) } else { value })
    }

    /// False if composers and selectors lead to one another without end.
    fn may_go_deeper(&mut self, element: &Element<'_>) -> bool {
        if self.depth >= MAX_DEPTH {
            let message = format!("element {} depends on its own value", element.id);
            self.sheet.report(&element.place, Code::FeedbackWithoutVariable, message);
        }
        self.depth < MAX_DEPTH
    }

    /// A structure of what comes to the inputs of a composer; a member without a line keeps its initial value.
    fn composed(&mut self, index: usize, element: &Element<'_>, type_name: &str) -> Option<Text> {
        if !self.may_go_deeper(element) {
            return None;
        }
        let known = self.composed.get(&index).cloned();
        let name = known.or_else(|| self.sheet.remember(type_name, &element.place).filter(|_| is_name(type_name)));
        let Some(name) = name else {
            let what = format!("a composer (element {}) of `{type_name}` here", element.id);
            self.sheet.unsupported(&element.place, &what);
            return None;
        };
        self.composed.insert(index, name.clone());
        self.depth += 1;
        for pin in &element.inputs {
            if !is_name(&pin.name) {
                let message = format!("`{}` is not the name of a member (element {})", pin.name, element.id);
                self.sheet.report(&pin.place, Code::MalformedXml, message);
            } else if let Some(value) = self.value(pin) {
                let target = Text::word(format!("{name}.{}", pin.name), &pin.place);
                self.sheet.store(target, Storing::Plain, value, &pin.place);
            }
        }
        self.depth -= 1;
        Some(Text::word(name, &element.place))
    }

    /// A member of what comes to a selector.
    fn selected(&mut self, element: &Element<'_>, output: &Pin) -> Option<Text> {
        if !self.may_go_deeper(element) {
            return None;
        }
        let input = element.inputs.first()?;
        self.depth += 1;
        let value = self.value(input);
        self.depth -= 1;
        let Some(value) = value.filter(|_| is_name(&output.name) && !input.negated) else {
            let message = format!("the selector (element {}) has no structure or no name of a member", element.id);
            self.sheet.report(&element.place, Code::Unconnected, message);
            return None;
        };
        let mut text = Text::default();
        text.operand(value, &input.place);
        text.push(&format!(".{}", output.name), &output.place);
        Some(text.that_is_atomic(true))
    }

    /// The value at a pin.
    fn value(&mut self, pin: &Pin) -> Option<Text> {
        let arriving = self.arriving(pin)?;
        Some(if pin.negated { arriving.negated(&pin.place) } else { arriving })
    }

    fn output(&mut self, element: &Element<'_>) {
        let (Some(pin), Some(text)) = (element.inputs.first(), &element.text) else {
            let message = format!("the output {} has no pin or no text", element.id);
            return self.sheet.report(&element.place, Code::MalformedXml, message);
        };
        let Some(value) = self.value(pin) else {
            let message = format!("nothing is connected to the output `{}` (element {})", text.plain, element.id);
            return self.sheet.report(&text.place, Code::Unconnected, message);
        };
        if let Some(target) = self.sheet.expression(text) {
            self.sheet.store(target, pin.storing, value, &element.place);
        }
    }

    fn control(&mut self, element: &Element<'_>, statement: &str) {
        let condition = element.inputs.first().and_then(|pin| self.value(pin));
        if let Some(value) = condition {
            self.sheet.control(statement, Signal::Value(value), &element.place);
        } else {
            let message = format!("nothing is connected to element {}", element.id);
            self.sheet.report(&element.place, Code::Unconnected, message);
        }
    }

    fn label(&mut self, element: &Element<'_>) -> Option<String> {
        let name = element.text.as_ref().map_or("", |text| text.plain.trim());
        if is_name(name) {
            return Some(name.to_owned());
        }
        let message = format!("`{name}` is not the name of a label (element {})", element.id);
        self.sheet.report(&element.place, Code::MalformedXml, message);
        None
    }

    fn call(&mut self, index: usize, element: &Element<'_>) {
        let Kind::Box { kind, type_name, instance, enable, parameter } = &element.kind else { return };
        if let Some(place) = parameter {
            let what = format!("a parameter that the box of `{type_name}` (element {}) gives a value", element.id);
            self.sheet.unsupported(place, &what);
        }
        if element.outputs.iter().chain(&element.inputs).any(|pin| pin.storing != Storing::Plain) {
            let what = format!("a set or reset at a pin of `{type_name}` (element {})", element.id);
            self.sheet.unsupported(&element.place, &what);
        }
        if *enable {
            // What is connected to it is not reported again.
            self.results(index, element);
            let what = format!("EN and ENO of `{type_name}` (element {}) in a chart", element.id);
            return self.sheet.unsupported(&element.place, &what);
        }
        let is_kept = matches!(kind, BoxKind::Instance | BoxKind::Program);
        let arguments = self.arguments(element, is_kept);
        let outputs = if is_kept { Vec::new() } else { self.results(index, element) };
        let callee = match kind {
            BoxKind::Instance => Callee::Instance(instance.clone()),
            BoxKind::Program | BoxKind::Action => Callee::Instance(type_name.clone()),
            BoxKind::Function => Callee::function(type_name),
        };
        let (place, id) = (element.place.clone(), element.id.clone());
        self.sheet.call(Block { place, id, callee, enable: Signal::On, arguments, outputs });
    }

    fn arguments(&mut self, element: &Element<'_>, is_kept: bool) -> Vec<Argument> {
        let count = element.inputs.len();
        let argument = |(index, pin): (usize, &Pin)| {
            let name = if is_kept { name_of(pin, "in", index, count) } else { pin.name.clone() };
            Argument { name, value: self.value(pin), place: pin.place.clone() }
        };
        element.inputs.iter().enumerate().map(argument).collect()
    }

    /// The wires at the outputs of a function that lines begin at.
    fn results(&mut self, index: usize, element: &Element<'_>) -> Vec<Output> {
        let mut outputs = Vec::new();
        for (output, pin) in element.outputs.iter().enumerate() {
            let taker = if self.used.contains(pin.id.as_str()) {
                let wire = self.sheet.wire(&element.id, output);
                self.wires.insert((index, output), wire);
                Taker::Wire(wire)
            } else {
                Taker::Nobody
            };
            outputs.push(Output { name: pin.name.clone(), taker });
        }
        outputs
    }
}

/// The place of the setting that lets TwinCAT order a chart by the flow of its data; nothing if the user ordered it.
pub(super) fn ordered_by_data_flow(file: &str, object: &onescan_xml::Element) -> Option<Range<u32>> {
    let properties = object.child("ObjectProperties")?;
    let property = Object::first(properties, "CFCProperty")?;
    let explicit = property.value(file, "UseExplicitExecutionOrder")?;
    explicit.plain.trim().eq_ignore_ascii_case("false").then(|| property.place())
}
