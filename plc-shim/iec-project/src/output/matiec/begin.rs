//! The initial situation of a chart: the actions of the initial steps run before any transition is tested (2nd ed. 2.6.5).
//! MatIEC tests transitions in the first call already, so each waits until a step of its own has run once.

use super::{Finding, Page};
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::ast::{Pou, TransitionCondition};

/// The network behind a chart that says that its first call has been.
const NETWORK: &str =
    "\nINITIAL_STEP SDSP_First: SDSP_Begin(N); END_STEP\nACTION SDSP_Begin: SDSP_Begun := TRUE; END_ACTION\n";

/// Lets no transition fire in the first call.
pub(super) fn hold(page: &Page<'_>, edits: &mut Edits) -> Vec<Finding> {
    let mut findings = Vec::new();
    for pou in page.pous().filter(|pou| !pou.chart.transitions.is_empty()) {
        for transition in &pou.chart.transitions {
            match &transition.condition {
                TransitionCondition::Expression(condition) => {
                    edits.insert(condition.span.start, "SDSP_Begun AND (".to_owned());
                    edits.insert(condition.span.end, ")".to_owned());
                }
                TransitionCondition::Network(_) => {
                    let help = "write the condition as an expression";
                    findings.push(Finding::new(transition.span, "a transition whose condition is a network", help));
                }
            }
        }
        let declared = pou.sections.last().map_or(pou.name.span.end, |section| section.span.end);
        edits.insert(declared, "\nVAR SDSP_Begun : BOOL; END_VAR\n");
        edits.insert(end_of_chart(pou), NETWORK);
    }
    findings
}

/// Behind all that belongs to a chart.
fn end_of_chart(pou: &Pou) -> u32 {
    let steps = pou.chart.steps.iter().map(|step| step.span.end);
    let transitions = pou.chart.transitions.iter().map(|transition| transition.span.end);
    let actions = pou.object.members.iter().map(|member| member.pou.span.end);
    steps.chain(transitions).chain(actions).max().unwrap_or(pou.span.end)
}
