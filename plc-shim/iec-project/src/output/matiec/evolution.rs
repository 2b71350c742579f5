//! How a chart goes on (2nd ed. 2.6.5), where MatIEC does it otherwise:
//! - it tests transitions in the first call already, before the actions of the initial steps have run: each waits until a step of
//!   its own has run once;
//! - of the transitions behind one step it lets all fire whose conditions hold: each waits for those that go before it.

use super::{Finding, Page};
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::ast::{Expr, Ident, Pou, Transition, TransitionCondition};

/// The network behind a chart that says that its first call has been.
const NETWORK: &str =
    "\nINITIAL_STEP SDSP_First: SDSP_Begin(N); END_STEP\nACTION SDSP_Begin: SDSP_Begun := TRUE; END_ACTION\n";
/// What a condition may grow to, bytes.
const MOST: usize = 65_536;

/// Writes each condition so that none holds in the first call, and one of those behind a step at a time.
pub(super) fn lower(page: &Page<'_>, edits: &mut Edits) -> Vec<Finding> {
    let mut findings = Vec::new();
    for pou in page.pous().filter(|pou| !pou.chart.transitions.is_empty()) {
        let mut order = Vec::new();
        for transition in &pou.chart.transitions {
            match &transition.condition {
                TransitionCondition::Expression(condition) => order.push(Tested { transition, condition }),
                TransitionCondition::Network(_) => {
                    let help = "write the condition as an expression";
                    findings.push(Finding::new(transition.span, "a transition whose condition is a network", help));
                }
            }
        }
        // Those with a priority go first.
        order.sort_by_key(|tested| {
            let rank = tested.transition.priority.map(|priority| priority.rank);
            (rank.is_none(), rank)
        });
        for (place, tested) in order.iter().enumerate() {
            let (span, others) = (tested.condition.span, blocked(page, &order[..place], tested));
            if others.len() > MOST {
                let help = "let the conditions of the transitions exclude each other, or let fewer share their steps";
                findings.push(Finding::new(span, "so many transitions that share their steps", help));
            }
            edits.insert(span.start, "SDSP_Begun AND (".to_owned());
            edits.insert(span.end, format!("){others}"));
        }
        let declared = pou.sections.last().map_or(pou.name.span.end, |section| section.span.end);
        edits.insert(declared, "\nVAR SDSP_Begun : BOOL; END_VAR\n");
        edits.insert(end_of_chart(pou), NETWORK);
    }
    findings
}

/// A transition in the order in which they are tested.
struct Tested<'t> {
    transition: &'t Transition,
    condition: &'t Expr,
}

impl Tested<'_> {
    fn steps(&self) -> Vec<String> {
        let mut steps: Vec<String> = self.transition.from.iter().map(Ident::key).collect();
        steps.sort();
        steps
    }
}

/// That none of those before it fires which share a step with it.
fn blocked(page: &Page<'_>, before: &[Tested<'_>], tested: &Tested<'_>) -> String {
    let steps = tested.steps();
    let mut text = String::new();
    for (place, other) in before.iter().enumerate() {
        let (theirs, condition) = (other.steps(), page.text(other.condition.span));
        let part = if theirs == steps {
            // Where one before that one fires, none behind it does: its condition alone is enough.
            format!(" AND NOT ({condition})")
        } else if theirs.iter().any(|step| steps.contains(step)) {
            let active: String = other.transition.from.iter().map(|step| format!("{}.X AND ", step.text)).collect();
            format!(" AND NOT ({active}({condition}){})", blocked(page, &before[..place], other))
        } else {
            continue;
        };
        text += &part;
        if text.len() > MOST {
            break;
        }
    }
    text
}

/// Behind all that belongs to a chart.
fn end_of_chart(pou: &Pou) -> u32 {
    let steps = pou.chart.steps.iter().map(|step| step.span.end);
    let transitions = pou.chart.transitions.iter().map(|transition| transition.span.end);
    let actions = pou.object.members.iter().map(|member| member.pou.span.end);
    steps.chain(transitions).chain(actions).max().unwrap_or(pou.span.end)
}
