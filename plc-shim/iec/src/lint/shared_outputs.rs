//! W0726: two variables lie at one output, and both are written; or two programs write one output in each call.

use std::collections::BTreeMap;

use super::Unit;
use super::bodies::{Bodies, Body};
use super::index::Index;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{Place, Statement, StatementKind, Storage};
use crate::syntax::Span;
use crate::syntax::ast::{Ident, PouKind, SectionKind, Variable};
use crate::syntax::direct_address::Area;

/// A variable at an output that somebody writes.
struct Written<'a> {
    name: &'a Ident,
    place: Span,
}

pub(super) fn lint(units: &[Unit<'_>], index: &Index<'_>, findings: &mut Vec<Diagnostic>) {
    let mut at: BTreeMap<String, Vec<Written<'_>>> = BTreeMap::new();
    for section in index.globals() {
        for (address, name) in located(&section.variables) {
            let writer = units.iter().find_map(|unit| unit.usage.get(&name.key()).written);
            at.entry(address).or_default().extend(writer.map(|place| Written { name, place }));
        }
    }
    for unit in units {
        for section in unit.pou.sections.iter().filter(|section| section.kind != SectionKind::External) {
            for (address, name) in located(&section.variables) {
                let writer = unit.usage.get(&name.key()).written;
                at.entry(address).or_default().extend(writer.map(|place| Written { name, place }));
            }
        }
    }
    for (address, written) in &at {
        let [first, others @ ..] = &written[..] else { continue };
        for other in others {
            let (one, two) = (&first.name.text, &other.name.text);
            let message = format!("`{two}` lies at {address} as `{one}` does, and both are written: the last one wins");
            let found = Diagnostic::warning(Code::OutputWithTwoNames, other.name.span, message)
                .with_label(first.place, format!("`{one}` is written here"))
                .with_label(other.place, format!("`{two}` is written here"))
                .with_help("give one of them another address, or let one variable have the output");
            findings.push(found);
        }
    }
}

/// The names at outputs, with the address of each as it is compared.
fn located(variables: &[Variable]) -> impl Iterator<Item = (String, &Ident)> {
    variables.iter().flat_map(|variable| {
        let address = variable.address.as_ref().map(|address| address.text.to_ascii_uppercase());
        // `%Q*` is given its place later; without X a bit is meant, too.
        let address = address.filter(|text| text.starts_with("%Q") && !text.contains('*'));
        let address = address.map(|text| text.replace("%QX", "%Q"));
        variable.names.iter().filter_map(move |name| Some((address.clone()?, name)))
    })
}

/// Outputs that one program writes in each call, and another one as well.
pub(super) fn lint_programs(bodies: &Bodies<'_>, findings: &mut Vec<Diagnostic>) {
    let mut writers: Vec<(&Place, Body<'_>)> = Vec::new();
    for body in bodies.iter().filter(|body| body.pou.kind == PouKind::Program && body.pou.chart.is_empty()) {
        for place in body.checked.body.iter().filter_map(written_always) {
            match writers.iter().find(|(first, _)| is_same_output(first, place)) {
                None => writers.push((place, body)),
                Some((first, other)) if other.pou.name.key() != body.pou.name.key() => {
                    report(bodies, (first, *other), (place, body), findings);
                }
                Some(_) => {}
            }
        }
    }
}

/// A part of the output area that a statement writes, whatever else there is.
fn written_always(statement: &Statement) -> Option<&Place> {
    let StatementKind::Assign(place, _) = &statement.kind else { return None };
    let is_output = matches!(place.storage, Storage::Located(location) if location.area == Area::Output);
    (is_output && place.steps.is_empty()).then_some(place)
}

fn is_same_output(one: &Place, other: &Place) -> bool {
    one.storage == other.storage && one.part == other.part
}

fn report(
    bodies: &Bodies<'_>,
    (first, one): (&Place, Body<'_>),
    (again, other): (&Place, Body<'_>),
    findings: &mut Vec<Diagnostic>,
) {
    // Two names of one output, and two tasks, have been reported.
    let is_known = |found: &Diagnostic| {
        matches!(found.code, Code::OutputWithTwoNames | Code::WrittenByTwoTasks)
            && found.labels.iter().any(|label| label.span == first.span)
            && found.labels.iter().any(|label| label.span == again.span)
    };
    if findings.iter().any(is_known) {
        return;
    }
    let (name, one, other) = (bodies.text(again.span), &one.pou.name.text, &other.pou.name.text);
    let message = format!("output `{name}` is written by each call of `{other}` and of `{one}`: the last one wins");
    let found = Diagnostic::warning(Code::OutputWithTwoNames, again.span, message)
        .with_label(first.span, format!("written here by `{one}`"))
        .with_help("let one of them write it, and the others ask that one by variables of their own");
    findings.push(found);
}
