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

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use super::clock::Form;
use super::edits::Edits;
use super::marks;
use super::template::{self, ChartController, Number};
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::SourceFile;
use crate::syntax::Span;
use crate::syntax::ast::{
    ActionQualifier, Association, ChartStep, Expr, ExprKind, Ident, MemberKind, Pou, Transition, TransitionCondition,
};
use crate::syntax::token::Keyword;
use crate::syntax::walk::{self, Visitor};

/// What in a chart reads its parts: `a.T` of steps, `Fill.Q` of actions.
#[derive(Default)]
struct Reads {
    /// Keys of steps.
    steps: BTreeSet<String>,
    /// Keys of actions with statements.
    actions: BTreeSet<String>,
    times: Vec<(Ident, Span)>,
    flags: Vec<Ident>,
}

impl Visitor for Reads {
    fn expression(&mut self, expr: &Expr) {
        let ExprKind::Member(inner, member) = &expr.kind else { return };
        let ExprKind::Name(name) = &inner.kind else { return };
        if member.key() == "T" && self.steps.contains(&name.key()) {
            self.times.push((name.clone(), expr.span));
        } else if matches!(member.key().as_str(), "Q" | "A") && self.actions.contains(&name.key()) {
            self.flags.push(name.clone());
        }
    }
}

impl Reads {
    fn of(pou: &Pou) -> Self {
        let members = pou.object.members.iter().filter(|member| member.kind == MemberKind::Action);
        let mut reads = Self {
            steps: pou.chart.steps.iter().map(|step| step.name.key()).collect(),
            actions: members.map(|member| member.pou.name.key()).collect(),
            ..Self::default()
        };
        walk::unit(pou, &mut reads);
        for member in &pou.object.members {
            walk::unit(&member.pou, &mut reads);
        }
        reads
    }
}

fn elapsed(step: &str) -> String {
    format!("SDSP_ELAPSED({step}.X, SDSP_Step_{step}.since, SDSP_Step_{step}.held, ")
}

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

/// Puts the chart of `pou` on virtual time; of a program that is scheduled, `number` is its number, with the type of the line of programs.
pub(super) fn control(
    pou: &Pou,
    number: Option<(Number, &str)>,
    renames: &[(Ident, &'static Form)],
    file: &SourceFile,
    edits: &mut Edits,
) {
    let controller = number.map(|(number, line)| template::chart_controller(number, line));
    let mut writer = Writer { pou, controller, reads: Reads::of(pou), renames, file, edits };
    writer.declarations();
    writer.steps();
    writer.conditions();
    writer.flags();
    writer.action();
}

struct Writer<'w> {
    pou: &'w Pou,
    controller: Option<ChartController>,
    reads: Reads,
    renames: &'w [(Ident, &'static Form)],
    file: &'w SourceFile,
    edits: &'w mut Edits,
}

/// An action and where it is used.
type Uses<'w> = Vec<(&'w Ident, Vec<(&'w ChartStep, &'w Association)>)>;

impl<'w> Writer<'w> {
    fn line_break(&self) -> &'static str {
        marks::line_break(self.file.shown_text())
    }

    /// The actions in the order in which the steps name them first.
    fn uses(&self) -> Uses<'w> {
        let mut uses: Uses<'w> = Vec::new();
        for step in &self.pou.chart.steps {
            for association in &step.associations {
                let key = association.action.key();
                match uses.iter_mut().find(|(name, _)| name.key() == key) {
                    Some((_, found)) => found.push((step, association)),
                    None => uses.push((&association.action, vec![(step, association)])),
                }
            }
        }
        uses
    }

    /// The steps whose time is read, by their keys.
    fn timed_steps(&self) -> BTreeMap<String, &'w ChartStep> {
        let read = |step: &&ChartStep| self.reads.times.iter().any(|(name, _)| name.key() == step.name.key());
        self.pou.chart.steps.iter().filter(read).map(|step| (step.name.key(), step)).collect()
    }

    fn declarations(&mut self) {
        let members = self.pou.object.members.iter().map(|member| member.pou.span.start);
        let chart = self.pou.chart.span().map(|span| span.start);
        let Some(first) = members.chain(chart).min() else { return };
        let mut text = self.controller.as_ref().map_or(String::new(), |found| format!("{}\n", found.declarations));
        text.push_str("VAR\n");
        for step in self.timed_steps().values() {
            let _ = writeln!(text, "    SDSP_Step_{} : SDSP_SFC_STEP;", step.name.text);
        }
        for (action, _) in self.uses() {
            let _ = writeln!(text, "    SDSP_Ctl_{} : SDSP_ACTION_CONTROL;", action.text);
            let _ = writeln!(
                text,
                "    SDSP_Own_{} : BOOL; (* what the PLC's own action control makes of it *)",
                action.text
            );
        }
        text.push_str("END_VAR\n");
        let at = marks::line_start(self.file.shown_text(), first);
        self.edits.insert(at, marks::lines(&text, self.line_break()));
    }

    fn steps(&mut self) {
        for step in &self.pou.chart.steps {
            for association in &step.associations {
                let Ident { text, span } = &association.action;
                self.edits.replace(span.start..span.end, marks::renamed(&format!("SDSP_Own_{text}"), text));
            }
            let end = step.span.end.saturating_sub(Keyword::EndStep.text().len() as u32);
            self.edits.insert(end, marks::inline("SDSP_Control(N);"));
        }
    }

    fn conditions(&mut self) {
        let gate = self.controller.as_ref().map(|found| found.gate.clone());
        for transition in &self.pou.chart.transitions {
            let gated = gate.as_ref().and_then(|gate| gate_of(gate, transition));
            if let Some((at, text, _, _)) = &gated {
                self.edits.insert(*at, marks::inline(text));
            }
            self.times_within(transition.span);
            if let Some((_, _, at, text)) = &gated {
                self.edits.insert(*at, marks::inline(text));
            }
        }
        for step in &self.pou.chart.steps {
            self.times_within(step.span);
        }
        for member in &self.pou.object.members {
            self.times_within(member.pou.span);
        }
    }

    fn times_within(&mut self, place: Span) {
        for (step, span) in &self.reads.times {
            if (place.start..place.end).contains(&span.start) {
                self.edits.insert(span.start, marks::inline(&elapsed(&step.text)));
                self.edits.insert(span.end, marks::inline(")"));
            }
        }
    }

    fn flags(&mut self) {
        for Ident { text, span } in &self.reads.flags {
            self.edits.replace(span.start..span.end, marks::renamed(&format!("SDSP_Ctl_{text}"), text));
        }
    }

    /// The action that every step has.
    fn action(&mut self) {
        let mut lines = vec!["ACTION SDSP_Control:".to_owned()];
        lines.extend(self.controller.as_ref().map(|found| found.header.clone()));
        for step in self.timed_steps().values() {
            lines.push(format!("    SDSP_Step_{0}(X := {0}.X);", step.name.text));
        }
        let uses = self.uses();
        for (action, found) in &uses {
            lines.extend(self.controlled(&action.text, found));
            if !self.reads.actions.contains(&action.key()) {
                lines.push(format!("    {0} := SDSP_Ctl_{0}.Q;", action.text));
            }
        }
        let bodies = || uses.iter().filter(|(action, _)| self.reads.actions.contains(&action.key()));
        for (action, _) in bodies() {
            lines.push(format!("    IF SDSP_Ctl_{0}.A AND NOT SDSP_Ctl_{0}.Q THEN {0}(); END_IF;", action.text));
        }
        for (action, _) in bodies() {
            lines.push(format!("    IF SDSP_Ctl_{0}.Q THEN {0}(); END_IF;", action.text));
        }
        match &self.controller {
            Some(found) => lines.extend([found.close.clone(), found.footer.clone()]),
            None => lines.push("    ;".to_owned()),
        }
        lines.push("END_ACTION".to_owned());
        let last = if self.pou.kind == crate::syntax::ast::PouKind::Program {
            Keyword::EndProgram
        } else {
            Keyword::EndFunctionBlock
        };
        let end = self.pou.span.end.saturating_sub(last.text().len() as u32);
        let at = marks::line_start(self.file.shown_text(), end);
        self.edits.insert(at, marks::lines(&lines.join("\n"), self.line_break()));
    }

    /// The call of an action's control.
    fn controlled(&self, action: &str, uses: &[(&ChartStep, &Association)]) -> Vec<String> {
        let mut lines = Vec::new();
        for (step, association) in uses {
            if let Some(time) = &association.time {
                let value = self.rewritten(time.span);
                lines.push(format!("    IF {}.X THEN SDSP_Ctl_{action}.T := {value}; END_IF;", step.name.text));
            }
        }
        let input = |qualifier: ActionQualifier| {
            let by = uses.iter().filter(|(_, association)| association.effective_qualifier() == qualifier);
            let flags: Vec<_> = by.map(|(step, _)| format!("{}.X", step.name.text)).collect();
            (!flags.is_empty()).then(|| format!("{} := {}", qualifier.text(), flags.join(" OR ")))
        };
        let inputs: Vec<_> = ActionQualifier::ALL.into_iter().filter_map(input).collect();
        lines.push(format!("    SDSP_Ctl_{action}({});", inputs.join(", ")));
        lines
    }

    /// Text of the file with what reads the clock replaced.
    fn rewritten(&self, span: Span) -> String {
        let text = self.file.text().get(span.start as usize..span.end as usize).unwrap_or("");
        let inside = |at: Span| span.start <= at.start && at.end <= span.end;
        let mut edits = Edits::default();
        for (step, at) in self.reads.times.iter().filter(|(_, at)| inside(*at)) {
            edits.insert(at.start - span.start, elapsed(&step.text));
            edits.insert(at.end - span.start, ")");
        }
        for (name, form) in self.renames.iter().filter(|(name, _)| inside(name.span)) {
            edits.replace(name.span.start - span.start..name.span.end - span.start, form.new_name());
        }
        edits.apply(text).map_or_else(|_| text.to_owned(), |edited| edited.text)
    }
}

/// Where a transition's gate begins and ends, and the text of each.
fn gate_of(gate: &str, transition: &Transition) -> Option<(u32, String, u32, String)> {
    match &transition.condition {
        TransitionCondition::Expression(condition) => {
            Some((condition.span.start, format!("{gate} ("), condition.span.end, ")".to_owned()))
        }
        TransitionCondition::Network(network) => {
            let first = network.first()?;
            let end = transition.span.end.saturating_sub(Keyword::EndTransition.text().len() as u32);
            let condition = gate.strip_suffix("AND").unwrap_or(gate).trim_end();
            Some((first.span.start, format!("IF {condition} THEN"), end, "END_IF;".to_owned()))
        }
    }
}
