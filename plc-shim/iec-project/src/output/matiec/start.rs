//! Initial values of arrays of structures, which MatIEC refuses: they are assigned in the first scan of their unit.

use std::fmt::Write;

use super::{Finding, Page};
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::ast::{Initialiser, InitialiserKind, Pou, PouKind, TypeSpec, TypeSpecKind};

/// Takes them out of their declarations, and assigns them.
pub(super) fn lower(page: &Page<'_>, edits: &mut Edits) -> Vec<Finding> {
    let mut findings = Vec::new();
    let cut = |spec: &TypeSpec, initial: &Initialiser, edits: &mut Edits| {
        edits.replace(spec.span.end..initial.span.end, "");
    };
    for pou in page.pous() {
        let mut assigned = String::new();
        for variable in pou.sections.iter().flat_map(|section| &section.variables) {
            let (Some(initial), [name]) = (&variable.initial, variable.names.as_slice()) else { continue };
            if !is_array_of_structures(page, &variable.spec) {
                continue;
            }
            match values(page, &name.text, &variable.spec, initial) {
                Some(text) if pou.kind != PouKind::Function => {
                    assigned += &text;
                    cut(&variable.spec, initial, edits);
                }
                _ => findings.push(Finding::new(initial.span, "this initial value", "assign it in the first scan")),
            }
        }
        if !assigned.is_empty() {
            assign(pou, &assigned, edits);
        }
    }
    for (pou, section) in page.sections() {
        for variable in section.variables.iter().filter(|_| pou.is_none()) {
            if let Some(initial) = variable.initial.as_ref().filter(|_| is_array_of_structures(page, &variable.spec)) {
                let help = "assign it in the first scan of a program";
                findings.push(Finding::new(initial.span, "the initial value of a global array of structures", help));
            }
        }
    }
    findings
}

fn is_array_of_structures(page: &Page<'_>, spec: &TypeSpec) -> bool {
    let TypeSpecKind::Array(_, element) = &spec.kind else { return false };
    matches!(&element.kind, TypeSpecKind::Name(name) if is_structure(page, &name.key()))
}

fn is_structure(page: &Page<'_>, key: &str) -> bool {
    page.names.types.get(key).is_some_and(|named| matches!(named.spec.kind, TypeSpecKind::Struct(_)))
}

/// The assignments that give an array its values; nothing where they are of another form.
fn values(page: &Page<'_>, name: &str, spec: &TypeSpec, initial: &Initialiser) -> Option<String> {
    let TypeSpecKind::Array(dimensions, _) = &spec.kind else { return None };
    let ([only], InitialiserKind::Array(elements)) = (dimensions.as_slice(), &initial.kind) else { return None };
    let low = page.names.integer(&only.low)?;
    let mut text = String::new();
    for (index, element) in (low..).zip(elements) {
        let InitialiserKind::Struct(members) = &element.kind else { return None };
        for member in members {
            let InitialiserKind::Value(value) = &member.value.kind else { return None };
            let _ = writeln!(text, "        {name}[{index}].{} := {};", member.name.text, page.text(value.span));
        }
    }
    Some(text)
}

/// Lets the unit begin with the assignments.
fn assign(pou: &Pou, assigned: &str, edits: &mut Edits) {
    let declared = pou.sections.last().map_or(pou.name.span.end, |section| section.span.end);
    edits.insert(declared, "\nVAR Values_Given : BOOL; END_VAR\n");
    let at = match pou.body.first() {
        Some(first) => first.span.start,
        None => return,
    };
    let text = format!("IF NOT Values_Given THEN\n        Values_Given := TRUE;\n{assigned}    END_IF;\n    ");
    edits.insert(at, text);
}
