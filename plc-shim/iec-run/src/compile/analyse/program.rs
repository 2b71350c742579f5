//! What is known of the whole program, and which units go in the place of a call.

use std::collections::BTreeMap;

use super::cost::Costs;
use super::scope::Scope;
use onescan_iec::ir::{Areas, Pou, PouId, TypeTable};

/// The units and what they cost.
#[derive(Debug)]
pub(crate) struct Program<'p> {
    types: &'p TypeTable,
    pous: &'p BTreeMap<PouId, Pou>,
    areas: Areas,
    costs: Costs,
    /// Every branch has code of its own, so that it can be seen which was taken.
    whole_branches: bool,
}

impl<'p> Program<'p> {
    /// Measures the units; returns them in an order in which each follows all that it calls, in which they
    /// must be compiled: a call must know what it costs.
    pub(crate) fn new(
        types: &'p TypeTable,
        pous: &'p BTreeMap<PouId, Pou>,
        areas: Areas,
        whole_branches: bool,
    ) -> (Self, Vec<PouId>) {
        let (costs, order) = Costs::new(pous);
        (Self { types, pous, areas, costs, whole_branches }, order)
    }

    pub(crate) fn pou(&self, id: PouId) -> Option<&'p Pou> {
        self.pous.get(&id)
    }

    pub(crate) fn costs(&self) -> &Costs {
        &self.costs
    }

    /// What the function of a unit has turned out to cost a caller, and whether it changes the budget itself.
    pub(crate) fn found(&mut self, pou: PouId, call: u64, metered: bool) {
        self.costs.found(pou, call, metered);
    }

    pub(crate) fn has_whole_branches(&self) -> bool {
        self.whole_branches
    }

    /// Where a function begins: no unit is entered yet.
    pub(crate) fn scope(&self) -> Scope<'p> {
        Scope::new(self.types, self.areas)
    }

    /// The unit, if its body goes in the place of a call in `scope`. In a branch that leaves its unit nothing
    /// does: it is for the exception, and would only make the rest larger.
    pub(crate) fn inlined(&self, pou: PouId, scope: &Scope<'_>) -> Option<&'p Pou> {
        let goes = !scope.is_leaving() && self.costs.is_inlined(pou, scope.units());
        goes.then(|| self.pou(pou)).flatten()
    }
}
