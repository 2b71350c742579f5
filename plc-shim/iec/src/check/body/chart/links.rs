//! The steps that transitions name.

use std::collections::BTreeMap;

use super::net::{Arcs, Net};
use crate::check::body::Body;
use crate::diagnostic::{Code, Diagnostic, did_you_mean};
use crate::syntax::ast::{Chart, Ident};

/// Which transition leads from where to where.
pub(super) struct Links {
    /// Steps and transitions have the numbers of their order.
    pub(super) net: Net,
    /// False if a transition names a step in vain.
    pub(super) are_whole: bool,
}

impl Body<'_, '_> {
    pub(super) fn links(&mut self, chart: &Chart) -> Links {
        let mut numbers = BTreeMap::new();
        for (number, step) in chart.steps.iter().enumerate() {
            numbers.entry(step.name.key()).or_insert(number);
        }
        let known: Vec<&str> = chart.steps.iter().map(|step| step.name.text.as_str()).collect();
        let mut are_whole = numbers.len() == chart.steps.len();
        let mut ends = |names: &[Ident]| {
            let found = self.linked(names, &numbers, &known);
            are_whole &= found.len() == names.len() && !found.is_empty();
            found
        };
        let arcs = |transition: &crate::syntax::ast::Transition| Arcs {
            from: ends(&transition.from),
            to: ends(&transition.to),
        };
        let transitions = chart.transitions.iter().map(arcs).collect();
        let initial = chart.steps.iter().enumerate().filter(|(_, step)| step.is_initial).map(|(number, _)| number);
        let net = Net { steps: chart.steps.len(), initial: initial.collect(), transitions };
        Links { net, are_whole }
    }

    fn linked(&mut self, names: &[Ident], numbers: &BTreeMap<String, usize>, known: &[&str]) -> Vec<usize> {
        let mut found: Vec<usize> = Vec::new();
        for name in names {
            match numbers.get(&name.key()) {
                Some(number) if found.contains(number) => {
                    let message = format!("`{}` is named twice in this list", name.text);
                    self.report(Diagnostic::error(Code::DuplicateName, name.span, message));
                }
                Some(number) => found.push(*number),
                None => {
                    let help = did_you_mean(&name.text, known.iter().copied());
                    let message = format!("there is no step `{}`", name.text);
                    let found = Diagnostic::error(Code::UnknownStep, name.span, message);
                    self.report(found.with_optional_help(help));
                }
            }
        }
        found
    }
}
