//! W0726: two variables lie at one output, and both are written.

use std::collections::BTreeMap;

use super::Unit;
use super::index::Index;
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::Span;
use crate::syntax::ast::{Ident, SectionKind, Variable};

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
