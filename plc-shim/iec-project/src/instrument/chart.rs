//! Charts on virtual time (`[SDSP]` sec. V-B): the execution signal, action control and
//! the elapsed time of steps.
//!
//! | in the chart | becomes |
//! |---|---|
//! | `STEP a: valve(D, T#5s); END_STEP` | `STEP a: (*@sdsp cut valve(D, T#5s);*) END_STEP` |
//! | `:= x` of a program's transition | `:= (NOT SDSP_Simulated OR ..) AND (x)` |
//! | `a.T` | `SDSP_ELAPSED(SDSP_Simulated, SDSP_Now, a.X, ..SDSP_Since, ..SDSP_Held, a.T)` |
//! | `Fill.Q` of an action | `SDSP_Ctl_Fill.Q` |
//! | `ACTION Fill: .. END_ACTION` | statements in `ACTION SDSP_Control` |
//!
//! One more network is a step alone, which is always active; its action `SDSP_Control` does what the PLC's own
//! action control did, and runs what that ran, in the order of the soft PLC. All of it is text of the standard. CODESYS
//! draws a chart as one network: there every step has that action.
//! A chart that is the body of an action has such a step and such an action of its own; the action itself stays and is
//! called. An action that the user calls by its name, or whose statements cannot be moved, stays and is called. A function
//! block goes on when it is called, which only a program that runs does: it needs no execution signal.

use std::collections::BTreeMap;

use super::chart_action::{self, Moved, Text};
use super::chart_plan::{CONTROL, Plan, charts, controlled_by, elapsed, of_chart};
use super::chart_script::Script;
use super::marks;
use super::survey::Survey;
use super::target::Target;
use super::template::ChartController;
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::Span;
use onescan_iec::syntax::ast::{Ident, Pou, PouKind, Transition, TransitionCondition};
use onescan_iec::syntax::token::{Keyword, Punctuation};

/// Puts a chart in text on virtual time. Other changes of its text have been made before.
pub(super) fn control(plan: &Plan<'_>, survey: &Survey<'_>, edits: &mut Edits) {
    let text = plan.file.shown_text();
    let mut writer = Writer { plan, text: Text::new(text), line_break: marks::line_break(text), edits };
    writer.conditions();
    writer.flags();
    writer.steps();
    let moved = writer.actions(survey);
    writer.declarations(&moved);
    for chart in charts(plan.pou) {
        writer.always(chart, &moved, survey.target);
    }
}

struct Writer<'w> {
    plan: &'w Plan<'w>,
    text: Text<'w>,
    line_break: &'static str,
    edits: &'w mut Edits,
}

impl<'w> Writer<'w> {
    fn line_start(&self, at: u32) -> u32 {
        marks::line_start(self.plan.file.shown_text(), at)
    }

    fn declarations(&mut self, moved: &BTreeMap<String, Moved>) {
        let pou = self.plan.pou;
        let members = pou.object.members.iter().map(|member| member.pou.span.start);
        let chart = pou.chart.span().map(|span| span.start);
        let Some(first) = members.chain(chart).min() else { return };
        self.edits.insert(self.line_start(first), marks::lines(&self.plan.declarations(moved), self.line_break));
    }

    /// The PLC's own action control has nothing to do.
    fn steps(&mut self) {
        let steps = charts(self.plan.pou).flat_map(|chart| &chart.chart.steps);
        for association in steps.flat_map(|step| &step.associations) {
            let span = association.span;
            let whole = span.start..self.text.behind(span.end, Punctuation::Semicolon);
            // The action's control reads its time.
            self.edits.take_within(&whole);
            self.edits.replace(whole.clone(), marks::cut_text(self.text.part(&whole)));
        }
    }

    /// Actions that the chart runs, by their keys.
    fn actions(&mut self, survey: &Survey<'_>) -> BTreeMap<String, Moved> {
        let pou = self.plan.pou;
        let can_move = |name: &Ident| self.plan.controls(name) && !survey.calls(pou, name);
        let members = pou.object.members.iter();
        let movable = members.filter(|member| chart_action::is_movable(member) && can_move(&member.pou.name));
        movable.map(|member| (member.pou.name.key(), self.text.take_out(member, self.edits))).collect()
    }

    fn conditions(&mut self) {
        let controller = self.plan.controller.as_ref();
        let pou = self.plan.pou;
        for transition in &pou.chart.transitions {
            let gated = controller.and_then(|found| gate_of(found, transition));
            if let Some((at, text, _, _)) = &gated {
                self.edits.insert(*at, marks::inline(text));
            }
            self.times_within(transition.span);
            if let Some((_, _, at, text)) = &gated {
                self.edits.insert(*at, marks::inline(text));
            }
        }
        for member in &pou.object.members {
            self.times_within(member.pou.span);
        }
    }

    fn times_within(&mut self, place: Span) {
        for (step, span) in &self.plan.reads.times {
            if (place.start..place.end).contains(&span.start) {
                self.edits.insert(span.start, marks::inline(&elapsed(&step.text)));
                self.edits.insert(span.end, marks::inline(")"));
            }
        }
    }

    fn flags(&mut self) {
        for Ident { text, span } in &self.plan.reads.flags {
            self.edits.replace(span.start..span.end, marks::renamed(&controlled_by(text), text));
        }
    }

    /// The action of a chart that is always active, and its step.
    fn always(&mut self, chart: &'w Pou, moved: &BTreeMap<String, Moved>, target: Target) {
        let statements = self.plan.statements(chart, moved);
        if statements.text.is_empty() {
            return;
        }
        let control = of_chart(CONTROL, chart);
        let step = format!("INITIAL_STEP {}: {control}(N); END_STEP", of_chart("SDSP_Always", chart));
        let mut script = Script::default();
        if target == Target::Codesys {
            for step in &chart.chart.steps {
                let end = step.span.end.saturating_sub(Keyword::EndStep.text().len() as u32);
                self.edits.insert(end, marks::inline(&format!("{control}(N);")));
            }
        } else if chart.kind == PouKind::Action {
            let at = self.line_start(chart.span.end.saturating_sub(Keyword::EndAction.text().len() as u32));
            self.edits.insert(at, marks::lines(&step, self.line_break));
        } else {
            script.put(&step);
        }
        script.put(&format!("ACTION {control}:"));
        script.join(statements);
        script.put("END_ACTION");
        // A line with a mark is above them.
        let origins = [None].into_iter().chain(script.origins).collect();
        self.edits.insert_moved(self.place(), marks::lines(&script.text, self.line_break), origins);
    }

    /// Where actions go: behind a chart, before statements.
    fn place(&self) -> u32 {
        let pou = self.plan.pou;
        let first = pou.object.members.iter().map(|member| member.pou.span.start).min();
        let last = if pou.kind == PouKind::Program { Keyword::EndProgram } else { Keyword::EndFunctionBlock };
        let end = pou.span.end.saturating_sub(last.text().len() as u32);
        self.line_start(first.filter(|_| pou.chart.is_empty()).unwrap_or(end))
    }
}

/// Where a transition's gate begins and ends, and the text of each.
fn gate_of(controller: &ChartController, transition: &Transition) -> Option<(u32, String, u32, String)> {
    match &transition.condition {
        TransitionCondition::Expression(condition) => {
            Some((condition.span.start, format!("{} (", controller.gate), condition.span.end, ")".to_owned()))
        }
        TransitionCondition::Network(network) => {
            let first = network.first()?;
            let end = transition.span.end.saturating_sub(Keyword::EndTransition.text().len() as u32);
            Some((first.span.start, format!("IF {} THEN", controller.is_open()), end, "END_IF;".to_owned()))
        }
    }
}
