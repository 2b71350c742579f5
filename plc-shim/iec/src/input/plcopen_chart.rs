//! Sequential Function Charts of PLCopen XML (TC6 2.01, `SFC`) as the standard writes them in text.
//!
//! | in the file | in the text |
//! |---|---|
//! | `step`, its `actionBlock`s | STEP with associations |
//! | `macroStep` | the steps inside of it |
//! | `jumpStep`, divergences and convergences | the lists behind FROM and TO |
//! | `transition` | TRANSITION; those further to the left first. See [`super::plcopen_condition`] |
//! | `<inline>` of an action | an ACTION named after the step |
//! | `SFC` as the body of an `action` | steps and transitions of that ACTION |

use onescan_xml::Element;

use super::plcopen::Writer;
use super::plcopen_chart_graph::{End, Graph, Kind, Node, NodeId};
use super::plcopen_condition::{Chart, named_transitions};
use crate::diagnostic::Code;

/// What is written in a step, under a name of its own.
type Inline<'e> = Vec<(String, &'e Element)>;

impl Writer<'_> {
    /// `<SFC>` as steps and transitions; `unit` is the `<pou>`, and `used` are names of its transitions.
    pub(super) fn chart(&mut self, sfc: &Element, unit: &Element, used: &mut Vec<String>) {
        let inline = self.chart_parts(sfc, unit, used);
        self.inline_actions(inline);
    }

    pub(super) fn inline_actions(&mut self, inline: Inline<'_>) {
        for (name, body) in inline {
            self.write("ACTION ", &body.open);
            self.write(&name, &body.open);
            self.write(":\n", &body.open);
            self.body(body);
            self.write("END_ACTION\n", &body.close);
        }
    }

    /// The same; gives back the actions that are written in its steps.
    pub(super) fn chart_parts<'e>(
        &mut self,
        sfc: &'e Element,
        unit: &'e Element,
        used: &mut Vec<String>,
    ) -> Inline<'e> {
        let (graph, dangling) = Graph::new(sfc);
        for lost in dangling {
            let message = "this connection leads to nothing";
            self.taken.report(lost.connection.open.clone(), Code::MalformedXml, message);
        }
        let chart = Chart { graph, named: named_transitions(unit) };
        let mut inline = Vec::new();
        for (id, node) in chart.graph.of(Kind::Step) {
            inline.extend(self.step(&chart, id, node.element));
        }
        let mut transitions: Vec<NodeId> = chart.graph.of(Kind::Transition).map(|(id, _)| id).collect();
        transitions.sort_by_key(|id| chart.graph.column(*id));
        for id in transitions {
            self.transition(&chart, id, used);
        }
        for (_, node) in chart.graph.of(Kind::Other) {
            self.report_stray(node);
        }
        inline
    }

    /// What stands in a chart and would do something of its own: only what a condition needs has a meaning there.
    fn report_stray(&mut self, node: &Node<'_>) {
        let name = node.element.name.as_str();
        if matches!(name, "coil" | "outVariable" | "jump" | "return" | "label") {
            self.taken.unsupported(node.element.open.clone(), &format!("`<{name}>` beside the steps of a chart"));
        }
    }

    fn step<'e>(&mut self, chart: &Chart<'e>, id: NodeId, element: &Element) -> Inline<'e> {
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
        own
    }

    /// The associations of an action block; what stands in it goes to `own`, under a name of its own.
    fn action_block<'e>(&mut self, step: &Element, block: &'e Element, own: &mut Inline<'e>) {
        if block.attribute("negated").is_some_and(|found| found.value.trim() == "true") {
            self.taken.unsupported(block.open.clone(), "a negated action block");
        }
        for action in block.elements().filter(|inner| inner.name == "action") {
            self.write("    ", &action.open);
            if let Some(reference) = action.child("reference") {
                self.attribute(reference, "name");
            } else if let Some(inline) = action.child("inline") {
                let name = step.attribute("name").map_or("", |name| name.value.as_str());
                let name = inline_action_name(name, own.len() + 1);
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
        let Some(node) = chart.graph.node(id) else { return };
        let element = node.element;
        let (from, to) = (chart.graph.before(id), chart.graph.behind(id));
        for (ends, side) in [(&from, "before"), (&to, "behind")] {
            if ends.is_empty() || ends.iter().any(|end| matches!(end, End::Wrong(_))) {
                let message = format!("a transition has steps {side} it, and no other transition");
                return self.taken.report(element.open.clone(), Code::MalformedXml, &message);
            }
        }
        let condition = self.condition(chart, node);
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
}

/// The name of an action that is written in a step.
pub fn inline_action_name(step: &str, number: usize) -> String {
    format!("{step}_inline_{number}")
}
