//! W0706: a variable that nothing reads, writes or calls.

use super::Unit;
use super::index::Index;
use super::usage::Usage;
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::ast::{Ident, SectionKind, Variable};

fn report(name: &Ident, findings: &mut Vec<Diagnostic>) {
    let message = format!("variable `{}` is never used", name.text);
    findings.push(Diagnostic::warning(Code::UnusedVariable, name.span, message));
}

/// What is located belongs to the machine, what is an instance has a warning of its own.
fn may_be_left_out(variable: &Variable, index: &Index<'_>) -> bool {
    variable.address.is_none() && index.block(&variable.spec).is_none()
}

pub(super) fn lint(unit: &Unit<'_>, index: &Index<'_>, findings: &mut Vec<Diagnostic>) {
    let own = |kind| matches!(kind, SectionKind::Local | SectionKind::Temp | SectionKind::External);
    for variable in unit.pou.sections.iter().filter(|section| own(section.kind)).flat_map(|each| &each.variables) {
        if may_be_left_out(variable, index) {
            let unused = variable.names.iter().filter(|name| !unit.usage.get(&name.key()).is_used());
            unused.for_each(|name| report(name, findings));
        }
    }
}

pub(super) fn lint_globals(units: &[Unit<'_>], index: &Index<'_>, findings: &mut Vec<Diagnostic>) {
    let declarations = Usage::of_globals(index);
    for variable in index.globals().flat_map(|section| &section.variables) {
        if !may_be_left_out(variable, index) {
            continue;
        }
        for name in &variable.names {
            let key = name.key();
            let used = declarations.get(&key).is_used() || units.iter().any(|unit| unit.usage.get(&key).is_used());
            if !used {
                report(name, findings);
            }
        }
    }
}
