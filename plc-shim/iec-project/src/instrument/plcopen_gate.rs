//! The execution signal in conditions of charts that are drawn: a condition is TRUE only in a scan that runs for a
//! grant.
//!
//! | condition | becomes |
//! |---|---|
//! | a variable | an expression in ST |
//! | ST | joined with the signal in its text |
//! | IL | one more instruction |
//! | LD, FBD, elements of the chart | a block `AND` with `SDSP_Go` before what the result goes to |
//!
//! A network and a list of instructions are evaluated in idle scans, too: those that keep something from one
//! evaluation to the next are refused.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use onescan_xml::Element;

use super::chart_plan::Plan;
use super::marks;
use super::plcopen::{self, Refused};
use super::plcopen_drawing::{LocalIds, RefusedAt, position};
use super::plcopen_unit as unit;
use onescan_iec::input::plcopen_chart_graph::{Graph, Kind, Node, connections};
use onescan_iec::input::plcopen_condition::{Form, Leaf, expression, is_negated, named, text_leaves};
use onescan_iec::input::plcopen_object::inner_text;
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::ast::Transition;

/// The execution signal as a variable, for networks and instructions.
pub(super) const SIGNAL: &str = "SDSP_Go";

const KEEPS: Refused = "a condition that keeps something from scan to scan (an instance, an edge, a variable that is \
                        written) is not put on virtual time: evaluate it in an action";
const FORM: Refused = "a condition of this form is not put on virtual time: write it in ST";
const POLARITY: Refused = "a transition's condition is used as it is and negated: write it twice";

/// Instructions that keep something, or after which others are passed over.
const KEEPING: [&str; 12] = ["CAL", "CALC", "CALCN", "ST", "STN", "S", "R", "RET", "RETC", "RETCN", "JMP", "JMPC"];

/// Joins conditions with the execution signal.
pub(super) struct Gate<'g> {
    plan: &'g Plan<'g>,
    open: &'g str,
    named: Vec<&'g Element>,
    /// What has been joined, by where it begins, and if it is negated where it is used.
    done: BTreeMap<u32, bool>,
    uses_signal: bool,
    behind: Vec<(u32, String)>,
}

/// What is left when all conditions have been joined.
#[derive(Default)]
pub(super) struct Closed {
    /// The signal must be a variable.
    pub(super) uses_signal: bool,
    /// Text that goes behind conditions, and behind all that is changed in them.
    pub(super) behind: Vec<(u32, String)>,
}

/// Text before and behind a condition.
type Around = (String, String);

impl<'g> Gate<'g> {
    /// `open` is the signal as an expression, `named` are the transitions that the unit defines by name.
    pub(super) fn new(plan: &'g Plan<'g>, open: &'g str, named: Vec<&'g Element>) -> Self {
        Self { plan, open, named, done: BTreeMap::new(), uses_signal: false, behind: Vec::new() }
    }

    /// All transitions of a chart. What goes before a condition goes before all that is changed in it.
    pub(super) fn close(
        mut self,
        graph: &Graph<'_>,
        ids: &mut LocalIds,
        edits: &mut Edits,
    ) -> Result<Closed, RefusedAt> {
        for (_, node) in graph.of(Kind::Transition) {
            let transition = self.transition(node.element);
            let span = transition.map_or(self.plan.pou.name.span, |found| found.span);
            let name = transition.and_then(|found| found.name.as_ref()).map_or("", |name| name.text.as_str());
            self.condition(node, name, ids, edits).map_err(|message| (span, message))?;
        }
        Ok(Closed { uses_signal: self.uses_signal, behind: self.behind })
    }

    /// What a transition became in the text.
    fn transition(&self, element: &Element) -> Option<&'g Transition> {
        let begins = |transition: &Transition| {
            let start = transition.span.start;
            self.plan.file.shown_range(start, start + 1).start
        };
        self.plan.pou.chart.transitions.iter().find(|transition| begins(transition) == element.open.start)
    }

    fn condition(&mut self, node: &Node<'_>, name: &str, ids: &mut LocalIds, edits: &mut Edits) -> Result<(), Refused> {
        let Some(holder) = node.element.child("condition") else { return Ok(()) };
        let negated = is_negated(holder);
        if let Some(reference) = holder.child("reference") {
            let variable = reference.attribute("name").map_or("", |name| name.value.as_str());
            let body = named(&self.named, variable).and_then(|transition| transition.child("body"));
            if let Some(body) = body {
                return self.body(body, negated, name, ids, edits);
            }
            self.variable(reference, variable, negated, edits);
            return Ok(());
        }
        if let Some(inline) = holder.child("inline") {
            return self.body(inline, negated, name, ids, edits);
        }
        let point = holder.child("connectionPointIn").ok_or(FORM)?;
        if keeps(&leading_to(node.chart, point)) {
            return Err(KEEPS);
        }
        self.block(point, node.element, negated, ids, edits);
        Ok(())
    }

    fn text(&self) -> &'g str {
        self.plan.file.shown_text()
    }

    /// What stands around an expression.
    fn around(&self, negated: bool) -> Around {
        // A condition that is negated where it is used: `NOT (NOT go OR c)` is `go AND NOT c`.
        let before = if negated { format!("NOT {} OR (", self.open) } else { format!("{} AND (", self.open) };
        (before, ")".to_owned())
    }

    fn variable(&self, reference: &Element, name: &str, negated: bool, edits: &mut Edits) {
        let whole = reference.open.start..reference.close.end;
        let (before, behind) = self.around(negated);
        let text = unit::text(&format!("{before}{name}{behind}"));
        plcopen::insert(self.text(), whole.start, &format!("<inline name=\"\">{text}</inline>"), edits);
        let written = self.text().get(whole.start as usize..whole.end as usize).unwrap_or("");
        edits.replace(whole, marks::cut(written));
    }

    fn body(
        &mut self,
        body: &Element,
        negated: bool,
        name: &str,
        ids: &mut LocalIds,
        edits: &mut Edits,
    ) -> Result<(), Refused> {
        match self.done.insert(body.open.start, negated) {
            None => {}
            Some(before) if before == negated => return Ok(()),
            Some(_) => return Err(POLARITY),
        }
        let language = body.elements().find(|inner| matches!(inner.name.as_str(), "ST" | "IL" | "LD" | "FBD"));
        let language = language.ok_or(FORM)?;
        match language.name.as_str() {
            "ST" => self.statements(language, negated, name, edits),
            "IL" => self.instructions(language, negated),
            _ => self.network(language, negated, name, ids, edits),
        }
    }

    fn statements(&mut self, text: &Element, negated: bool, name: &str, edits: &mut Edits) -> Result<(), Refused> {
        let (leaves, (before, behind)) = match Form::of(&inner_text(self.text(), text)) {
            Form::Expression | Form::Assigned => (expression(self.text(), text), self.around(negated)),
            Form::Statements => {
                let behind = if negated { format!("ELSE {name} := TRUE; END_IF;") } else { "END_IF;".to_owned() };
                (text_leaves(self.text(), text), (format!("IF {} THEN", self.open), behind))
            }
        };
        let at = extent(&leaves).ok_or(FORM)?;
        edits.insert(at.start, marks::within(self.text(), at.start, &before));
        let has_line_comment =
            self.text().get(at.start as usize..at.end as usize).is_some_and(|text| text.contains("//"));
        let line = format!("\n{behind}");
        let behind = if has_line_comment { line } else { behind };
        self.behind.push((at.end, marks::within(self.text(), at.end, &behind)));
        Ok(())
    }

    fn instructions(&mut self, text: &Element, negated: bool) -> Result<(), Refused> {
        let leaves = text_leaves(self.text(), text);
        let at = extent(&leaves).ok_or(FORM)?;
        let written = self.text().get(at.start as usize..at.end as usize).unwrap_or("");
        let words = written.split(|one: char| !one.is_ascii_alphanumeric() && one != '_');
        if words.into_iter().any(|word| KEEPING.contains(&word.to_ascii_uppercase().as_str())) {
            return Err(KEEPS);
        }
        self.uses_signal = true;
        let operator = if negated { "ORN" } else { "AND" };
        self.behind.push((at.end, marks::lines(&format!("{operator} {SIGNAL}"), marks::line_break(self.text()))));
        Ok(())
    }

    /// A network assigns to the transition's name.
    fn network(
        &mut self,
        body: &Element,
        negated: bool,
        name: &str,
        ids: &mut LocalIds,
        edits: &mut Edits,
    ) -> Result<(), Refused> {
        let elements: Vec<&Element> = body.elements().collect();
        let controls = |element: &&Element| matches!(element.name.as_str(), "jump" | "return" | "label");
        if elements.iter().any(controls) {
            return Err(FORM);
        }
        if keeps(&elements) {
            return Err(KEEPS);
        }
        for sink in elements.iter().filter(|element| matches!(element.name.as_str(), "coil" | "outVariable")) {
            let target = sink.child("variable").or_else(|| sink.child("expression"));
            let is_it = target.is_some_and(|target| inner_text(self.text(), target).eq_ignore_ascii_case(name));
            let is_plain = sink.attribute("storage").is_none_or(|storage| storage.value == "none");
            if !is_it || !is_plain {
                return Err(KEEPS);
            }
            let point = sink.child("connectionPointIn").ok_or(FORM)?;
            self.block(point, sink, negated != is_negated(sink), ids, edits);
        }
        Ok(())
    }

    /// A block between what leads to `point` and the element that has it.
    fn block(&mut self, point: &Element, element: &Element, negated: bool, ids: &mut LocalIds, edits: &mut Edits) {
        self.uses_signal = true;
        let (signal, block) = (ids.next(), ids.next());
        let mut leading = String::new();
        for (index, connection) in point.elements().filter(|inner| inner.name == "connection").enumerate() {
            let whole = connection.open.start..connection.close.end;
            let written = self.text().get(whole.start as usize..whole.end as usize).unwrap_or("");
            leading += written;
            if index == 0 {
                let own = format!("<connection refLocalId=\"{block}\" formalParameter=\"OUT\"/>");
                plcopen::insert(self.text(), whole.start, &own, edits);
            }
            edits.replace(whole, marks::cut(written));
        }
        let (x, y) = position(element);
        let (name, modifier) = if negated { ("OR", " negated=\"true\"") } else { ("AND", "") };
        let xml = format!(
            "<inVariable localId=\"{signal}\">\n<position x=\"{}\" y=\"{}\"/>\n<connectionPointOut/>\n\
             <expression>{SIGNAL}</expression>\n</inVariable>\n\
             <block localId=\"{block}\" typeName=\"{name}\">\n<position x=\"{}\" y=\"{y}\"/>\n<inputVariables>\n\
             <variable formalParameter=\"IN1\"><connectionPointIn>{leading}</connectionPointIn></variable>\n\
             <variable formalParameter=\"IN2\"{modifier}><connectionPointIn><connection refLocalId=\"{signal}\"/>\
             </connectionPointIn></variable>\n</inputVariables>\n<inOutVariables/>\n<outputVariables>\n\
             <variable formalParameter=\"OUT\"><connectionPointOut/></variable>\n</outputVariables>\n</block>\n",
            x.saturating_sub(160).max(0),
            y.saturating_add(40),
            x.saturating_sub(80).max(0),
        );
        plcopen::insert(self.text(), element.open.start, &xml, edits);
    }
}

/// From the first to the last of them.
fn extent(leaves: &[Leaf]) -> Option<Range<u32>> {
    Some(leaves.first()?.place().start..leaves.last()?.place().end)
}

/// True if one of the elements remembers something: an instance, an edge, a variable that is written in passing.
fn keeps(elements: &[&Element]) -> bool {
    let has_edge = |element: &Element| element.attribute("edge").is_some_and(|edge| edge.value != "none");
    elements.iter().any(|element| {
        let is_instance = element.attribute("instanceName").is_some_and(|name| !name.value.is_empty());
        let inputs = element.elements().flat_map(Element::elements).any(has_edge);
        is_instance || element.name == "inOutVariable" || has_edge(element) || inputs
    })
}

/// The elements of a chart from which connections lead to `point`, those before them too.
fn leading_to<'e>(chart: &'e Element, point: &'e Element) -> Vec<&'e Element> {
    let by_id = |id: &str| {
        chart.elements().find(|inner| inner.attribute("localId").is_some_and(|found| found.value.trim() == id))
    };
    let mut found: Vec<&Element> = Vec::new();
    let mut known = BTreeSet::new();
    let mut open: Vec<&Element> = point.elements().filter(|inner| inner.name == "connection").collect();
    while let Some(connection) = open.pop() {
        let id = connection.attribute("refLocalId").map_or("", |id| id.value.trim());
        let Some(element) = by_id(id).filter(|element| known.insert(element.open.start)) else { continue };
        found.push(element);
        let pins = ["inputVariables", "inOutVariables"].iter().filter_map(|list| element.child(list));
        open.extend(pins.flat_map(Element::elements).flat_map(connections));
        open.extend(connections(element));
    }
    found
}
