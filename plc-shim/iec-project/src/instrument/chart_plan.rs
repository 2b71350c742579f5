//! What takes the place of the action control of a unit's charts: variables, and for each chart an action that runs in
//! every scan of it. A chart may be the body of an action: what is its own has that action's name behind it.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use super::chart_action::Moved;
use super::chart_script::{ROUND, Script};
use super::clock::Form;
use super::template::{self, ChartController, Number};
use onescan_iec::dialect::ActionPulses;
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::SourceFile;
use onescan_iec::syntax::Span;
use onescan_iec::syntax::ast::{
    ActionQualifier, Association, ChartStep, Expr, ExprKind, Ident, MemberKind, Pou, PouKind,
};
use onescan_iec::syntax::walk::{self, Visitor};

/// The action that runs in every scan of the unit's own chart.
pub(super) const CONTROL: &str = "SDSP_Control";

/// The name under which the PLC's own action control keeps the flag of an action, which nobody reads.
pub(super) fn own_flag(action: &str) -> String {
    format!("SDSP_Own_{action}")
}

/// The instance that controls an action in its place.
pub(super) fn controlled_by(action: &str) -> String {
    format!("SDSP_Ctl_{action}")
}

/// Whether a step was active in the scan before.
fn was(step: &str) -> String {
    format!("SDSP_Was_{step}")
}

/// The input of an action's control that lets its statements run in this scan alone.
const ONCE: &str = "SDSP_Once";

/// What in a chart reads its parts: `a.T` of steps, `Fill.Q` of actions.
#[derive(Default)]
pub(super) struct Reads {
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
    /// What in `pou` reads the times of the steps of one chart.
    pub(super) fn of_steps(chart: &Pou, pou: &Pou) -> Self {
        let mut reads =
            Self { steps: chart.chart.steps.iter().map(|step| step.name.key()).collect(), ..Self::default() };
        reads.look_through(pou);
        reads
    }

    pub(super) fn of(pou: &Pou) -> Self {
        let members = pou.object.members.iter().filter(|member| member.kind == MemberKind::Action);
        let mut reads = Self {
            steps: charts(pou).flat_map(|chart| &chart.chart.steps).map(|step| step.name.key()).collect(),
            actions: members.map(|member| member.pou.name.key()).collect(),
            ..Self::default()
        };
        reads.look_through(pou);
        reads
    }

    fn look_through(&mut self, pou: &Pou) {
        walk::unit(pou, self);
        for member in &pou.object.members {
            walk::unit(&member.pou, self);
        }
    }
}

/// The unit if it is a chart, and its actions that are.
pub(super) fn charts(pou: &Pou) -> impl Iterator<Item = &Pou> {
    let actions = pou.object.members.iter().filter(|member| member.kind == MemberKind::Action);
    std::iter::once(pou).chain(actions.map(|member| &member.pou)).filter(|pou| !pou.chart.is_empty())
}

/// A name of the shim's own for the chart of a unit or of an action.
pub(super) fn of_chart(name: &str, chart: &Pou) -> String {
    if chart.kind == PouKind::Action { format!("{name}_{}", chart.name.text) } else { name.to_owned() }
}

/// What stands before the elapsed time of a step; a parenthesis behind it closes it.
pub(super) fn elapsed(step: &str) -> String {
    format!(
        "SDSP_ELAPSED(SDSP_Simulated, SDSP_Now, {step}.X, SDSP_Step_{step}.SDSP_Since, SDSP_Step_{step}.SDSP_Held, "
    )
}

/// The charts of a unit, and what is made of them.
pub(super) struct Plan<'w> {
    pub(super) pou: &'w Pou,
    pub(super) file: &'w SourceFile,
    /// Of a chart that is a program which is scheduled.
    pub(super) controller: Option<ChartController>,
    /// It has a controller of a chart or of statements, which declares `SDSP_Simulated`.
    is_scheduled: bool,
    pub(super) reads: Reads,
    renames: &'w [(Ident, &'static Form)],
}

/// An action and where it is used.
type Uses<'w> = Vec<(&'w Ident, Vec<(&'w ChartStep, &'w Association)>)>;

impl<'w> Plan<'w> {
    /// The charts of `pou`; of a chart that is a program which is scheduled, `number` is that of so many.
    pub(super) fn new(
        pou: &'w Pou,
        number: Option<(Number, &str)>,
        renames: &'w [(Ident, &'static Form)],
        file: &'w SourceFile,
    ) -> Self {
        let controller =
            number.filter(|_| !pou.chart.is_empty()).map(|(number, line)| template::chart_controller(number, line));
        Self { pou, file, controller, is_scheduled: number.is_some(), reads: Reads::of(pou), renames }
    }

    /// The actions of a chart in the order in which its steps name them first.
    fn uses(chart: &'w Pou) -> Uses<'w> {
        let mut uses: Uses<'w> = Vec::new();
        for step in &chart.chart.steps {
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
    fn timed_steps(&self, chart: &'w Pou) -> BTreeMap<String, &'w ChartStep> {
        let read = |step: &&ChartStep| self.reads.times.iter().any(|(name, _)| name.key() == step.name.key());
        chart.chart.steps.iter().filter(read).map(|step| (step.name.key(), step)).collect()
    }

    /// True for an action with statements that some step controls.
    pub(super) fn controls(&self, action: &Ident) -> bool {
        charts(self.pou).any(|chart| self.bodies(&Self::uses(chart)).any(|body| body.key() == action.key()))
    }

    /// The actions that have statements, of all.
    fn bodies<'u>(&'u self, uses: &'u Uses<'w>) -> impl Iterator<Item = &'w Ident> + Clone + 'u {
        uses.iter().map(|(action, _)| *action).filter(|action| self.reads.actions.contains(&action.key()))
    }

    /// The variables, where the statements of some actions have been moved.
    pub(super) fn declarations(&self, moved: &BTreeMap<String, Moved>) -> String {
        let mut text = self.controller.as_ref().map_or(String::new(), |found| format!("{}\n", found.declarations));
        let is_timed = !self.reads.times.is_empty();
        if is_timed {
            let simulated = if self.is_scheduled { "" } else { "SDSP_Simulated : BOOL; " };
            let _ = writeln!(text, "VAR_EXTERNAL {simulated}SDSP_Now : TIME; END_VAR");
        }
        let mut own = String::new();
        for chart in charts(self.pou) {
            self.declare(chart, moved, &mut own);
        }
        if !own.is_empty() {
            let _ = writeln!(text, "VAR\n{own}END_VAR");
        }
        text
    }

    fn declare(&self, chart: &'w Pou, moved: &BTreeMap<String, Moved>, own: &mut String) {
        let uses = Self::uses(chart);
        for step in self.timed_steps(chart).values() {
            let _ = writeln!(own, "    SDSP_Step_{} : SDSP_SFC_STEP;", step.name.text);
        }
        for step in self.edged_steps(chart) {
            let at_start = if step.is_initial { " := TRUE" } else { "" };
            let _ = writeln!(own, "    {} : BOOL{at_start};", was(&step.name.text));
        }
        for (action, _) in &uses {
            let _ = writeln!(own, "    {} : SDSP_ACTION_CONTROL;", controlled_by(&action.text));
        }
        if self.bodies(&uses).count() > 1 {
            let _ = writeln!(own, "    {} : INT;", of_chart(ROUND, chart));
        }
        for (action, _) in &uses {
            if let Some(left) = moved.get(&action.key()).and_then(|moved| moved.left.as_ref()) {
                let _ = writeln!(own, "    {left} : BOOL;");
            }
        }
    }

    /// The flags that the PLC's own action control sets, where it cannot be without.
    pub(super) fn own_flags(&self) -> String {
        let flags = charts(self.pou).flat_map(Self::uses).map(|(action, _)| {
            format!("    {} : BOOL; (* what the PLC's own action control makes of it *)\n", own_flag(&action.text))
        });
        let flags: String = flags.collect();
        if flags.is_empty() { flags } else { format!("VAR\n{flags}END_VAR\n") }
    }

    /// The statements of the action that runs in every scan of a chart. The statements of actions stand in it where they have
    /// been moved, by their keys; others are called.
    pub(super) fn statements(&self, chart: &'w Pou, moved: &BTreeMap<String, Moved>) -> Script {
        let mut script = Script::default();
        let controller = self.controller.as_ref().filter(|_| std::ptr::eq(chart, self.pou));
        if let Some(found) = controller {
            script.put(&found.header);
        }
        for step in self.timed_steps(chart).values() {
            script.put(&format!("    SDSP_Step_{0}(X := {0}.X);", step.name.text));
        }
        let uses = Self::uses(chart);
        for (action, found) in &uses {
            self.controlled(action, found).iter().for_each(|line| script.put(line));
            if !self.reads.actions.contains(&action.key()) {
                script.put(&format!("    {0} := SDSP_Ctl_{0}.Q;", action.text));
            }
        }
        for step in self.edged_steps(chart) {
            script.put(&format!("    {} := {}.X;", was(&step.name.text), step.name.text));
        }
        let runs = |action: &&Ident| moved.get(&action.key()).is_none_or(|moved| !moved.is_empty);
        script.run(self.bodies(&uses).filter(runs), moved, &of_chart(ROUND, chart));
        if let Some(found) = controller {
            script.put(&found.close);
            script.put(&found.footer);
        }
        script
    }

    /// The call of an action's control.
    fn controlled(&self, of: &Ident, uses: &[(&ChartStep, &Association)]) -> Vec<String> {
        let action = &of.text;
        let mut lines = Vec::new();
        for (step, association) in uses {
            if let Some(time) = &association.time {
                let value = self.rewritten(time.span);
                lines.push(format!("    IF {}.X THEN SDSP_Ctl_{action}.T := {value}; END_IF;", step.name.text));
            }
        }
        let pulse = |association: &Association| association.effective_qualifier().is_pulse();
        // MatIEC sets and clears an action for one step after the other: the last one has its way.
        let last = uses.iter().rposition(|(_, association)| pulse(association));
        let mut inputs: BTreeMap<&str, Vec<String>> = BTreeMap::new();
        for (at, (step, association)) in uses.iter().enumerate() {
            if !self.has_edges_of_steps() || !pulse(association) || last == Some(at) {
                let (input, flag) = self.input(of, step, association.effective_qualifier());
                inputs.entry(input).or_default().push(flag);
            }
        }
        let names = ActionQualifier::ALL.into_iter().map(ActionQualifier::text).chain([ONCE]);
        let inputs = names.filter_map(|name| Some(format!("{name} := {}", inputs.get(name)?.join(" OR "))));
        let inputs: Vec<_> = inputs.collect();
        lines.push(format!("    SDSP_Ctl_{action}({});", inputs.join(", ")));
        lines
    }

    /// The input of an action's control that a step drives by `qualifier`, and with what.
    fn input(&self, action: &Ident, step: &ChartStep, qualifier: ActionQualifier) -> (&'static str, String) {
        let (name, has_statements) = (&step.name.text, self.reads.actions.contains(&action.key()));
        if !self.has_edges_of_steps() || !qualifier.is_pulse() {
            return (qualifier.text(), format!("{name}.X"));
        }
        let edge = match qualifier {
            ActionQualifier::P0 => format!("{} AND NOT {name}.X", was(name)),
            _ => format!("{name}.X AND NOT {}", was(name)),
        };
        // The control's own detector of edges would see two steps as one.
        let input = if has_statements && qualifier != ActionQualifier::P { ONCE } else { ActionQualifier::N.text() };
        (input, edge)
    }

    /// True where each step has edges of its own, as in `MatIEC`.
    fn has_edges_of_steps(&self) -> bool {
        self.file.dialect().action_pulses() == ActionPulses::OfStep
    }

    /// The steps whose edges give pulses, where these are their own.
    fn edged_steps(&self, chart: &'w Pou) -> impl Iterator<Item = &'w ChartStep> + use<'w> {
        let has_edges = self.has_edges_of_steps();
        let pulses = |step: &&ChartStep| step.associations.iter().any(|each| each.effective_qualifier().is_pulse());
        chart.chart.steps.iter().filter(move |_| has_edges).filter(pulses)
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
