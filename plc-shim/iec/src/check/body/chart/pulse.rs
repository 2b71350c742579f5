//! The pulses of actions: `P`, `P1` and `P0` (2nd ed. 2.6.4.5, Figure 15; 3rd ed. 6.7.4.6).
//!
//! In the standard one detector of edges sees all steps of an action together. Where one of them follows another directly,
//! the detector sees no edge, and gives no second pulse, which is reported. Nor does `P1` or `P0` ever set a Boolean
//! action. In `MatIEC` each step has edges of its own, except that of the first scan, and they set a Boolean action; of
//! several steps that name an action, the last one's count.

use super::association::{Action, Runs, Use};
use super::net::{Arcs, Net};
use crate::check::body::Body;
use crate::check::types::build::{assign, load, not, operation, truth};
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::ActionPulses;
use crate::ir::{Binary, ElementaryType, Expr, Place, Statement, Storage};
use crate::syntax::Span;
use crate::syntax::ast::{ActionQualifier, Chart};

/// For each step whether it was active before the scan's evolution.
pub(super) struct Before(Vec<Place>);

impl Before {
    pub(super) fn of(&self, step: usize) -> Option<&Place> {
        self.0.get(step)
    }
}

impl Body<'_, '_> {
    /// Where steps have edges of their own, and a pulse needs them.
    pub(super) fn before(&mut self, chart: &Chart, actions: &[Action], quiet: Span) -> Option<Before> {
        let first = chart.steps.first()?;
        let of_step = self.declarations.dialect(first.span).action_pulses() == ActionPulses::OfStep;
        let needed = actions.iter().flat_map(|action| &action.uses).any(|used| used.qualifier.is_pulse());
        (of_step && needed).then(|| {
            let flags = chart.steps.iter().map(|_| {
                let register = self.scope.register(ElementaryType::Bool);
                Place::whole(Storage::Register(register), ElementaryType::Bool.into(), quiet)
            });
            Before(flags.collect())
        })
    }

    /// The pulse of an action whose steps have edges of their own, as an input of its control. `flags` are those of the
    /// steps in its uses. MatIEC's code sets or clears the action for one step after the other, so only the last counts.
    pub(super) fn pulse_of_step(
        &self,
        action: &Action,
        flags: &[Place],
        before: &Before,
        quiet: Span,
    ) -> Option<Vec<Statement>> {
        let last = action.uses.iter().zip(flags).rev().find(|(used, _)| used.qualifier.is_pulse());
        let Some((used, flag)) = last else { return Some(Vec::new()) };
        let edge = edge(used.qualifier, flag, before.of(used.step)?);
        // The control's own detector must see this as an edge, whatever was before.
        let set = |member: &str, value: Expr| Some(assign(&self.chart_member(&action.control, member)?, value));
        let never = || truth(false, quiet);
        Some(match (&action.runs, used.qualifier) {
            (Runs::Variable(_), _) | (_, ActionQualifier::P) => vec![set("P_before", never())?, set("P", edge)?],
            (_, ActionQualifier::P0) => vec![set("P0_before", edge)?],
            _ => vec![set("P1_before", never())?, set("P1", edge)?],
        })
    }

    /// Pulses that the action control never gives.
    pub(super) fn report_lost_pulses(&mut self, chart: &Chart, net: &Net, actions: &[Action]) {
        for action in actions {
            let pulses: Vec<&Use> = action.uses.iter().filter(|used| used.qualifier.is_pulse()).collect();
            for (at, used) in pulses.iter().enumerate() {
                let of_step = self.declarations.dialect(used.span).action_pulses() == ActionPulses::OfStep;
                let sets_bool = matches!(action.runs, Runs::Variable(_));
                if of_step {
                    if let Some(last) = pulses.get(at + 1..).and_then(<[_]>::last) {
                        self.report_pulse_taken_back(chart, action, used, last);
                    }
                } else if sets_bool && used.qualifier != ActionQualifier::P {
                    self.report_pulse_without_effect(action, used);
                } else {
                    self.report_joined_pulse(chart, net, action, used);
                }
            }
        }
    }

    fn report_pulse_taken_back(&mut self, chart: &Chart, action: &Action, used: &Use, last: &Use) {
        let (name, step, behind) = (&action.name, step_name(chart, used), step_name(chart, last));
        let (message, help) = if used.step == last.step {
            let message =
                format!("`{step}` names `{name}` by two pulses: MatIEC's code of the last takes this one back");
            (message, "delete one of them".to_owned())
        } else {
            let message = format!("`{name}` gets no pulse from `{step}`: MatIEC's code of `{behind}` takes it back");
            (message, format!("give `{step}` an action of its own"))
        };
        let found = Diagnostic::warning(Code::LostPulse, used.span, message);
        self.report(found.with_label(last.span, "this one has its way").with_help(help));
    }

    fn report_pulse_without_effect(&mut self, action: &Action, used: &Use) {
        let (name, qualifier) = (&action.name, used.qualifier.text());
        let message =
            format!("`{qualifier}` does not set `{name}`: it runs the statements of an ACTION, and sets no BOOL");
        let help = if used.qualifier == ActionQualifier::P1 {
            format!("write `{name}(P)` for a pulse of one scan")
        } else {
            format!("set `{name}` in an ACTION, and write that with `P0`")
        };
        self.report(Diagnostic::warning(Code::PulseWithoutEffect, used.span, message).with_help(help));
    }

    /// `used` is that of a step which another step with the same pulse follows directly.
    fn report_joined_pulse(&mut self, chart: &Chart, net: &Net, action: &Action, used: &Use) {
        // A step may follow itself.
        let follows = |from: usize, to: usize| {
            net.transitions.iter().any(|arcs| arcs.from.contains(&from) && arcs.to.contains(&to))
        };
        let joined =
            action.uses.iter().find(|other| other.qualifier == used.qualifier && follows(other.step, used.step));
        let Some(first) = joined else { return self.report_covered_pulse(chart, net, action, used) };
        let (qualifier, before, behind) = (used.qualifier.text(), step_name(chart, first), step_name(chart, used));
        // The falling edge that is lost is that of the step which is left.
        let lost = if used.qualifier == ActionQualifier::P0 { before } else { behind };
        let message = format!(
            "`{}` gets no pulse from `{lost}` where `{behind}` follows `{before}`: one detector of edges sees both steps",
            action.name
        );
        let found = Diagnostic::warning(Code::LostPulse, used.span, message).with_label(first.span, "the other");
        let help = format!("put a step between them, or give `{behind}` an action of its own with `{qualifier}`");
        self.report(found.with_help(help));
    }

    /// `used` is that of a step in another branch than a step with the same pulse, which may be active meanwhile.
    fn report_covered_pulse(&mut self, chart: &Chart, net: &Net, action: &Action, used: &Use) {
        let others: Vec<&Use> = action.uses.iter().filter(|other| other.qualifier == used.qualifier).collect();
        if others.len() < 2 {
            return;
        }
        let edges = |arcs: &&Arcs| {
            let edge = if used.qualifier == ActionQualifier::P0 { &arcs.from } else { &arcs.to };
            edge.contains(&used.step)
        };
        let before = net.transitions.iter().filter(edges).flat_map(|arcs| arcs.from.iter().copied());
        let together = net.explore(&before.chain(others.iter().map(|other| other.step)).collect()).together;
        let are_together = |one: usize, other: usize| together.contains(&(one.min(other), one.max(other)));
        // The edge of one step comes while the other is active, and stays so.
        let comes_alone = |other: usize| {
            net.transitions.iter().filter(edges).any(|arcs| {
                let stays = !arcs.from.contains(&other) && !arcs.to.contains(&other);
                stays && arcs.from.iter().all(|from| are_together(*from, other))
            })
        };
        let covered = others.iter().find(|other| other.step != used.step && comes_alone(other.step));
        let Some(other) = covered else { return };
        let (name, step, first) = (&action.name, step_name(chart, used), step_name(chart, other));
        let message = format!(
            "`{name}` gets no pulse from `{step}` while `{first}` is active: one detector of edges sees both steps"
        );
        let found = Diagnostic::warning(Code::LostPulse, used.span, message).with_label(other.span, "the other");
        let help = format!("give `{step}` an action of its own with `{}`", used.qualifier.text());
        self.report(found.with_help(help));
    }
}

fn step_name<'c>(chart: &'c Chart, used: &Use) -> &'c str {
    chart.steps.get(used.step).map_or("", |step| step.name.text.as_str())
}

/// Whether a step has been activated in this scan, or left for `P0`.
fn edge(qualifier: ActionQualifier, flag: &Place, before: &Place) -> Expr {
    let (now, then) = (load(flag), load(before));
    let (is, is_not) = if qualifier == ActionQualifier::P0 { (then, now) } else { (now, then) };
    operation(Binary::And, is, not(is_not))
}
