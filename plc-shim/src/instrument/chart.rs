//! Charts on virtual time (seed: Carlsson et al. 2012, sec. V-B): the execution signal, action control and
//! the elapsed time of steps.
//!
//! | in the chart | becomes |
//! |---|---|
//! | `STEP a: valve(D, T#5s); END_STEP` | `STEP a: SDSP_Own_valve(D, T#5s); SDSP_Control(N); END_STEP` |
//! | `:= x` of a program's transition | `:= (NOT SDSP_Simulated OR ..) AND (x)` |
//! | `a.T` | `SDSP_ELAPSED(a.X, SDSP_Step_a.since, SDSP_Step_a.held, a.T)` |
//! | `Fill.Q` of an action | `SDSP_Ctl_Fill.Q` |
//!
//! The action `SDSP_Control` of every step does what the PLC's own action control did. A function block goes
//! on when it is called, which only a program that runs does: it needs no execution signal.

use super::chart_plan::{CONTROL, Plan, Reads, controlled_by, elapsed, own_flag};
use super::edits::Edits;
use super::marks;
use super::template::ChartController;
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::Span;
use crate::syntax::ast::{Ident, Pou, PouKind, Transition, TransitionCondition};
use crate::syntax::token::Keyword;

/// What of a chart cannot be put on virtual time.
pub(super) fn findings(pou: &Pou) -> Vec<Diagnostic> {
    let reads = Reads::of(pou);
    let restarts = |transition: &&Transition| {
        let timed = |step: &&Ident| reads.times.iter().any(|(name, _)| name.key() == step.key());
        transition.from.iter().filter(timed).any(|step| transition.to.iter().any(|to| to.key() == step.key()))
    };
    let found = pou.chart.transitions.iter().filter(restarts).map(|transition| {
        let message = "a step whose time is read is entered again as it is left: its time goes on on virtual time";
        let found = Diagnostic::warning(Code::ClockNotReplaced, transition.span, message);
        found.with_help("lead by way of a step between")
    });
    found.collect()
}

/// Puts a chart in text on virtual time.
pub(super) fn control(plan: &Plan<'_>, edits: &mut Edits) {
    let mut writer = Writer { plan, edits };
    writer.declarations();
    writer.steps();
    writer.conditions();
    writer.flags();
    writer.action();
}

struct Writer<'w> {
    plan: &'w Plan<'w>,
    edits: &'w mut Edits,
}

impl Writer<'_> {
    fn line_break(&self) -> &'static str {
        marks::line_break(self.plan.file.shown_text())
    }

    fn declarations(&mut self) {
        let pou = self.plan.pou;
        let members = pou.object.members.iter().map(|member| member.pou.span.start);
        let chart = pou.chart.span().map(|span| span.start);
        let Some(first) = members.chain(chart).min() else { return };
        let at = marks::line_start(self.plan.file.shown_text(), first);
        self.edits.insert(at, marks::lines(&self.plan.declarations(), self.line_break()));
    }

    fn steps(&mut self) {
        for step in &self.plan.pou.chart.steps {
            for association in &step.associations {
                let Ident { text, span } = &association.action;
                self.edits.replace(span.start..span.end, marks::renamed(&own_flag(text), text));
            }
            let end = step.span.end.saturating_sub(Keyword::EndStep.text().len() as u32);
            self.edits.insert(end, marks::inline(&format!("{CONTROL}(N);")));
        }
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
        for step in &pou.chart.steps {
            self.times_within(step.span);
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

    /// The action that every step has.
    fn action(&mut self) {
        let mut lines = vec![format!("ACTION {CONTROL}:")];
        lines.extend(self.plan.statements());
        lines.push("END_ACTION".to_owned());
        let pou = self.plan.pou;
        let last = if pou.kind == PouKind::Program { Keyword::EndProgram } else { Keyword::EndFunctionBlock };
        let end = pou.span.end.saturating_sub(last.text().len() as u32);
        let at = marks::line_start(self.plan.file.shown_text(), end);
        self.edits.insert(at, marks::lines(&lines.join("\n"), self.line_break()));
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
