//! Networks of PLCopen XML (TC6 2.01, `FBD` and `LD`; IEC 61131-3, 2nd ed. 4, 3rd ed. 8) to statements.
//!
//! | module | subject |
//! |---|---|
//! | [`element`] | elements, connection points and modifiers as the file has them |
//! | [`graph`] | which element gets its values from which; where loops begin |
//! | [`order`] | the order of evaluation |
//! | [`builder`], [`block`] | elements to statements |
//! | [`trigger`] | memory of edges |
//!
//! What an element hands on is a wire, written `` `body.id.PIN` ``; where it is used once, at once, its value
//! stands in its place. Wires are not declared: the checker gives them the types of their values.

mod block;
mod builder;
mod element;
mod graph;
mod order;
mod trigger;

use std::collections::BTreeSet;

use onescan_xml::Element;

use self::builder::Builder;
use self::element::{Input, Modifiers, Node, nodes};
use self::graph::Fault;
use self::order::{Problem, Rule, Step};
use super::plcopen::Writer;
use super::statement;
use crate::diagnostic::Code;

/// Which elements of a body are evaluated.
enum Wanted<'e> {
    All,
    /// What the connections that end at this element need; their value goes to the variable.
    For(&'e Element, &'e str),
}

impl Writer<'_> {
    /// The statements that a body in LD or FBD stands for.
    pub(super) fn network(&mut self, body: &Element) {
        self.statements_of(body, &Wanted::All);
    }

    /// The statements for what is connected to `point` in a body, then `variable := value;`: the condition
    /// of a transition whose elements stand in the chart (TC6 2.01, `condition`).
    pub(super) fn network_value(&mut self, body: &Element, point: &Element, variable: &str) {
        self.statements_of(body, &Wanted::For(point, variable));
    }

    fn statements_of<'e>(&mut self, body: &'e Element, wanted: &Wanted<'e>) {
        self.report_foreign(body, wanted);
        let mut nodes = nodes(body);
        if let Wanted::For(point, _) = wanted {
            nodes.push(Node::end(point));
        }
        let mut faults = graph::connect(&mut nodes);
        let sources = graph::sources(&nodes);
        let end = matches!(wanted, Wanted::For(..)).then(|| nodes.len().saturating_sub(1));
        let needed: Option<BTreeSet<usize>> = end.map(|end| order::finished(vec![end], &sources).into_iter().collect());
        let (mut steps, found) = ordered(&nodes, sources, end, Rule::of(self.tool, &nodes));
        faults.extend(found);
        if let Some(needed) = &needed {
            steps.retain(|step| needed.contains(&step.index()));
            faults.retain(|fault| {
                needed.iter().filter_map(|index| nodes.get(*index)).any(|node| node.holds(fault.place.start))
            });
        }
        self.report_faults(faults);
        self.bodies += 1;
        let number = self.bodies;
        let mut builder = Builder::new(self, &nodes, number, body.name != "FBD");
        for step in steps {
            match step {
                Step::Evaluate(index) => builder.evaluate(index),
                Step::Take(index) => builder.take(index),
            }
        }
        if let (Wanted::For(_, variable), Some(end)) = (wanted, nodes.last()) {
            builder.result(end, variable);
        }
        let (lines, names) = builder.finish();
        statement::write(lines, &names, self.file, &mut self.taken.extract);
    }

    fn report_faults(&mut self, faults: Vec<Fault>) {
        for fault in faults {
            if fault.code == Code::FeedbackWithoutOrder {
                self.taken.warn(
                    fault.place,
                    fault.code,
                    &fault.message,
                    Some("give each of them an `executionOrderId`"),
                );
            } else {
                self.taken.report(fault.place, fault.code, &fault.message);
            }
        }
    }

    /// What is reported of elements that are part of no network but are connected as if they were.
    fn report_foreign(&mut self, body: &Element, wanted: &Wanted<'_>) {
        if matches!(wanted, Wanted::For(..)) {
            return;
        }
        for element in body.elements().filter(|inner| matches!(inner.name.as_str(), "vendorElement" | "actionBlock")) {
            let id = element::attribute(element, "localId");
            let is_source = body.elements().any(|inner| refers_to(inner, id));
            let is_connected = element.elements().any(|inner| refers_to(inner, ""));
            if is_source || is_connected || element.name == "actionBlock" {
                self.taken.unsupported(element.open.clone(), &format!("`<{}>` in a network", element.name));
            }
        }
    }
}

/// True if a connection somewhere in the element comes from `id`; from anywhere if `id` is empty.
fn refers_to(element: &Element, id: &str) -> bool {
    let mut open = vec![element];
    while let Some(element) = open.pop() {
        if element.name == "connection" && (id.is_empty() || element::attribute(element, "refLocalId") == id) {
            return true;
        }
        open.extend(element.elements());
    }
    false
}

/// All elements, or what `end` needs, in the order of the rule; and what is wrong with their loops.
fn ordered(
    nodes: &[Node<'_>],
    mut sources: Vec<Vec<usize>>,
    end: Option<usize>,
    rule: Rule,
) -> (Vec<Step>, Vec<Fault>) {
    match rule {
        Rule::Flow(as_in_file) => {
            let networks = graph::networks(nodes, &sources);
            let ranks = order::ranks(nodes, &networks, as_in_file);
            let faults = graph::cut_loops(nodes, &mut sources, &ranks);
            (order::by_flow(nodes, &networks, &sources, &ranks, as_in_file), faults)
        }
        Rule::Beremiz => {
            let (steps, problems) = order::by_beremiz(nodes, &sources, end);
            let fault = |problem| match problem {
                Problem::Loop(index) => nodes.get(index).map(graph::keeps_nothing),
                Problem::TooLarge(index) => nodes.get(index).map(graph::too_large),
            };
            (steps, problems.into_iter().filter_map(fault).collect())
        }
    }
}

impl<'e> Node<'e> {
    /// True if the element stands around this place of the file.
    fn holds(&self, at: u32) -> bool {
        (self.element.open.start..self.element.close.end).contains(&at)
    }

    /// What a value is wanted for, as an element that comes behind all others.
    fn end(point: &'e Element) -> Self {
        let inputs = element::inputs_of(point);
        Node {
            kind: element::Kind::RightRail,
            element: point,
            id: "end",
            order: None,
            position: (i64::MAX, i64::MAX),
            inputs: vec![Input { modifiers: Modifiers::of(point, ""), ..inputs }],
            outputs: Vec::new(),
        }
    }
}
