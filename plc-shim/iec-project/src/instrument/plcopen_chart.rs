//! Charts that are drawn, in PLCopen XML, on virtual time (`[SDSP]` sec. V-B). Nothing is
//! drawn again, nothing moves:
//!
//! | in the chart | becomes |
//! |---|---|
//! | `<reference name="valve"/>` of an action block | `<reference name="SDSP_Own_valve"/>` |
//! | `<inline>` of an action block | an action of the unit, and a reference as above |
//! | every step's action block, a new one if it has none | has one more action, `SDSP_Control`; in the chart of an action `Turn` it is `SDSP_Control_Turn` |
//! | `a.T`, `Fill.Q` in program text | as in a chart in text |
//! | conditions of a program's transitions | joined with the execution signal, see [`super::plcopen_gate`] |

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use onescan_xml::Element;

use super::chart_plan::{CONTROL, Plan, charts, controlled_by, elapsed, of_chart, own_flag};
use super::marks;
use super::plcopen;
use super::plcopen_drawing::{LocalIds, RefusedAt, position};
use super::plcopen_gate::{Closed, Gate, SIGNAL};
use super::plcopen_unit as unit;
use onescan_iec::input::plcopen_chart::inline_action_name;
use onescan_iec::input::plcopen_chart_graph::{End, Graph, Kind, number};
use onescan_iec::input::plcopen_condition::named_transitions;
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::ast::{Pou, PouKind};

/// Puts the charts in `<pou>` on virtual time. Other changes of their text have been made before.
pub(super) fn control(plan: &Plan<'_>, pou: &Element, edits: &mut Edits) -> Result<(), RefusedAt> {
    let name = plan.pou.name.span;
    let mut drawn = Vec::new();
    for chart in charts(plan.pou) {
        let sfc = drawing(chart, pou).ok_or((chart.name.span, "this chart is not drawn"))?;
        let (graph, _) = Graph::new(sfc);
        drawn.push((chart, graph));
    }
    let mut ids = LocalIds::of(pou);
    let mut writer = Writer { plan, text: plan.file.shown_text(), moved: String::new(), edits };
    let own = drawn.iter().find(|(chart, _)| std::ptr::eq(*chart, plan.pou));
    let closed = match plan.controller.as_ref().zip(own) {
        Some((controller, (_, graph))) => {
            let gate = Gate::new(plan, controller.is_open(), named_transitions(pou));
            gate.close(graph, &mut ids, writer.edits)?
        }
        None => Closed::default(),
    };
    writer.times()?;
    writer.flags();
    for (at, text) in closed.behind {
        writer.edits.insert(at, text);
    }
    for (chart, graph) in &drawn {
        writer.steps(graph, &of_chart(CONTROL, chart), &mut ids);
    }
    writer.unit(pou, closed.uses_signal).ok_or((name, "its controller has no form in PLCopen XML"))
}

/// The drawing of a unit's own chart, or of that of an action.
fn drawing<'e>(chart: &Pou, pou: &'e Element) -> Option<&'e Element> {
    let is_it = |action: &&Element| {
        action.attribute("name").is_some_and(|name| name.value.eq_ignore_ascii_case(&chart.name.text))
    };
    let holder = match chart.kind {
        PouKind::Action => pou.child("actions")?.elements().find(is_it)?,
        _ => pou,
    };
    holder.elements().filter(|inner| inner.name == "body").find_map(|body| body.child("SFC"))
}

struct Writer<'w> {
    plan: &'w Plan<'w>,
    text: &'w str,
    /// Actions that were written in steps.
    moved: String,
    edits: &'w mut Edits,
}

impl Writer<'_> {
    /// `a.T` in program text. A place that stands in the text twice is changed once.
    fn times(&mut self) -> Result<(), RefusedAt> {
        let mut seen = BTreeSet::new();
        for (step, span) in &self.plan.reads.times {
            let file = self.plan.file;
            if !file.origin().is_some_and(|origin| origin.is_verbatim(span.start)) {
                // The time of an association is read by `SDSP_Control` alone.
                let mut steps = charts(self.plan.pou).flat_map(|chart| &chart.chart.steps);
                if steps.any(|step| step.span.start <= span.start && span.end <= step.span.end) {
                    continue;
                }
                return Err((*span, "the time of a step is read in an attribute"));
            }
            let at = file.shown_range(span.start, span.end);
            if seen.insert(at.start) {
                self.edits.insert(at.start, marks::inline(&elapsed(&step.text)));
                self.edits.insert(at.end, marks::within(self.text, at.end, ")"));
            }
        }
        Ok(())
    }

    /// `Fill.Q` in program text.
    fn flags(&mut self) {
        let mut seen = BTreeSet::new();
        for name in &self.plan.reads.flags {
            let at = self.plan.file.shown_range(name.span.start, name.span.end);
            if seen.insert(at.start) {
                self.edits.replace(at, marks::renamed(&controlled_by(&name.text), &name.text));
            }
        }
    }

    /// Every step of a chart gets the action `control`.
    fn steps(&mut self, graph: &Graph<'_>, control: &str, ids: &mut LocalIds) {
        for (id, step) in graph.of(Kind::Step) {
            let is_its = |block: usize| graph.before(block).contains(&End::Step(id));
            let blocks: Vec<&Element> =
                graph.of(Kind::Actions).filter(|(block, _)| is_its(*block)).map(|(_, node)| node.element).collect();
            let mut inline = 0;
            for block in &blocks {
                self.associations(step.element, block, &mut inline);
            }
            match blocks.first() {
                Some(block) => self.add_to(block, control, ids),
                None => self.add_block(step.element, control, ids),
            }
        }
    }

    /// The PLC's own action control gets flags that nobody reads.
    fn associations(&mut self, step: &Element, block: &Element, inline: &mut usize) {
        let step = step.attribute("name").map_or("", |name| name.value.as_str());
        for action in block.elements().filter(|inner| inner.name == "action") {
            if let Some(name) = action.child("reference").and_then(|reference| reference.attribute("name")) {
                self.edits.insert(plcopen::tag_end(self.text, name.span.end), marks::renamed_before(&name.value));
                self.edits.replace(name.span.clone(), own_flag(&name.value));
            } else if let Some(body) = action.child("inline") {
                *inline += 1;
                self.move_out(body, &inline_action_name(step, *inline));
            }
        }
    }

    /// Statements in a step become an action of the unit, which `SDSP_Control` calls.
    fn move_out(&mut self, inline: &Element, name: &str) {
        let (whole, inside) =
            (inline.open.start..inline.close.end, inline.open.end..inline.close.start.max(inline.open.end));
        let part = |at: &std::ops::Range<u32>| self.text.get(at.start as usize..at.end as usize).unwrap_or("");
        let (whole_text, body) = (part(&whole), part(&inside));
        let body = self.edits.take_within(&inside).apply(body).map_or_else(|_| body.to_owned(), |edited| edited.text);
        let _ = writeln!(self.moved, "<action name=\"{name}\"><body>{}</body></action>", marks::unmarked(&body));
        plcopen::insert(self.text, whole.start, &format!("<reference name=\"{}\"/>", own_flag(name)), self.edits);
        self.edits.replace(whole, marks::cut(whole_text));
    }

    /// One more action, below the others.
    fn add_to(&mut self, block: &Element, control: &str, ids: &mut LocalIds) {
        let last = block.elements().filter(|inner| inner.name == "action").last();
        let before =
            block.elements().filter(|inner| matches!(inner.name.as_str(), "position" | "connectionPointIn")).last();
        let y = last.map_or(0, |action| position(action).1 + ROW);
        let action = association(ids.next(), y, control);
        match last.or(before) {
            Some(element) => plcopen::insert(self.text, element.close.end, &action, self.edits),
            None => plcopen::append(self.text, block, &action, self.edits),
        }
    }

    /// An action block at the right of a step that has none.
    fn add_block(&mut self, step: &Element, control: &str, ids: &mut LocalIds) {
        let (x, y) = position(step);
        let width = step.attribute("width").and_then(|width| number(&width.value)).unwrap_or(3 * ROW);
        let from = step.attribute("localId").map_or("", |id| id.value.trim());
        let block = format!(
            "<actionBlock localId=\"{}\">\n<position x=\"{}\" y=\"{y}\"/>\n\
             <connectionPointIn><connection refLocalId=\"{from}\"/></connectionPointIn>\n{}</actionBlock>\n",
            ids.next(),
            x.saturating_add(width).saturating_add(ROW),
            association(ids.next(), 0, control),
        );
        plcopen::insert(self.text, step.close.end, &block, self.edits);
        if step.child("connectionPointOutAction").is_none() {
            let points = ["position", "connectionPointIn", "connectionPointOut"];
            let last = step.elements().filter(|inner| points.contains(&inner.name.as_str())).last();
            let point = "<connectionPointOutAction formalParameter=\"\"/>\n";
            match last {
                Some(last) => plcopen::insert(self.text, last.close.end, point, self.edits),
                None => plcopen::append(self.text, step, point, self.edits),
            }
        }
    }

    /// The unit's variables and actions.
    fn unit(self, pou: &Element, has_signal: bool) -> Option<()> {
        let stay = BTreeMap::new();
        let mut declared = self.plan.declarations(&stay) + &self.plan.own_flags();
        let signal = self.plan.controller.as_ref().filter(|_| has_signal);
        if signal.is_some() {
            let _ = writeln!(declared, "VAR {SIGNAL} : BOOL; END_VAR");
        }
        plcopen::declare(pou, &unit::declarations(&declared)?, self.text, self.edits);
        let mut actions = self.moved;
        for chart in charts(self.plan.pou) {
            let mut statements = self.plan.statements(chart, &stay);
            if let Some(controller) = signal.filter(|_| std::ptr::eq(chart, self.plan.pou)) {
                statements.put(&format!("    {SIGNAL} := {};", controller.is_open()));
            }
            if statements.text.is_empty() {
                statements.put("    ;");
            }
            let body = unit::body(&statements.text);
            let _ = writeln!(actions, "<action name=\"{}\">{}</action>", of_chart(CONTROL, chart), body.trim_end());
        }
        if let Some(place) = pou.child("actions") {
            plcopen::append(self.text, place, &actions, self.edits);
        } else {
            let at = pou.child("interface").map_or(pou.open.end, |interface| interface.close.end);
            plcopen::insert(self.text, at, &format!("<actions>\n{actions}</actions>\n"), self.edits);
        }
        Some(())
    }
}

/// Height of a line of an action block.
const ROW: i64 = 20;

fn association(id: u64, y: i64, control: &str) -> String {
    format!(
        "<action localId=\"{id}\" qualifier=\"N\"><relPosition x=\"0\" y=\"{y}\"/><reference name=\"{control}\"/></action>\n"
    )
}
