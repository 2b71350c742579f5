//! W0701: an output that nothing writes keeps its first value, and the machine stands still.

use std::collections::BTreeSet;

use super::Unit;
use super::index::Index;
use super::usage::Usage;
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::ast::{Ident, SectionKind, Variable};

/// True for what is located at an output of the machine.
fn is_located_output(variable: &Variable) -> bool {
    let address = variable.address.as_ref().map(|address| address.text.to_ascii_uppercase());
    address.is_some_and(|address| address.starts_with("%Q"))
}

fn report(name: &Ident, findings: &mut Vec<Diagnostic>) {
    let message = format!("output `{}` is never written", name.text);
    findings.push(Diagnostic::warning(Code::OutputNeverWritten, name.span, message));
}

/// Two variables may lie at one address: where the address itself is written, names decide nothing.
fn writes_outputs(units: &[Unit<'_>]) -> bool {
    units.iter().any(|unit| unit.usage.writes_outputs)
}

pub(super) fn lint(unit: &Unit<'_>, units: &[Unit<'_>], findings: &mut Vec<Diagnostic>) {
    // It may be written through a view.
    let declared = unit.pou.sections.iter().flat_map(|section| &section.variables);
    let viewed: BTreeSet<String> = declared.filter_map(Variable::viewed).map(Ident::key).collect();
    for section in &unit.pou.sections {
        let is_output = |variable: &Variable| match section.kind {
            _ if variable.viewed().is_some() => false,
            SectionKind::Output => true,
            SectionKind::External | SectionKind::InOut => false,
            _ => is_located_output(variable) && !writes_outputs(units),
        };
        for name in section.variables.iter().filter(|variable| is_output(variable)).flat_map(|each| &each.names) {
            let uses = unit.usage.get(&name.key());
            // ENO is written by the call itself (2nd ed. 2.5.1.2).
            let is_viewed = viewed.contains(&name.key());
            if !is_viewed && name.key() != "ENO" && uses.written.is_none() && !uses.is_passed && !uses.is_called {
                report(name, findings);
            }
        }
    }
}

pub(super) fn lint_globals(units: &[Unit<'_>], index: &Index<'_>, findings: &mut Vec<Diagnostic>) {
    if writes_outputs(units) {
        return;
    }
    let declarations = Usage::of_globals(index);
    let located = index.globals().flat_map(|section| &section.variables).filter(|each| is_located_output(each));
    for name in located.flat_map(|variable| &variable.names) {
        let key = name.key();
        let touched = units.iter().map(|unit| unit.usage.get(&key)).chain([declarations.get(&key)]);
        if touched.into_iter().all(|uses| uses.written.is_none() && !uses.is_passed && !uses.is_called) {
            report(name, findings);
        }
    }
}
