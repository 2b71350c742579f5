//! Conditions of transitions in PLCopen XML (TC6 2.01, `condition`).
//!
//! | in the file | in the text |
//! |---|---|
//! | `reference` to a variable | `:= variable` |
//! | `reference` to a transition of the unit | its body, as one that is written inline |
//! | `inline` in ST | `:=` the expression, or statements that assign to the transition's name |
//! | `inline` in IL | the instructions, and `ST name` |
//! | `inline` in LD or FBD | statements; the network assigns to the transition's name |
//! | `connectionPointIn` | statements of the elements in the chart that lead there, and `name := value` |

use std::ops::Range;

use onescan_xml::{Attribute, Element, Node as Content};

use super::plcopen::Writer;
use super::plcopen_chart_graph::{Graph, Node, NodeId};
use super::plcopen_object::inner_text;
use crate::diagnostic::Code;
use crate::syntax::parser::parse_expression;

/// A chart and the transitions that its unit defines beside it.
pub(super) struct Chart<'e> {
    pub(super) graph: Graph<'e>,
    pub(super) named: Vec<&'e Element>,
}

impl<'e> Chart<'e> {
    pub(super) fn named(&self, name: &str) -> Option<&'e Element> {
        named(&self.named, name)
    }

    pub(super) fn name_of(&self, id: NodeId) -> Option<&'e Attribute> {
        self.graph.node(id)?.element.attribute("name")
    }
}

impl Writer<'_> {
    pub(super) fn condition<'c>(&mut self, chart: &Chart<'c>, node: &Node<'c>) -> Condition<'c> {
        let transition = node.element;
        let Some(holder) = transition.child("condition") else {
            let message = "`<transition>` has no `<condition>`";
            self.taken.report(transition.open.clone(), Code::MalformedXml, message);
            return Condition::Missing;
        };
        let negated = is_negated(holder);
        if let Some(reference) = holder.child("reference") {
            let Some(name) = reference.attribute("name") else {
                self.attribute(reference, "name");
                return Condition::Missing;
            };
            return match chart.named(&name.value).and_then(|named| named.child("body")) {
                Some(body) => Condition::Body { name: Some(name.value.clone()), body, negated },
                None => Condition::Variable { name, negated },
            };
        }
        if let Some(inline) = holder.child("inline") {
            return Condition::Body { name: None, body: inline, negated };
        }
        // An empty one is reported as a connection point that nothing leads to.
        Condition::Wired { chart: node.chart, holder }
    }

    pub(super) fn write_condition(&mut self, condition: &Condition<'_>, name: &str, transition: &Element) {
        let open = &transition.open;
        match condition {
            // It has been reported; the rest of the chart is read all the same.
            Condition::Missing => self.write(" := FALSE", open),
            Condition::Variable { name, negated } => {
                self.write(if *negated { " := NOT " } else { " := " }, open);
                self.write(&name.value, &name.span);
            }
            Condition::Wired { chart, holder } => {
                self.write(" :\n", open);
                self.network_value(chart, holder, name);
            }
            Condition::Body { name: own, body, negated } => {
                let Some(text) = body.child("ST") else {
                    // A network assigns to the transition's name; a list of instructions leaves its result.
                    self.write(" :\n", open);
                    self.transition = own.clone().map(|own| (own, name.to_owned()));
                    self.body(body);
                    self.transition = None;
                    match (body.child("IL").is_some(), negated) {
                        (true, false) => self.write(&format!("ST {name}\n"), open),
                        (true, true) => self.write(&format!("STN {name}\n"), open),
                        (false, true) => self.write(&format!("{name} := NOT {name};\n"), open),
                        (false, false) => {}
                    }
                    return;
                };
                match (Form::of(&inner_text(self.file, text)), negated) {
                    (Form::Expression, false) => self.write(" := ", open),
                    (Form::Assigned, false) => self.write(" ", open),
                    (Form::Expression | Form::Assigned, true) => {
                        self.write(" := NOT (", open);
                        for leaf in expression(self.file, text) {
                            self.leaf(&leaf);
                        }
                        return self.write(")", open);
                    }
                    (Form::Statements, _) => self.write(" :\n", open),
                }
                self.text_below(text);
                if *negated {
                    self.write(&format!("\n{name} := NOT {name};"), open);
                }
            }
        }
    }

    /// What the text has for the name of the transition whose body is being written: a second one with the same body
    /// has another.
    pub(super) fn transition_named(&self, name: &str) -> Option<String> {
        let (own, instead) = self.transition.as_ref()?;
        own.eq_ignore_ascii_case(name).then(|| instead.clone())
    }

    fn leaf(&mut self, leaf: &Leaf) {
        match leaf {
            Leaf::Verbatim(place) => self.taken.extract.verbatim(self.file, place.clone()),
            Leaf::Reference(character, place) => self.write(&character.to_string(), place),
        }
    }
}

/// The transitions that a unit defines beside its chart.
pub fn named_transitions(unit: &Element) -> Vec<&Element> {
    let lists = unit.elements().filter(|inner| inner.name == "transitions");
    lists.flat_map(Element::elements).filter(|inner| inner.name == "transition").collect()
}

/// The transition of a name.
pub fn named<'e>(transitions: &[&'e Element], name: &str) -> Option<&'e Element> {
    let is_it =
        |element: &&Element| element.attribute("name").is_some_and(|found| found.value.eq_ignore_ascii_case(name));
    transitions.iter().copied().find(|element| is_it(element))
}

/// If a condition is negated.
pub fn is_negated(condition: &Element) -> bool {
    condition.attribute("negated").is_some_and(|found| matches!(found.value.trim(), "true" | "1"))
}

/// A part of a text in XML.
#[derive(Debug, Clone)]
pub enum Leaf {
    /// It stands in the file as it is meant.
    Verbatim(Range<u32>),
    /// A character that is written otherwise.
    Reference(char, Range<u32>),
}

impl Leaf {
    /// Where it stands.
    pub fn place(&self) -> &Range<u32> {
        let (Self::Verbatim(place) | Self::Reference(_, place)) = self;
        place
    }
}

/// The text below an element, without blanks around it.
pub fn text_leaves(file: &str, element: &Element) -> Vec<Leaf> {
    let mut leaves = Vec::new();
    collect(element, &mut leaves);
    trim(file, &mut leaves, &[' ', '\t', '\r', '\n'], "");
    leaves
}

/// The expression that the text below an element is: without `:=` before it and `;` behind it.
pub fn expression(file: &str, element: &Element) -> Vec<Leaf> {
    let mut leaves = text_leaves(file, element);
    trim(file, &mut leaves, &[' ', '\t', '\r', '\n', ';'], ":=");
    leaves
}

fn collect(element: &Element, leaves: &mut Vec<Leaf>) {
    for node in &element.children {
        match node {
            Content::Verbatim(place) => leaves.push(Leaf::Verbatim(place.clone())),
            Content::Reference(character, place) => leaves.push(Leaf::Reference(*character, place.clone())),
            Content::Element(inner) => collect(inner, leaves),
        }
    }
}

/// Takes `prefix` and blanks off the beginning, and `blanks` off the end.
fn trim(file: &str, leaves: &mut Vec<Leaf>, blanks: &[char], prefix: &str) {
    let text = |place: &Range<u32>| file.get(place.start as usize..place.end as usize).unwrap_or("");
    while let Some(Leaf::Verbatim(place)) = leaves.last_mut() {
        place.end = place.start + text(place).trim_end_matches(blanks).len() as u32;
        if place.start < place.end {
            break;
        }
        leaves.pop();
    }
    while let Some(Leaf::Verbatim(place)) = leaves.first_mut() {
        let written = text(place).trim_start();
        let written = written.strip_prefix(prefix).unwrap_or(written).trim_start();
        place.start = place.end - written.len() as u32;
        if place.start < place.end {
            break;
        }
        leaves.remove(0);
    }
}

/// When a transition is cleared, as the file has it.
pub(super) enum Condition<'c> {
    Variable {
        name: &'c Attribute,
        negated: bool,
    },
    /// Text, perhaps that of a transition which the unit defines by name.
    Body {
        name: Option<String>,
        body: &'c Element,
        negated: bool,
    },
    /// Elements of the chart that it stands in lead to `holder`.
    Wired {
        chart: &'c Element,
        holder: &'c Element,
    },
    /// It has been reported that there is none.
    Missing,
}

impl Condition<'_> {
    /// The transition's name: each is given once, and where statements need one.
    pub(super) fn name(&self, transition: &Element, used: &mut Vec<String>) -> Option<String> {
        let is_used = |name: &str| used.iter().any(|known| known.eq_ignore_ascii_case(name));
        let own = match self {
            Self::Variable { .. } | Self::Missing => return None,
            Self::Wired { .. } => None,
            Self::Body { name, body, .. } => {
                let is_taken = name.as_ref().is_none_or(|name| is_used(name));
                if is_taken && body.child("ST").is_some() {
                    return None;
                }
                name.clone().filter(|_| !is_taken)
            }
        };
        let name = own.unwrap_or_else(|| {
            // Macro steps have numbers of their own.
            let id = transition.attribute("localId").map_or("", |id| id.value.trim());
            let name = format!("transition_{id}");
            let others = (2..).map(|number| format!("{name}_{number}"));
            std::iter::once(name.clone()).chain(others).find(|name| !is_used(name)).unwrap_or(name)
        });
        used.push(name.clone());
        Some(name)
    }
}

/// What the text of a condition is: tools differ.
pub enum Form {
    Expression,
    /// `:= a AND b;`
    Assigned,
    /// `t := a AND b;`
    Statements,
}

impl Form {
    /// How the text of a condition is written: as an assignment, an expression or statements.
    pub fn of(text: &str) -> Self {
        let text = text.trim();
        if text.starts_with(":=") {
            Self::Assigned
        } else if parse_expression(text.trim_end_matches(';')).is_some() || !text.contains(":=") {
            Self::Expression
        } else {
            Self::Statements
        }
    }
}
