//! Global variables in functions, which a function of the second edition cannot reach (2nd ed. 2.5.1): each is handed
//! to it by whoever calls it, as an input if the function only reads it, else as `VAR_IN_OUT`.

use std::collections::{BTreeMap, BTreeSet};

use super::external::Used;
use super::{Finding, Page};
use crate::output::scl::names::{Global, Shape};
use crate::output::scl::scope::Scope;
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::Span;
use onescan_iec::syntax::ast::{Argument, Call, Expr, ExprKind, Pou, PouKind, SectionKind};
use onescan_iec::syntax::walk::{self, Visitor};

/// Adds a parameter for each global variable that a function uses, and the arguments; the next round takes the
/// functions that call it.
pub(super) fn hand(page: &Page<'_>, edits: &mut Edits) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut handed: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for pou in page.pous().filter(|pou| pou.kind == PouKind::Function) {
        let globals = globals(page, pou);
        for (global, span) in &globals {
            if matches!(page.names.shape(&global.variable.spec), Some(Shape::Block(_))) {
                let what = format!("the function block `{}` in a function", global.name.text);
                findings.push(Finding::new(*span, &what, "write a function block in place of the function"));
            }
        }
        if globals.is_empty() {
            continue;
        }
        without_externals(page, pou, edits);
        edits.insert(declared_at(pou), parameters(page, pou, &globals));
        handed.insert(pou.name.key(), globals.iter().map(|(global, _)| global.name.text.clone()).collect());
    }
    for pou in page.pous().filter(|_| !handed.is_empty()) {
        let scope = Scope::of(pou);
        for call in Calls::of(pou) {
            let ExprKind::Name(callee) = &call.callee.kind else { continue };
            let Some(names) = handed.get(&callee.key()) else { continue };
            if let Some(hidden) = names.iter().find(|name| scope.locals.contains_key(&name.to_ascii_uppercase())) {
                let what = format!("a variable `{hidden}` that hides the global one which `{}` uses", callee.text);
                findings.push(Finding::new(callee.span, &what, "give it another name"));
            }
            add_arguments(page, &call, names, edits);
        }
    }
    findings
}

/// The global variables that a function uses, in the order of their names, each with a place.
fn globals<'a>(page: &Page<'a>, pou: &'a Pou) -> Vec<(Global<'a>, Span)> {
    let scope = Scope::of(pou);
    let mut used = Used::default();
    walk::unit(pou, &mut used);
    let global = |(key, span): (String, Span)| {
        let global = page.names.globals.get(&key).filter(|_| !scope.locals.contains_key(&key))?;
        Some((*global, span))
    };
    used.names.into_iter().filter_map(global).collect()
}

/// The declarations that a function of the second edition must not have.
fn without_externals(page: &Page<'_>, pou: &Pou, edits: &mut Edits) {
    for section in pou.sections.iter().filter(|section| section.kind == SectionKind::External) {
        let has_lines = page.text(section.span).contains('\n');
        edits.replace(section.span.start..section.span.end, if has_lines { "\n" } else { "" });
    }
}

/// In front of all that it declares: an argument that comes first has its place whatever else is given.
fn declared_at(pou: &Pou) -> u32 {
    let behind_name = pou.result.as_ref().map_or(pou.name.span.end, |result| result.span.end);
    pou.sections.first().map_or(behind_name, |section| section.span.start)
}

fn parameters(page: &Page<'_>, pou: &Pou, globals: &[(Global<'_>, Span)]) -> String {
    let mut written = Written { page, roots: BTreeSet::new() };
    walk::unit(pou, &mut written);
    let section = |(global, _): &(Global<'_>, Span)| {
        let is_read = global.is_constant || !written.roots.contains(&global.name.key());
        let kind = if is_read { "VAR_INPUT" } else { "VAR_IN_OUT" };
        format!("{kind} {} : {}; END_VAR\n", global.name.text, page.text(global.variable.spec.span))
    };
    let sections: String = globals.iter().map(section).collect();
    if pou.sections.is_empty() { format!("\n{sections}") } else { sections }
}

fn add_arguments(page: &Page<'_>, call: &Call, names: &[String], edits: &mut Edits) {
    let from = call.callee.span.end;
    let rest = page.file.text().get(from as usize..).unwrap_or("");
    let Some(bracket) = rest.find('(') else { return };
    let is_positional = matches!(call.arguments.first(), Some(Argument::Positional(_)));
    let argument = |name: &String| if is_positional { name.clone() } else { format!("{name} := {name}") };
    let mut text = names.iter().map(argument).collect::<Vec<_>>().join(", ");
    if !call.arguments.is_empty() {
        text += ", ";
    }
    edits.insert(from + bracket as u32 + 1, text);
}

/// Every call of a unit.
struct Calls(Vec<Call>);

impl Calls {
    fn of(pou: &Pou) -> Vec<Call> {
        let mut calls = Self(Vec::new());
        walk::with_members(pou, &mut calls);
        calls.0
    }
}

impl Visitor for Calls {
    fn call(&mut self, call: &Call) {
        self.0.push(call.clone());
    }
}

/// The names of variables that may be written.
struct Written<'p, 'a> {
    page: &'p Page<'a>,
    roots: BTreeSet<String>,
}

impl Written<'_, '_> {
    fn note(&mut self, place: &Expr) {
        self.roots.extend(walk::root(place).map(onescan_iec::syntax::ast::Ident::key));
    }
}

impl Visitor for Written<'_, '_> {
    fn target(&mut self, target: &Expr) {
        self.note(target);
    }

    /// What goes to a `VAR_IN_OUT` may be written there.
    fn call(&mut self, call: &Call) {
        for (argument, place) in super::function::handed_over(self.page, call) {
            if argument == SectionKind::InOut {
                self.note(place);
            }
        }
    }
}
