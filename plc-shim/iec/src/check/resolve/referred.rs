//! Variables whose address is taken: they lie in memory, not in registers.

use std::collections::BTreeSet;

use crate::syntax::ast::{Argument, Call, Expr, ExprKind, Ident, InitialiserKind, Pou};
use crate::syntax::walk::{self, Visitor, root};

/// Keys of the names that `REF`, `ADR` or `REF=` is used on in a unit's body and initial values.
pub(in crate::check) fn referred(unit: &Pou) -> BTreeSet<String> {
    let mut collector = Collector(BTreeSet::new());
    walk::unit(unit, &mut collector);
    let declared = unit.sections.iter().flat_map(|section| &section.variables);
    for initial in declared.filter_map(|variable| variable.initial.as_ref()) {
        if let InitialiserKind::Value(value) = &initial.kind {
            walk::expression(value, &mut collector);
        }
    }
    // What is seen through a view, and the view itself, are taken byte by byte.
    for variable in unit.sections.iter().flat_map(|section| &section.variables) {
        if let Some(viewed) = variable.viewed() {
            collector.0.insert(viewed.key());
            collector.0.extend(variable.names.iter().map(Ident::key));
        }
    }
    collector.0
}

struct Collector(BTreeSet<String>);

impl Visitor for Collector {
    fn call(&mut self, call: &Call) {
        let ExprKind::Name(name) = &call.callee.kind else { return };
        if !matches!(name.key().as_str(), "REF" | "ADR") {
            return;
        }
        for argument in &call.arguments {
            if let Argument::Positional(place) | Argument::Input(_, place) = argument {
                self.referred(place);
            }
        }
    }

    fn referred(&mut self, place: &Expr) {
        self.0.extend(root(place).map(Ident::key));
    }
}
