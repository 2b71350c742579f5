//! Sequential Function Charts of PLCopen XML (TC6 2.01, `SFC`) as the standard writes them in text.
//!
//! | in the file | in the text |
//! |---|---|
//! | `step`, its `actionBlock`s | STEP with associations |
//! | `macroStep` | the steps inside of it |
//! | `jumpStep`, divergences and convergences | the lists behind FROM and TO |
//! | `transition` | TRANSITION; those further to the left first |
//! | `<inline>` of an action | an ACTION named after the step |

use super::plcopen::Writer;
use super::plcopen_chart_graph::{End, Graph, Kind, NodeId};
use super::plcopen_object::inner_text;
use super::xml::Element;
use crate::diagnostic::Code;
use crate::syntax::parser::parse_expression;

/// A chart and the transitions that its unit defines beside it.
struct Chart<'e> {
    graph: Graph<'e>,
    named: Vec<&'e Element>,
}

impl<'e> Chart<'e> {
    fn named(&self, name: &str) -> Option<&'e Element> {
        let is_it =
            |element: &&Element| element.attribute("name").is_some_and(|found| found.value.eq_ignore_ascii_case(name));
        self.named.iter().copied().find(|element| is_it(element))
    }

    fn name_of(&self, id: NodeId) -> Option<&'e super::xml::Attribute> {
        self.graph.node(id)?.element.attribute("name")
    }
}

impl Writer<'_> {
    /// `<SFC>` as steps and transitions; `unit` is what holds its body.
    pub(super) fn chart(&mut self, sfc: &Element, unit: &Element) {
        let (graph, dangling) = Graph::new(sfc);
        for lost in dangling {
            let message = "this connection leads to nothing";
            self.taken.report(lost.connection.open.clone(), Code::MalformedXml, message);
        }
        let lists = unit.elements().filter(|inner| inner.name == "transitions");
        let named = lists.flat_map(Element::elements).filter(|inner| inner.name == "transition").collect();
        let chart = Chart { graph, named };
        for (id, node) in chart.graph.of(Kind::Step) {
            self.step(&chart, id, node.element);
        }
        let mut transitions: Vec<NodeId> = chart.graph.of(Kind::Transition).map(|(id, _)| id).collect();
        transitions.sort_by_key(|id| chart.graph.column(*id));
        let mut used = Vec::new();
        for id in transitions {
            self.transition(&chart, id, &mut used);
        }
    }

    fn step(&mut self, chart: &Chart<'_>, id: NodeId, element: &Element) {
        let initial = element.attribute("initialStep").is_some_and(|found| matches!(found.value.trim(), "true" | "1"));
        self.write(if initial { "INITIAL_STEP " } else { "STEP " }, &element.open);
        self.attribute(element, "name");
        self.write(":\n", &element.open);
        let mut own = Vec::new();
        for (block, node) in chart.graph.of(Kind::Actions) {
            if chart.graph.before(block).contains(&End::Step(id)) {
                self.action_block(element, node.element, &mut own);
            }
        }
        self.write("END_STEP\n", &element.close);
        for (name, inline) in own {
            self.write("ACTION ", &inline.open);
            self.write(&name, &inline.open);
            self.write(":\n", &inline.open);
            self.body(inline);
            self.write("END_ACTION\n", &inline.close);
        }
    }

    /// The associations of an action block; what stands in it goes to `own`, under a name of its own.
    fn action_block<'e>(&mut self, step: &Element, block: &'e Element, own: &mut Vec<(String, &'e Element)>) {
        if block.attribute("negated").is_some_and(|found| found.value.trim() == "true") {
            self.taken.unsupported(block.open.clone(), "a negated action block");
        }
        for action in block.elements().filter(|inner| inner.name == "action") {
            self.write("    ", &action.open);
            if let Some(reference) = action.child("reference") {
                self.attribute(reference, "name");
            } else if let Some(inline) = action.child("inline") {
                let name = step.attribute("name").map_or("", |name| name.value.as_str());
                let name = format!("{name}_inline_{}", own.len() + 1);
                self.write(&name, &inline.open);
                own.push((name, inline));
            } else {
                let message = "`<action>` has neither `<reference>` nor `<inline>`";
                self.taken.report(action.open.clone(), Code::MalformedXml, message);
                continue;
            }
            self.write("(", &action.open);
            match action.attribute("qualifier") {
                Some(qualifier) => self.write(&qualifier.value, &qualifier.span),
                None => self.write("N", &action.open),
            }
            for detail in ["duration", "indicator"] {
                if let Some(found) = action.attribute(detail).filter(|found| !found.value.trim().is_empty()) {
                    self.write(", ", &found.span);
                    self.write(&found.value, &found.span);
                }
            }
            self.write(");\n", &action.close);
        }
    }

    fn transition(&mut self, chart: &Chart<'_>, id: NodeId, used: &mut Vec<String>) {
        let Some(element) = chart.graph.node(id).map(|node| node.element) else { return };
        let (from, to) = (chart.graph.before(id), chart.graph.behind(id));
        for (ends, side) in [(&from, "before"), (&to, "behind")] {
            if ends.is_empty() || ends.iter().any(|end| matches!(end, End::Wrong(_))) {
                let message = format!("a transition has steps {side} it, and no other transition");
                return self.taken.report(element.open.clone(), Code::MalformedXml, &message);
            }
        }
        let condition = self.condition(chart, element);
        self.write("TRANSITION ", &element.open);
        let name = condition.name(element, used);
        if let Some(name) = &name {
            self.write(name, &element.open);
            self.write(" ", &element.open);
        }
        if let Some(priority) = element.attribute("priority") {
            self.write(&format!("(PRIORITY := {}) ", priority.value.trim()), &priority.span);
        }
        self.write("FROM ", &element.open);
        self.ends(chart, &from, element);
        self.write(" TO ", &element.open);
        self.ends(chart, &to, element);
        self.write_condition(&condition, name.as_deref().unwrap_or_default(), element);
        self.write("\nEND_TRANSITION\n", &element.close);
    }

    /// `a` or `(a, b)`
    fn ends(&mut self, chart: &Chart<'_>, ends: &[End], transition: &Element) {
        let several = ends.len() > 1;
        self.write(if several { "(" } else { "" }, &transition.open);
        for (index, end) in ends.iter().enumerate() {
            if index > 0 {
                self.write(", ", &transition.open);
            }
            let name = match end {
                End::Step(id) => chart.name_of(*id),
                End::Jump(id) => chart.graph.node(*id).and_then(|node| node.element.attribute("targetName")),
                End::Wrong(_) => None,
            };
            if let Some(name) = name {
                self.write(&name.value, &name.span);
            } else {
                let message = "what this transition leads to has no name";
                self.taken.report(transition.open.clone(), Code::MalformedXml, message);
            }
        }
        self.write(if several { ")" } else { "" }, &transition.open);
    }

    fn condition<'c>(&mut self, chart: &Chart<'c>, transition: &'c Element) -> Condition<'c> {
        let Some(holder) = transition.child("condition") else {
            let message = "`<transition>` has no `<condition>`";
            self.taken.report(transition.open.clone(), Code::MalformedXml, message);
            return Condition::Missing;
        };
        let negated = holder.attribute("negated").is_some_and(|found| matches!(found.value.trim(), "true" | "1"));
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
            Condition::Body { name: None, body: inline, negated }
        } else {
            self.taken.unsupported(holder.open.clone(), "a condition that a network is connected to");
            Condition::Missing
        }
    }

    fn write_condition(&mut self, condition: &Condition<'_>, name: &str, transition: &Element) {
        let open = &transition.open;
        match condition {
            // It has been told; the rest of the chart is read all the same.
            Condition::Missing => self.write(" := FALSE", open),
            Condition::Variable { name, negated } => {
                self.write(if *negated { " := NOT " } else { " := " }, open);
                self.write(&name.value, &name.span);
            }
            Condition::Body { body, negated, .. } => {
                let Some(text) = body.child("ST") else {
                    // A network assigns to the transition's name; a list of instructions leaves its result.
                    self.write(" :\n", open);
                    self.body(body);
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
                    (Form::Expression, true) => self.write(" := NOT (", open),
                    (Form::Assigned, _) => self.write(" ", open),
                    (Form::Statements, _) => self.write(" :\n", open),
                }
                if *negated {
                    let inside = inner_text(self.file, text);
                    self.write(inside.trim_end().trim_end_matches(';'), &text.open);
                    self.write(")", open);
                } else {
                    self.text_below(text);
                }
            }
        }
    }
}

/// When a transition is cleared, as the file has it.
enum Condition<'c> {
    /// A variable's name.
    Variable { name: &'c super::xml::Attribute, negated: bool },
    /// Text, perhaps that of a transition which the unit defines by name.
    Body { name: Option<String>, body: &'c Element, negated: bool },
    /// It has been told that there is none.
    Missing,
}

impl Condition<'_> {
    /// The transition's name: each is given once, and where statements need one.
    fn name(&self, transition: &Element, used: &mut Vec<String>) -> Option<String> {
        let Self::Body { name, body, .. } = self else { return None };
        let free = name.as_ref().filter(|name| !used.iter().any(|known| known.eq_ignore_ascii_case(name)));
        let name = match free {
            Some(name) => name.clone(),
            None if body.child("ST").is_some() => return None,
            None => format!("transition_{}", transition.attribute("localId").map_or("", |id| id.value.trim())),
        };
        used.push(name.clone());
        Some(name)
    }
}

/// What the text of a condition is: tools differ.
enum Form {
    /// `a AND b`
    Expression,
    /// `:= a AND b;`
    Assigned,
    /// `t := a AND b;`
    Statements,
}

impl Form {
    fn of(text: &str) -> Self {
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
