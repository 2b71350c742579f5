//! Times of steps that virtual time cannot replace in a unit's charts.

use super::chart_plan::{Reads, charts};
use onescan_iec::diagnostic::{Code, Diagnostic};
use onescan_iec::syntax::Span;
use onescan_iec::syntax::ast::{Ident, Pou, PouKind, Transition};

/// What of a unit's charts cannot be put on virtual time.
pub(super) fn findings(pou: &Pou) -> Vec<Diagnostic> {
    let reads = Reads::of(pou);
    let restarting = charts(pou).flat_map(|chart| restarting(chart, &reads));
    restarting
        .chain(charts(pou).filter(|chart| chart.kind == PouKind::Action).flat_map(|chart| read_outside(pou, chart)))
        .collect()
}

/// The time of a step that is read where its chart does not go on has its value from when it did.
fn read_outside(pou: &Pou, chart: &Pou) -> Vec<Diagnostic> {
    let of_chart = Reads::of_steps(chart, pou);
    let controlled: Vec<String> =
        chart.chart.steps.iter().flat_map(|step| &step.associations).map(|each| each.action.key()).collect();
    let mut inside = vec![chart.span];
    let members = pou.object.members.iter().map(|member| &member.pou);
    inside.extend(members.filter(|member| controlled.contains(&member.name.key())).map(|member| member.span));
    let is_outside = |span: &Span| !inside.iter().any(|part| part.start <= span.start && span.end <= part.end);
    let found = of_chart.times.iter().filter(|(_, span)| is_outside(span)).map(|(step, span)| {
        let message =
            format!("the time of `{}` is read outside of the chart in action `{}`", step.text, chart.name.text);
        Diagnostic::error(Code::UnsupportedFeature, *span, message).with_help("read it in an action of that chart")
    });
    found.collect()
}

/// Transitions that enter a step again whose time is read.
fn restarting(pou: &Pou, reads: &Reads) -> Vec<Diagnostic> {
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
