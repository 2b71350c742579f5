//! Variables whose address is taken: they lie in memory, not in registers.

use std::collections::BTreeSet;

use crate::syntax::ast::{Argument, Call, Expr, ExprKind, Pou};
use crate::syntax::walk::{self, Visitor, root};

/// Keys of the names that `REF`, `ADR` or `REF=` is used on in a unit's body.
pub(in crate::check) fn referred(unit: &Pou) -> BTreeSet<String> {
    let mut collector = Collector(BTreeSet::new());
    walk::unit(unit, &mut collector);
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
        self.0.extend(root(place).map(crate::syntax::ast::Ident::key));
    }
}
