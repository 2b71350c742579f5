//! Variables that lie in memory, not in registers: those whose address is taken, and all of a unit that goes on after a
//! fault.

use std::collections::BTreeSet;

use crate::syntax::ast::{Argument, Call, Expr, ExprKind, Ident, InitialiserKind, Pou, Statement, StatementKind};
use crate::syntax::walk::{self, Visitor, root};

/// Keys of the names that `REF`, `ADR` or `REF=` is used on in a unit's body and initial values; all that a unit has
/// whose body has a `__TRY`, as a fault must leave each as it is.
pub(in crate::check) fn referred(unit: &Pou) -> BTreeSet<String> {
    let mut collector = Collector { names: BTreeSet::new(), tries: false };
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
            collector.names.insert(viewed.key());
            collector.names.extend(variable.names.iter().map(Ident::key));
        }
    }
    if collector.tries {
        let declared = unit.sections.iter().flat_map(|section| &section.variables);
        collector.names.extend(declared.flat_map(|variable| &variable.names).map(Ident::key));
        collector.names.insert(unit.name.key());
    }
    collector.names
}

struct Collector {
    names: BTreeSet<String>,
    tries: bool,
}

impl Visitor for Collector {
    fn statement(&mut self, statement: &Statement) {
        self.tries |= matches!(statement.kind, StatementKind::Try(_));
    }

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
        self.names.extend(root(place).map(Ident::key));
    }
}
