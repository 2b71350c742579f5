//! What takes the place of a chart's own action control: variables, and the action that every step has.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use super::clock::Form;
use super::edits::Edits;
use super::template::{self, ChartController, Number};
use crate::syntax::SourceFile;
use crate::syntax::Span;
use crate::syntax::ast::{ActionQualifier, Association, ChartStep, Expr, ExprKind, Ident, MemberKind, Pou};
use crate::syntax::walk::{self, Visitor};

/// The action of every step.
pub(super) const CONTROL: &str = "SDSP_Control";

/// The name under which the PLC's own action control keeps the flag of an action, which nobody reads.
pub(super) fn own_flag(action: &str) -> String {
    format!("SDSP_Own_{action}")
}

/// The instance that controls an action in its place.
pub(super) fn controlled_by(action: &str) -> String {
    format!("SDSP_Ctl_{action}")
}

/// What in a chart reads its parts: `a.T` of steps, `Fill.Q` of actions.
#[derive(Default)]
pub(super) struct Reads {
    /// Keys of steps.
    steps: BTreeSet<String>,
    /// Keys of actions with statements.
    actions: BTreeSet<String>,
    pub(super) times: Vec<(Ident, Span)>,
    pub(super) flags: Vec<Ident>,
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
    pub(super) fn of(pou: &Pou) -> Self {
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

/// What stands before the elapsed time of a step; a parenthesis behind it closes it.
pub(super) fn elapsed(step: &str) -> String {
    format!("SDSP_ELAPSED({step}.X, SDSP_Step_{step}.since, SDSP_Step_{step}.held, ")
}

/// A chart, and what is made of it.
pub(super) struct Plan<'w> {
    pub(super) pou: &'w Pou,
    pub(super) file: &'w SourceFile,
    /// Of a program that is scheduled.
    pub(super) controller: Option<ChartController>,
    pub(super) reads: Reads,
    renames: &'w [(Ident, &'static Form)],
}

/// An action and where it is used.
type Uses<'w> = Vec<(&'w Ident, Vec<(&'w ChartStep, &'w Association)>)>;

impl<'w> Plan<'w> {
    /// The chart of `pou`; of a program that is scheduled, `number` is that of so many.
    pub(super) fn new(
        pou: &'w Pou,
        number: Option<(Number, &str)>,
        renames: &'w [(Ident, &'static Form)],
        file: &'w SourceFile,
    ) -> Self {
        let controller = number.map(|(number, line)| template::chart_controller(number, line));
        Self { pou, file, controller, reads: Reads::of(pou), renames }
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

    /// The variables.
    pub(super) fn declarations(&self) -> String {
        let mut text = self.controller.as_ref().map_or(String::new(), |found| format!("{}\n", found.declarations));
        text.push_str("VAR\n");
        for step in self.timed_steps().values() {
            let _ = writeln!(text, "    SDSP_Step_{} : SDSP_SFC_STEP;", step.name.text);
        }
        for (action, _) in self.uses() {
            let _ = writeln!(text, "    {} : SDSP_ACTION_CONTROL;", controlled_by(&action.text));
            let _ = writeln!(
                text,
                "    SDSP_Own_{} : BOOL; (* what the PLC's own action control makes of it *)",
                action.text
            );
        }
        text.push_str("END_VAR\n");
        text
    }

    /// The statements of the action that every step has.
    pub(super) fn statements(&self) -> Vec<String> {
        let mut lines = Vec::new();
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
        lines
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
