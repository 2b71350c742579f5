//! Global variables, which a unit of the second edition declares again where it uses them (2nd ed. 2.5.2.2).

use std::fmt::Write as _;

use std::collections::{BTreeMap, BTreeSet};

use super::{Finding, Page};
use crate::output::scl::scope::Scope;
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::Span;
use onescan_iec::syntax::ast::{Call, Expr, ExprKind, SectionKind};
use onescan_iec::syntax::walk::{self, Visitor};

/// Adds the declarations that are missing.
pub(super) fn declare(page: &Page<'_>, edits: &mut Edits) -> Vec<Finding> {
    for pou in page.pous() {
        let scope = Scope::of(pou);
        let external = pou.sections.iter().filter(|section| section.kind == SectionKind::External);
        let declared: BTreeSet<String> = external
            .flat_map(|section| &section.variables)
            .flat_map(|each| &each.names)
            .map(onescan_iec::syntax::ast::Ident::key)
            .collect();
        let mut used = Used::default();
        walk::with_members(pou, &mut used);
        let mut text = String::new();
        for key in used.names.into_keys() {
            let Some(global) = page.names.globals.get(&key) else { continue };
            if scope.locals.contains_key(&key) || declared.contains(&key) {
                continue;
            }
            let constant = if global.is_constant { " CONSTANT" } else { "" };
            let spec = page.text(global.variable.spec.span);
            let _ = writeln!(text, "VAR_EXTERNAL{constant} {} : {spec}; END_VAR", global.name.text);
        }
        if !text.is_empty() {
            let at = pou.sections.last().map_or(pou.name.span.end, |section| section.span.end);
            edits.insert(at, format!("\n{text}"));
        }
    }
    Vec::new()
}

/// The names that a unit uses, each with a place.
#[derive(Default)]
pub(super) struct Used {
    pub(super) names: BTreeMap<String, Span>,
}

impl Used {
    fn place(&mut self, place: &Expr) {
        if let Some(root) = walk::root(place) {
            self.names.entry(root.key()).or_insert(root.span);
        }
    }
}

impl Visitor for Used {
    fn target(&mut self, target: &Expr) {
        self.place(target);
    }

    fn control(&mut self, name: &onescan_iec::syntax::ast::Ident) {
        self.names.entry(name.key()).or_insert(name.span);
    }

    fn call(&mut self, call: &Call) {
        self.place(&call.callee);
    }

    fn expression(&mut self, expr: &Expr) {
        if let ExprKind::Name(name) = &expr.kind {
            self.names.entry(name.key()).or_insert(name.span);
        }
    }
}
